"""Tets inside a body: how large they may be, that the surface stays as it is, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from quadgraph import VolumeMaterial
from quadgraph.baking.inside import LevelSizes, check_interior, sizes_of
from quadgraph.baking.light_decay import change_length, decay_rates
from quadgraph.base.errors import InputError, ToolError
from quadgraph.mesh.subdivide import subdivide
from quadgraph.mesh.surface import Surface, TetMesh
from quadgraph.tets import interior, tetgen
from quadgraph.tets.interior import Decay, Depths, Interior, Limits
from quadgraph.tets.tetrahedralise import tetrahedralise
from shapes import cube, icosphere, join, moved, torus

BALL = icosphere(4, 10)
OF_REGULAR = np.sqrt(2) / 12  # volume of a regular tet of edge 1
SLACK = 1.7  # TetGen leaves a few tets, next to a kept surface, that much above their limit


def edges_of(mesh: TetMesh) -> np.ndarray:
    """Edge of the regular tet of each tet's volume, mm."""
    return np.cbrt(mesh.determinants / 6 / OF_REGULAR)


def filled(surface: Surface, wanted: str | float | None = None, materials: tuple[str, ...] = ()) -> TetMesh:
    mesh, _, notes = sizes_of(surface, wanted, materials, "tetgen").fill(
        0, surface, lambda limits: tetrahedralise(surface, limits=limits)
    )
    assert not notes
    return mesh


@pytest.mark.parametrize(
    "surface",
    [
        BALL,
        subdivide(cube(8), 3),
        torus(),
        join(icosphere(3, 4), moved(cube(3), 9, 0, 0)),
        join(icosphere(3, 10), Surface(icosphere(3, 4).vertices, icosphere(3, 4).triangles[:, ::-1])),
    ],
    ids=["ball", "cube", "torus", "two pieces", "cavity"],
)
def test_the_surface_is_kept_and_filled_exactly(surface: Surface) -> None:
    plain, mesh = tetrahedralise(surface), filled(surface, 0.8)
    assert len(mesh.tets) > len(plain.tets)
    assert mesh.volume == pytest.approx(plain.volume, rel=1e-12)
    assert mesh.determinants.min() > 0
    assert np.array_equal(mesh.vertices[: len(surface.vertices)], surface.vertices)
    boundary = mesh.boundary()
    assert sorted(map(sorted, boundary.triangles.tolist())) == sorted(map(sorted, surface.triangles.tolist()))
    assert mesh.mesher.options == "-pYq1.4/0, -rYq1.4/0a"


@pytest.mark.parametrize("size", [1.0, 1.5, 2.5])
def test_no_tet_is_larger_than_asked_for(size: float) -> None:
    edges = edges_of(filled(BALL, size))
    assert edges_of(tetrahedralise(BALL)).max() > 1.5 * size
    assert np.cbrt(SLACK) * size > edges.max() > 0.7 * size


def test_edges_grow_no_faster_than_the_depth() -> None:
    """Without a size deep inside that would be reached first."""
    slow = Limits(BALL, Interior("size", (Decay(100.0, 0.0),), growth=0.3))
    shares = []
    for mesh in (tetrahedralise(BALL), tetrahedralise(BALL, limits=slow)):
        depth, of_surface = Depths(BALL).at(mesh.vertices[mesh.tets].mean(axis=1))
        shares.append(edges_of(mesh) / (of_surface + 0.3 * depth))
    assert np.mean(shares[0] > 1.2) > 0.02
    assert np.mean(shares[1] > 1.2) < 0.001
    assert shares[1].max() < 1.5


def test_depth_and_edges_of_the_surface_are_measured() -> None:
    points = np.array([[0, 0, 0], [0, 0, 9.0], [3.0, 4.0, 0]])
    depth, of_surface = Depths(BALL).at(points)
    np.testing.assert_allclose(depth, [10, 1, 5], atol=0.1)
    np.testing.assert_allclose(of_surface, 0.75, atol=0.1)
    assert interior.mean_chord(BALL) == pytest.approx(40 / 3, rel=0.01)


@pytest.mark.parametrize("surface", [BALL, icosphere(3, 10), torus()], ids=["ball", "coarse ball", "torus"])
def test_what_nobody_asked_for_costs_few_tets(surface: Surface) -> None:
    plain, mesh = tetrahedralise(surface), filled(surface)
    assert len(plain.tets) < len(mesh.tets) < 1.55 * len(plain.tets)
    assert edges_of(mesh).max() < edges_of(plain).max()


def test_a_fine_surface_gets_the_tenth_of_the_mean_chord() -> None:
    limits = Limits(icosphere(5, 10), interior.automatic(icosphere(5, 10)))
    mesh = tetrahedralise(icosphere(5, 10), limits=limits)
    assert limits.interior.edge == pytest.approx(4 / 3, rel=0.01)
    assert edges_of(mesh).max() < np.cbrt(SLACK) * limits.interior.edge


