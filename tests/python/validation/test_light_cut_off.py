"""What a cut after some scatterings loses: walks against closed forms, and the study's table."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import comb, expn

from quadgraph_validation.accuracy import cutoff_study
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import half_space_orders, monte_carlo

WALKS = 40_000


def test_orders_of_a_half_space_add_up_to_its_reflectance():
    """And the first is by hand: light at normal incidence scatters once by (1 - ln 2) / 2 of the albedo."""
    orders = half_space_orders.by_scatterings(200)
    assert orders[0] == 0
    assert orders[1] == pytest.approx((1 - np.log(2)) / 2, rel=1e-10)
    for cosine in (1.0, 0.3):
        orders = half_space_orders.by_scatterings(200, cosine)
        for albedo in (0.3, 0.9):
            whole = half_space_orders.reflectance(albedo, cosine)
            assert orders @ albedo ** np.arange(201) == pytest.approx(whole, rel=1e-7)


def test_walks_come_back_by_the_law_of_sparre_andersen():
    """Depths of isotropic walks go up and down on a line, where C(2n, n) / 4^n stay on one side [Andersen 1954].

    So of light whose cosines are uniform as it enters a half-space, twice the difference of two such shares comes back
    after n scatterings, but for what is absorbed, whatever the lengths of the steps.
    """
    generator = np.random.default_rng(5)
    cosine = generator.random(WALKS)
    direction = np.column_stack([np.sqrt(1 - cosine**2), np.zeros(WALKS), cosine])
    planes = monte_carlo._planes(np.inf), monte_carlo._plane_normals
    medium = Medium(0.99, 0.01)
    exits = monte_carlo.walk(np.zeros((WALKS, 3)), direction, medium, 1.0, *planes, generator)
    number = np.arange(1, 30)
    below = comb(2 * number, number) / 4.0**number
    expected = 2 * (below[:-1] - below[1:]) * medium.albedo ** number[:-1]
    found = np.bincount(exits.scatterings, minlength=29)[1:29] / WALKS
    assert (np.abs(found - expected) < 4.5 * np.sqrt(expected / WALKS)).all()
    assert not (exits.scatterings == 0).any()


@pytest.mark.parametrize("albedo", [0.9, 0.999])
def test_a_half_space_loses_by_walks_what_its_series_says(albedo):
    found = monte_carlo.after_many(Medium(albedo, 1 - albedo), np.inf, 1.0, 15, WALKS, seed=2)
    whole = half_space_orders.reflectance(albedo)
    late = whole - half_space_orders.by_scatterings(15) @ albedo ** np.arange(16)
    expected = np.array([whole, 0, late, 0])
    assert (np.abs(found.mean - expected) <= 4 * np.sqrt(expected * (1 - expected) / WALKS)).all()


@pytest.mark.parametrize("thickness", [0.5, 3.0])
def test_a_slab_scatters_once_what_an_integral_says(thickness):
    albedo = 0.8
    found = monte_carlo.after_many(Medium(albedo, 1 - albedo), thickness, 1.0, 1, WALKS, seed=3)
    once = found.mean[:2] - found.mean[2:]
    back = quad(lambda t: np.exp(-t) * expn(2, t), 0, thickness)[0]
    through = quad(lambda t: np.exp(-t) * expn(2, thickness - t), 0, thickness)[0]
    expected = albedo / 2 * np.array([back, through])
    assert (np.abs(once - expected) < 4 * np.sqrt(expected / WALKS)).all()


def test_the_study_says_what_is_lost_and_what_too_few_walks_cannot_tell(monkeypatch):
    cases = [(thickness, albedo, eta) for thickness in (14.0, np.inf) for albedo in (0.5, 0.9992) for eta in (1.0, 1.4)]
    monkeypatch.setattr(cutoff_study, "CASES", cases)
    record = json.loads(json.dumps(cutoff_study.run(None, 4000)))
    dark, bright = (row for row in record["rows"] if row["eta"] == 1 and row["thickness"] == 14)
    assert "lost" not in dark["transmittance"]
    assert cutoff_study.cell(dark, "transmittance") == "\N{EN DASH}"
    assert bright["transmittance"]["lost"] > 0.98
    (half,) = (row for row in record["rows"] if (row["eta"], row["thickness"], row["albedo"]) == (1, None, 0.9992))
    assert half["exact"]["lost"] == pytest.approx(0.338, abs=5e-4)
    walked = half["reflectance"]
    assert walked["lost"] == pytest.approx(half["exact"]["lost"], abs=5 * walked["lost_error"])
    (table,) = cutoff_study.tables(record)
    assert table.row_count == 4


def test_the_page_shows_the_recorded_table(request):
    docs = request.config.rootpath / "docs"
    record = json.loads((docs / "benchmarks" / "accuracy-cutoff.json").read_text())
    lines = (docs / "chart.md").read_text().splitlines()
    for thickness in cutoff_study.THICKNESSES:
        for albedo in cutoff_study.ALBEDOS:
            known = None if np.isinf(thickness) else thickness
            rows = [row for row in record["rows"] if (row["thickness"], row["albedo"]) == (known, albedo)]
            cells = [cutoff_study.cell(row, side) for row in rows for side in ("reflectance", "transmittance")]
            name = "half-space" if known is None else f"{thickness:g}"
            assert f"| {name} | {albedo:g} | {' | '.join(cells)} |" in lines
