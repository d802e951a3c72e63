"""The study of the engine beside redbirdpy and pmmc: its patches, and what each program says of the same light."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from quadgraph.base.errors import InputError
from quadgraph_validation.accuracy import wide_field_case as case
from quadgraph_validation.accuracy import wide_field_study, wide_field_ways
from quadgraph_validation.accuracy.wide_field_case import MEDIUM, SIDES, Left, Truth
from quadgraph_validation.bodies import meshes
from quadgraph_validation.truth import cross_checks, pmmc_field

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
NO_PMMC = cross_checks.why_no_pmmc()


def needs_redbird():
    try:
        wide_field_ways.redbird()
    except InputError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """The block in large tets."""
    path = tmp_path_factory.mktemp("wide-field") / "block.qgraph"
    wide_field_study.write(path, 6.0)
    return path


def spread(random, count):
    """Places on the block's faces."""
    places = random.uniform(-SIDES / 2, SIDES / 2, (count, 3))
    axis, upper = random.integers(0, 3, count), random.integers(0, 2, count)
    places[np.arange(count), axis] = np.where(upper, 1, -1) * SIDES[axis] / 2
    return places


def test_patches_have_the_power_of_what_leaves_through_them():
    random = np.random.default_rng(1)
    power = random.uniform(0, 1, 500)
    left = case.in_patches(spread(random, 500), power, 0.5)
    assert left.power == pytest.approx(power.sum())
    assert [face.shape for face in left.faces] == [(12, 6)] * 4 + [(12, 12)] * 2
    regions = left.regions()
    assert sum(len(values) for values in regions.values()) == 4 * 72 + 2 * 144
    assert len(regions["lit"]) == (2 * case.HALF / case.PATCH) ** 2
    assert left.symmetric().power == pytest.approx(power.sum())
    front = left.symmetric().faces[4]
    np.testing.assert_allclose(front, front.T)
    np.testing.assert_allclose(front, front[::-1])


def test_the_truth_itself_is_not_off_and_a_tenth_more_light_is_off_by_a_tenth():
    random = np.random.default_rng(2)
    left = case.in_patches(spread(random, 5000), np.ones(5000), 0.5)
    none = Left([0 * face for face in left.faces], 0.0)
    exact = Truth(left, none, 0.0)
    assert case.judged(left, exact)["rms"] == dict.fromkeys(case.REGIONS, 0.0)
    brighter = case.judged(Left([1.1 * face for face in left.faces], 0.55), exact)
    assert [*brighter["rms"].values(), brighter["power"], brighter["detector"]] == pytest.approx([0.1] * 6)


@pytest.mark.skipif(bool(NO_PMMC), reason=NO_PMMC)
def test_walks_of_wide_light_go_in_by_fresnel_and_leave_or_are_absorbed():
    sides = [np.linspace(-half, half, 5) for half in SIDES / 2]
    body = meshes.box(*sides, meshes.no_wall)
    walks = 20_000
    found = pmmc_field.square(body, MEDIUM, case.ETA, case.HALF, walks, 3)
    mirrored = 1 - found.entered / walks
    assert mirrored == pytest.approx(((case.ETA - 1) / (case.ETA + 1)) ** 2, abs=4 * np.sqrt(0.024 / walks))
    corners = body.vertices[body.tets]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    absorbed = MEDIUM.sigma_a * float((volume * found.fluence).sum())
    assert (found.weight.sum() + absorbed * walks) / found.entered == pytest.approx(1, abs=0.01)


def test_the_engine_by_both_ways_balances_and_lets_more_out_in_front(path):
    for way in ("ours", "ours, --no-correction"):
        left = wide_field_ways.WAYS[way](path, "cpu")(MEDIUM)
        assert 0.7 < left.power < 0.8
        regions = left.regions()
        assert regions["lit"].min() > 5 * regions["unlit front"].mean() > regions["back"].mean() > 0


def test_redbird_agrees_with_the_engine_where_light_has_become_diffuse(path):
    needs_redbird()
    ours = wide_field_ways.WAYS["ours, --no-correction"](path, "cpu")(MEDIUM)
    theirs = wide_field_ways.WAYS["redbirdpy, its default solver"](path, "cpu")(MEDIUM)
    assert theirs.power == pytest.approx(ours.power, rel=0.02)
    assert theirs.detector == pytest.approx(ours.detector, rel=0.1)
    back = [left.regions()["back"].sum() for left in (ours, theirs)]
    assert back[1] == pytest.approx(back[0], rel=0.1)


def test_redbirds_own_reconstruction_finds_the_absorption_of_its_own_reading(path):
    needs_redbird()
    reading = wide_field_ways.WAYS["redbirdpy, cg+amg"](path, "cpu")(MEDIUM).detector
    found = wide_field_ways.reconstructed(path, reading, 0.01, 5)
    # Its source stays where the start put it.
    assert found == pytest.approx(MEDIUM.sigma_a, rel=0.03)


@pytest.mark.long
@pytest.mark.skipif(bool(NO_PMMC), reason=NO_PMMC)
def test_the_corrected_engine_is_nearest_to_the_walks_and_fits_their_coefficients():
    needs_redbird()
    record = wide_field_study.run(wide_field_study.WideFieldRun(1_000_000, "cpu"), lambda what: None)
    rows = {row["name"]: row for row in record["rows"]}
    assert abs(rows["ours"]["power"]) < 0.01
    for region in ("lit", "unlit front"):
        assert rows["ours"]["rms"][region] < rows["redbirdpy, cg+amg"]["rms"][region]
    fits = {fit["name"]: fit for fit in record["fits"]}
    for name in ("sigma_a", "sigma_s_prime"):
        assert abs(fits["ours"][name]) < 0.05 < abs(fits["redbirdpy, cg+amg"][name])
    assert [table.row_count for table in wide_field_study.tables(record)] == [6, 4]


def test_without_redbird_the_way_to_get_it_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "redbirdpy", None)
    with pytest.raises(InputError, match=r"pip install './python/validation\[rivals\]'"):
        wide_field_ways.redbird()