def test_coarser_levels_double_what_the_finest_settled_for() -> None:
    sizes = sizes_of(BALL, None, (), "tetgen")
    edges = [
        sizes.fill(number, surface, lambda limits, surface=surface: tetrahedralise(surface, limits=limits))[1]
        for number, surface in enumerate((BALL, icosphere(3, 10), icosphere(2, 10)))
    ]
    assert edges[0] > interior.CHORD_SHARE * interior.mean_chord(BALL)
    np.testing.assert_allclose(edges, edges[0] * 2.0 ** np.arange(3))


def test_edges_for_light_grow_where_little_comes_back_from() -> None:
    sizes = interior.for_rates(BALL, [0.5])
    depth = np.array([0.0, 3.0, 8.0])
    near, shallow, deep = sizes.edges(depth, np.full(3, 0.01))
    assert near == pytest.approx(0.01)  # as the surface
    assert shallow == pytest.approx(sizes.edge) == pytest.approx(0.35 / np.hypot(0.5, 2 / 20), rel=0.01)
    assert deep == pytest.approx(sizes.edge * np.exp(0.4 * (0.5 * 8 - 1.5)))
    coarse = sizes.edges(np.array([3.0]), np.array([2.0]))
    assert coarse == pytest.approx(1.5 * 2)  # a coarse surface decides


def test_the_material_decides() -> None:
    clear, dense = (filled(BALL, None, (f"sigma_s_prime=2,sigma_a={a}",)) for a in (0.001, 0.03))
    assert len(dense.tets) > len(clear.tets)
    both = filled(BALL, None, ("sigma_s_prime=2,sigma_a=0.001", "sigma_s_prime=2,sigma_a=0.03"))
    assert len(both.tets) >= len(dense.tets)


def test_rates_are_those_of_diffusion_but_never_above_extinction() -> None:
    assert decay_rates("sigma_s_prime=2,sigma_a=0.01") == pytest.approx((np.sqrt(3 * 0.01 * 2.01),))
    three = decay_rates("sigma_s_prime=1/1/0.03,sigma_a=0/0.1/1.45,eta=1.3")
    assert three == pytest.approx((0, np.sqrt(3 * 0.1 * 1.1), 1.48))


@pytest.mark.parametrize(
    "text", ["sigma_s_prime=2,sigma_a=-1", "sigma_s_prime=2,sigma_a=1/2", "sigma_s_prime=x,sigma_a=1"]
)
def test_bad_coefficients_are_named(text: str) -> None:
    with pytest.raises(InputError, match=r"material field 'sigma_(a|s_prime)': "):
        decay_rates(text)


def test_measured_materials_are_known_to_the_engine() -> None:
    pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    assert decay_rates("skin1") == pytest.approx(
        sorted(np.sqrt(3 * a * (a + s)) for s, a in ((0.74, 0.032), (0.88, 0.17), (1.01, 0.48)))
    )
    assert len(decay_rates("checker")) > len(decay_rates("skin1"))
    with pytest.raises(InputError, match="stardust"):
        decay_rates("stardust")


def checker(cell: float, scattering: float = 2.5, absorption: float = 0.1) -> str:
    """A material that changes on every cell of so many mm."""
    second = f"second_sigma_s_prime={scattering},second_sigma_a={absorption},pattern=checker,period={cell}"
    return f"sigma_s_prime=0.5,sigma_a=0.01,{second}"


