"""Each defect is repaired and reported, or refused with its place; a clean surface comes back untouched."""

from __future__ import annotations

import re
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh

from quadgraph.base.errors import InputError
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.mesh_io import read_surface
from quadgraph.mesh.repair import repair
from quadgraph.mesh.surface import Repair, Surface
from quadgraph.tets.tetrahedralise import tetrahedralise
from shapes import cube, icosphere, join, moved, torus

# shared/meshes/README.md: a high genus, and the most vertices of those that are quick
GOOD = ["bunny", "heptoroid"]
OTHER_GOOD = ["armadillo", "buddha", "dragon", "fandisk", "fertility", "gargoyle", "igea", "lucy", "spot", "twirl"]


def counts(repairs: list[Repair]) -> dict[str, int]:
    return {repair.what: repair.count for repair in repairs}


def with_triangles(surface: Surface, extra: np.ndarray) -> Surface:
    return Surface(surface.vertices, np.concatenate([surface.triangles, extra]))


@pytest.mark.parametrize("surface", [icosphere(3), cube(), torus(), join(icosphere(2), moved(cube(), 4, 0, 0))])
def test_clean_surface_is_untouched(surface: Surface) -> None:
    repaired, repairs = repair(surface, "clean")
    assert repairs == []
    assert np.array_equal(repaired.vertices, surface.vertices)
    assert np.array_equal(repaired.triangles, surface.triangles)


def test_triangle_soup_is_welded() -> None:
    sphere = icosphere(2)
    soup = Surface(sphere.corners.reshape(-1, 3), np.arange(sphere.triangles.size).reshape(-1, 3))
    repaired, repairs = repair(soup, "soup")
    assert counts(repairs) == {"duplicate vertices merged": 960 - 162}
    assert repaired.volume == pytest.approx(sphere.volume)


def test_near_vertices_are_welded() -> None:
    box = cube(2)
    rng = np.random.default_rng(0)
    points = box.corners.reshape(-1, 3) + rng.uniform(-2e-7, 2e-7, (36, 3))
    repaired, repairs = repair(Surface(points, np.arange(36).reshape(-1, 3)), "cube")
    assert sum(counts(repairs).values()) == 28
    assert "near vertices merged" in counts(repairs)
    assert repaired.volume == pytest.approx(8, rel=1e-5)


def test_unreferenced_degenerate_and_duplicate() -> None:
    sphere = icosphere(2)
    a, b, c = sphere.triangles[0]
    bad = with_triangles(sphere, np.array([[a, a, b], [a, b, c], [b, c, a]]))
    bad = Surface(np.concatenate([bad.vertices, [[0, 0, 0], [9, 9, 9.0]]]), bad.triangles)
    repaired, repairs = repair(bad, "sphere")
    assert counts(repairs) == {
        "degenerate triangles dropped": 1,
        "duplicate triangles dropped": 2,
        "unreferenced vertices dropped": 2,
    }
    assert repaired.volume == pytest.approx(sphere.volume)


def test_flap_without_thickness_is_dropped() -> None:
    sphere = icosphere(2)
    a, b = sphere.triangles[0, :2]
    vertices = np.concatenate([sphere.vertices, [2 * sphere.vertices[a]]])
    tip = len(sphere.vertices)
    flap = with_triangles(Surface(vertices, sphere.triangles), np.array([[a, b, tip], [b, a, tip]]))
    repaired, repairs = repair(flap, "flap")
    assert counts(repairs) == {"duplicate triangles dropped": 2, "unreferenced vertices dropped": 1}
    assert repaired.volume == pytest.approx(sphere.volume)


def test_orientation_is_turned_outward_and_cavities_inward() -> None:
    sphere = icosphere(2)
    rng = np.random.default_rng(5)
    mixed = np.where(rng.random(320)[:, None] < 0.4, sphere.triangles[:, ::-1], sphere.triangles)
    repaired, repairs = repair(Surface(sphere.vertices, mixed), "mixed")
    assert repaired.volume == pytest.approx(sphere.volume)
    assert counts(repairs)["triangles turned"] == (mixed != sphere.triangles).any(axis=1).sum()
    hollow, _ = repair(join(icosphere(2, 2), icosphere(2)), "hollow")
    assert hollow.volume == pytest.approx(7 * sphere.volume, rel=1e-6)
    assert tetrahedralise(hollow).volume == pytest.approx(hollow.volume, rel=1e-9)


def test_small_hole_is_closed_and_large_one_refused() -> None:
    sphere = icosphere(4)
    height = sphere.corners[:, :, 2].min(axis=1)
    small, repairs = repair(Surface(sphere.vertices, sphere.triangles[height < 0.97]), "pinhole")
    assert counts(repairs)["small holes closed"] == 1
    assert small.is_closed_manifold
    assert small.volume == pytest.approx(sphere.volume, rel=0.01)
    with pytest.raises(InputError, match=r"bowl: open shell: 1 holes.*mm"):
        repair(Surface(sphere.vertices, sphere.triangles[height < 0.3]), "bowl")


