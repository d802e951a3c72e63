"""`quadgraph stability`: what a class means, that the default method is nowhere wrong silently, records, drawings."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph_validation.stability import (
    columns,
    deformed_shapes,
    judged_points,
    map_figures,
    solids,
    stability_methods,
    stability_suite,
)
from quadgraph_validation.stability.error_classes import ACCURATE, HONEST, REFUSED, SILENT, Errors, classify
from quadgraph_validation.stability.fine_truths import FineTruth
from quadgraph_validation.stability.stability_maps import StabilitySetting

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.mark.parametrize(
    ("true", "estimate", "said", "expected"),
    [
        (Errors(0.009), Errors(1e-6), [], ACCURATE),  # small, whatever the estimate
        (Errors(0.05), Errors(0.03), [], ACCURATE),  # within twice the estimate
        (Errors(0.05), Errors(0.02), [], SILENT),  # beyond it
        (Errors(0.05), Errors(0.02), ["not converged"], HONEST),
        (Errors(0.15), Errors(0.1), [], HONEST),  # told, but not to be used
        (Errors(0.99), Errors(0.3), [], HONEST),  # an estimate of 30% says that there is no answer
        (Errors(0.99), Errors(0.2), [], SILENT),
        (Errors(0.02, 0.3), Errors(0.02, 0.1), [], SILENT),  # the unlit part alone
        (Errors(0.02, 0.3), Errors(0.02), [], SILENT),  # an unlit part that the solve does not know of
        (Errors(0.5), None, [], HONEST),  # the solve says that it cannot tell
        (Errors(math.nan), Errors(0.5), ["not converged"], SILENT),  # a NaN is never honest
        (Errors(0.001, math.inf), Errors(0.5), ["not converged"], SILENT),
    ],
)
def test_classes(true, estimate, said, expected):
    assert classify(true, estimate, said) == expected


def test_an_error_counts_where_there_is_light_and_by_the_means_that_are_asked_for():
    chain = columns._slab(2, "")
    open_faces = chain.area > 0
    lit = columns._sides(chain) < 0
    truth = np.where(lit, 0.5, 0.1)
    found = truth * np.where(lit, 1.02, 0.9)
    case = judged_points.StabilityCase(
        chain,
        solids.even(1, 1),
        columns._lit_below,
        columns.INWARD,
        1.3,
        lambda _: FineTruth(truth),
        regions=columns._sides,
    )
    errors = judged_points.errors(case, found, truth)
    both = math.sqrt((0.5 * 0.02) ** 2 + (0.1 * 0.1) ** 2) / math.sqrt(0.5**2 + 0.1**2)
    assert errors.whole == pytest.approx(both)
    assert errors.unlit == pytest.approx(0.1)
    uneven = found * np.where(np.arange(len(found)) % 2 == 0, 1.5, 0.5)  # cancels only in the mean over a side
    assert (
        judged_points.errors(case, uneven, truth).whole
        < 0.6 * judged_points.errors(_by_face(case), uneven, truth).whole
    )
    black = np.where(lit, 0.5, 1e-9)
    assert judged_points.errors(case, found, black).unlit is None
    assert open_faces.sum() == (np.abs(columns._sides(chain)) > 0).sum()
    with pytest.raises(ValueError, match="not finite"):
        judged_points.errors(case, found, truth * np.nan)


def _by_face(case: judged_points.StabilityCase) -> judged_points.StabilityCase:
    return replace(case, regions=None)


def ends_of(chosen: Callable[[str], bool]) -> dict:
    """The record of the ends of every axis (and the middle, where silence was found) of these maps, default method."""
    maps = [
        each.thinned(3 if each.name in ("albedo", "thickness", "tolerance") else 2)
        for each in stability_suite.MAPS
        if chosen(each.name)
    ]
    return stability_suite.run(maps, ["fem"], StabilitySetting())


@pytest.fixture(scope="module")
def record():
    """Of all maps but the one that takes as long as all others."""
    return ends_of(lambda name: name != "jumps")


def test_the_default_method_is_nowhere_wrong_silently(record):
    assert stability_suite.silent_of_default(record) == []


@pytest.mark.long
def test_nor_where_coefficients_jump():
    assert stability_suite.silent_of_default(ends_of(lambda name: name == "jumps")) == []


def test_the_suite_can_find_what_is_wrong_silently(tmp_path, capsys):
    """The published method is, so that a suite that finds nothing would be noticed."""
    path = tmp_path / "record.json"
    arguments = ["stability", "--axis", "albedo", "--axis", "transport", "--method", "quadgraph-fdm", "--thin", "2"]
    assert cli.main([*arguments, "--json", str(path)]) == 0
    record = json.loads(path.read_text())
    assert sum(counts["quadgraph-fdm"][SILENT] for counts in record["counts"].values()) > 0
    assert {"device", "driver", "commit"} <= record.keys()
    assert "quadgraph-fdm" in capsys.readouterr().out


def test_what_is_inside_out_is_refused_and_nothing_else(record):
    points = [(each, i, j, point) for each, i, j, point in _points(record) if point["class"] == REFUSED]
    assert points
    for each, _, j, point in points:
        assert each["name"] == "quality"
        assert each["y"]["values"][j] < 0
        assert "inside out" in point["said"][0]


def test_no_error_is_nan(record):
    for _, _, _, point in _points(record):
        if point["class"] != REFUSED:
            assert all(math.isfinite(error) for error in point["true"].values() if error is not None)


def _points(record: dict):
    return [
        (each, i, j, point)
        for each in record["maps"]
        for rows in each["panels"].values()
        for j, row in enumerate(rows)
        for i, point in enumerate(row)
    ]


def test_a_record_is_drawn_again_without_solving(record, tmp_path, capsys):
    path = tmp_path / "record.json"
    path.write_text(json.dumps(record))
    images, again = tmp_path / "images", tmp_path / "again.json"
    arguments = ["stability", "--from", str(path), "--images", str(images), "--json", str(again)]
    assert cli.main([*arguments, "--axis", "genus", "--method", "fem"]) == 0
    assert [drawn.name for drawn in images.iterdir()] == ["stability-genus.png"]
    reduced = json.loads(again.read_text())
    assert [each["name"] for each in reduced["maps"]] == ["genus"]
    assert list(reduced["maps"][0]["panels"]) == ["fem"]
    assert "genus" in capsys.readouterr().out
    path.write_text('{"maps": 3}')
    assert cli.main(["stability", "--from", str(path)]) == 1
    assert "not a record" in capsys.readouterr().err


def test_a_silent_point_of_the_default_method_fails_the_command(record, tmp_path, capsys):
    path = tmp_path / "record.json"
    spoilt = json.loads(json.dumps(record))
    spoilt["maps"][0]["panels"]["fem"][0][0] |= {"class": SILENT}
    path.write_text(json.dumps(spoilt))
    assert cli.main(["stability", "--from", str(path)]) == 3
    assert f"wrong silently: {spoilt['maps'][0]['name']}" in capsys.readouterr().out


def test_names_that_there_are_not_are_refused_with_those_that_there_are(capsys):
    assert cli.main(["stability", "--axis", "colour"]) == 1
    assert "mean-free-path" in capsys.readouterr().err
    assert cli.main(["stability", "--method", "sn"]) == 1
    assert "quadgraph-fv" in capsys.readouterr().err


def test_cells_say_the_larger_error_and_need_no_more_than_four_characters():
    assert map_figures.text_of({"class": ACCURATE, "true": {"whole": 0.0123, "unlit": 0.2}}) == "20"
    assert map_figures.text_of({"class": ACCURATE, "true": {"whole": 0.0123, "unlit": None}}) == "1.2"
    assert map_figures.text_of({"class": REFUSED, "said": ["no"]}) == "x"
    assert max(len(map_figures.percent(10.0**e)) for e in range(-12, 4)) <= 6


def test_slivers_have_the_angle_that_is_asked_for_and_leave_the_surface_as_it_is():
    rest = deformed_shapes.block()[0]
    spoilt = deformed_shapes.with_slivers(deformed_shapes.block(), 0.5)[0]
    assert deformed_shapes.smallest_dihedral(spoilt.vertices, spoilt.tets) == pytest.approx(0.5, rel=0.02)
    assert spoilt.volume == pytest.approx(rest.volume)
    assert np.array_equal(np.sort(spoilt.boundary.vertices[spoilt.faces].sum(axis=1), axis=0), _sums(rest))


def _sums(mesh):
    return np.sort(mesh.boundary.vertices[mesh.faces].sum(axis=1), axis=0)


@pytest.mark.parametrize("genus", [0, 1, 5, 28])
def test_lattices_have_their_genus(genus):
    for level in deformed_shapes.lattice(genus):
        vertices = level.surface_vertex_count
        assert vertices - len(level.faces) / 2 == 2 - 2 * genus


def test_moved_vertices_are_refused_where_tets_fold_over_and_the_body_stays_as_it_was():
    chain = solids.ball("")
    chain.engine.set_vertices(0, chain.rest[0].vertices)
    with pytest.raises(InputError, match="inside out"):
        chain.take(lambda points: points * np.array([1.0, 1.0, -1.0]))
    with pytest.raises(InputError, match="expected"):
        chain.engine.set_vertices(0, np.zeros((3, 3)))
    case = solids.MAPS[0].cases(StabilitySetting(), (1.0,), (1.0,))(1.0, 1.0)
    assert judged_points.judge(case, stability_methods.DEFAULT)["class"] == ACCURATE