def volume(cell: float, path: Path) -> str:
    """The same as a grid."""

    def at(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        odd = np.floor(points / cell).sum(axis=1) % 2 > 0
        return np.where(odd, 2.5, 0.5), np.where(odd, 0.1, 0.01)

    VolumeMaterial.from_function(at, [[-10.2] * 3, [10.2] * 3], cell / 20).save(path)
    return str(path)


def test_a_material_changes_on_ways_as_long_as_its_cells(tmp_path) -> None:
    """Straight ways through cubes are 2/3 of an edge long on average."""
    for cell in (1.5, 3.0):
        assert change_length(checker(cell), BALL) == pytest.approx(2 / 3 * cell, rel=0.2)
    as_grid = change_length(volume(3.0, tmp_path / "cells.npz"), BALL)
    assert as_grid == pytest.approx(change_length(checker(3.0), BALL), rel=0.1)
    assert change_length("skin1", BALL) == np.inf
    slight = change_length(checker(1.5, 0.55, 0.011), BALL)  # a tenth more: a tenth of a change by e
    assert slight == pytest.approx(1.0 / np.log(1.1), rel=0.25)
    layered = "sigma_s_prime=1,sigma_a=.1,second_sigma_s_prime=4,second_sigma_a=.1,pattern=layers,period=2,sharpness=9"
    assert change_length(layered, BALL) == pytest.approx(10, rel=0.05)  # once on the way to the middle


def test_tets_are_as_small_as_what_the_material_has_cells_for(tmp_path) -> None:
    pale = [volume(cell, tmp_path / f"{cell}.npz") for cell in (3.0, 40.0)]
    fine, coarse = (filled(BALL, None, (each,)) for each in pale)
    assert len(fine.tets) > len(coarse.tets)
    sizes = interior.for_rates(BALL, [0.01], change=2.0)
    assert sizes.edges(np.array([8.0]), np.array([0.01])) == pytest.approx(0.35 * 2.0)


def test_a_volume_that_cannot_be_read_is_named(tmp_path) -> None:
    with pytest.raises(InputError, match=r"nothing\.npz"):
        check_interior(None, (str(tmp_path / "nothing.npz"),), "tetgen")


@pytest.mark.parametrize(
    ("wanted", "materials", "mesher", "words"),
    [
        ("fine", (), "tetgen", "'fine' found, allowed are 'auto', 'surface'"),
        (0.0, (), "tetgen", "0.0 found"),
        (float("nan"), (), "tetgen", "nan found"),
        (1.0, (), "polygrid", "interior: found with mesher 'polygrid'"),
        (None, ("sigma_s_prime=1,sigma_a=1",), "polygrid", "for_materials: found with mesher 'polygrid'"),
        ("auto", (), "cgal", "which grading sizes"),
        (1.0, ("sigma_s_prime=1,sigma_a=1",), "tetgen", "one of them"),
        (None, ("sigma_s_prime=1,sigma_a=0",), "tetgen", "absorbs nothing"),
    ],
)
def test_bad_wishes_are_refused(wanted, materials, mesher, words) -> None:
    with pytest.raises(InputError, match=words):
        check_interior(wanted, materials, mesher)


def test_a_size_that_makes_too_many_tets_is_refused() -> None:
    with pytest.raises(InputError, match=r"0\.001 mm would make about .* tets"):
        filled(BALL, 0.001)


def test_a_surface_too_coarse_for_a_size_is_told_of() -> None:
    notes = []
    for surface in (cube(8), subdivide(cube(8), 3)):
        sizes = sizes_of(surface, 0.8, (), "tetgen")
        notes.append(sizes.fill(0, surface, lambda limits, surface=surface: tetrahedralise(surface, limits=limits))[2])
    assert "100% of the tets have more than twice the volume asked for" in notes[0][0]
    assert "--refine" in notes[0][0]
    assert not notes[1]


def test_a_level_that_cannot_be_refined_stays_as_it_was_unless_a_size_was_asked_for() -> None:
    def made(limits: Limits | None) -> TetMesh:
        if limits is not None:
            raise ToolError("tetgen: no")
        return tetrahedralise(BALL)

    mesh, edge, notes = LevelSizes(interior.automatic(BALL)).fill(0, BALL, made)
    assert (len(mesh.tets), edge) == (len(tetrahedralise(BALL).tets), None)
    assert "as the surface makes them: tetgen: no" in notes[0]
    asked = LevelSizes(Interior("size", (Decay(1.0, 0.0),)))
    with pytest.raises(ToolError, match="no"):
        asked.fill(0, BALL, made)


def test_a_coarser_level_that_cannot_be_refined_does_not_end_the_chain() -> None:
    def made(limits: Limits | None) -> TetMesh:
        if limits is not None and limits.interior.edge > 1.5:
            raise ToolError("tetgen: no")
        return tetrahedralise(BALL, limits=limits)

    asked = LevelSizes(Interior("size", (Decay(1.0, 0.0),)))
    assert asked.fill(0, BALL, made)[1] == 1.0
    _, edge, notes = asked.fill(1, BALL, made)
    assert edge is None
    assert "level 1: tets inside are as the surface makes them" in notes[0]


def test_refining_may_take_as_much_longer_as_it_makes_more_tets(monkeypatch) -> None:
    foreseen = []

    def noted(filling_s: float, filled: int, expected: float) -> float:
        foreseen.append((filled, expected))
        return refining_s(filling_s, filled, expected)

    refining_s = tetgen.refining_s
    monkeypatch.setattr(tetgen, "refining_s", noted)
    first = len(tetrahedralise(BALL).tets)
    for edge in (1.6, 0.8):
        foreseen.clear()
        made = len(filled(BALL, edge).tets)
        assert foreseen[0][0] == first
        assert 0.6 < foreseen[0][1] / made < 1.7
    assert refining_s(2.0, 1000, 500_000) == 100 * refining_s(2.0, 1000, 5_000)
    assert refining_s(0.01, 1000, 2000) == refining_s(0.02, 1000, 1000)  # a least time, for machines with other work


def test_tets_are_refined_less_well_where_that_has_no_end_otherwise(monkeypatch) -> None:
    monkeypatch.setattr(tetgen, "REFINE", "-rYq.3/0a")
    monkeypatch.setattr(tetgen, "_LEAST_REFINING_S", 2)
    monkeypatch.setattr(tetgen, "_MOST_REFINING", 0)
    mesh = filled(subdivide(cube(8), 2), 2.0)
    assert mesh.mesher.options == f"{tetgen.OPTIONS}, {tetgen.REFINE_LOOSELY}"
    assert edges_of(mesh).max() < 2 * SLACK