def test_tiny_floating_piece_is_dropped() -> None:
    dust = join(icosphere(3, 10), moved(icosphere(0, 0.1), 20, 0, 0)).rounded()
    repaired, repairs = repair(dust, "dust")
    assert counts(repairs) == {"tiny loose pieces dropped": 1}
    assert repaired.components == 1


def test_small_fold_is_cut_away() -> None:
    sphere = icosphere(5)
    vertices = sphere.vertices.copy()
    a, b = sphere.triangles[0, :2]
    vertices[a] += 3 * (vertices[b] - vertices[a])
    folded = Surface(vertices, sphere.triangles).rounded()
    assert len(intersecting_triangles(folded)) > 0
    repaired, repairs = repair(folded, "fold")
    assert "crossing triangles cut away" in counts(repairs)
    assert len(intersecting_triangles(repaired)) == 0
    assert repaired.is_closed_manifold
    assert repaired.genus == 0
    assert repaired.volume == pytest.approx(sphere.volume, rel=1e-3)


def test_large_crossing_is_refused_with_its_place() -> None:
    pair = join(icosphere(3), moved(icosphere(3), 0.9, 0.1, 0.05))
    with pytest.raises(InputError, match=r"pair: \d+ triangles cross each other.*between \(0\..*mm"):
        repair(pair, "pair")


def test_no_interior_is_refused() -> None:
    flat = Surface(cube().vertices * (1, 1, 1e-9), cube().triangles)
    with pytest.raises(InputError, match="flat: no interior"):
        repair(flat, "flat")


def test_one_sided_surface_is_refused() -> None:
    # The projective plane on six vertices: closed, each edge with two triangles, no orientation.
    faces = "012 023 034 045 051 124 235 341 452 513".split()  # noqa: SIM905
    vertices = np.random.default_rng(2).normal(size=(6, 3))
    with pytest.raises(InputError, match="one-sided"):
        repair(Surface(vertices, np.array([[int(c) for c in face] for face in faces])), "plane")


@pytest.mark.parametrize("name", [*GOOD, *(pytest.param(name, marks=pytest.mark.long) for name in OTHER_GOOD)])
def test_good_meshes_need_no_repair(shared: Path, name: str) -> None:
    source = read_surface(shared / "meshes" / f"{name}.ply", height_mm=100)
    repaired, repairs = repair(source.surface, name)
    assert repairs == []
    assert len(repaired.vertices) == source.vertices


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("beetle", "more than two triangles"),
        pytest.param("bunny-open", None, marks=pytest.mark.long),
        ("dragon-res3", "one-sided"),
        ("suzanne", "cross each other"),
        ("teapot", "open shell"),
    ],
)
def test_bad_meshes_are_repaired_or_refused(shared: Path, name: str, words: str | None) -> None:
    began = time.monotonic()
    source = read_surface(shared / "meshes" / "bad" / f"{name}.ply", height_mm=100)
    if words is None:
        repaired, repairs = repair(source.surface, name)
        assert repairs
        assert repaired.is_closed_manifold
        assert len(intersecting_triangles(repaired)) == 0
    else:
        with pytest.raises(InputError, match=words) as refusal:
            repair(source.surface, name)
        assert name in str(refusal.value)
        assert "mm" in str(refusal.value)
    assert time.monotonic() - began < 60


@pytest.mark.parametrize(
    ("options", "place"),
    [
        ({"unit": "mm"}, "between (-0.7, 0.9, -0.7) and (0.7, 0.9, 0.7) mm"),
        ({"unit": "m"}, "between (-0.7, 0.9, -0.7) and (0.7, 0.9, 0.7) of the file, whose unit is 1000 mm"),
        ({"longest_mm": 60, "up": "z"}, "between (-0.7, 0.9, -0.7) and (0.7, 0.9, 0.7) of the file, whose unit is"),
    ],
)
def test_a_refusal_tells_the_place_in_the_coordinates_of_the_file(tmp_path, options, place):
    box = trimesh.creation.box((1.4, 1.8, 1.4)).subdivide().subdivide()
    opened = box.submesh([np.flatnonzero(box.triangles_center[:, 1] < 0.89)], append=True)
    path = tmp_path / "box.ply"
    opened.export(path)
    source = read_surface(path, **options)
    with pytest.raises(InputError, match=re.escape("box.ply: open shell: 1 holes, ")) as refused:
        repair(source.surface, source.name, source.frame)
    assert place in str(refused.value)
