"""Files whose checksums are right and whose sections contradict each other: refused."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from baked import write_levels
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.errors import FormatError
from quadgraph.file import qgraph_file
from shapes import from_trimesh, torus, write_obj


def seen_by(seen: np.ndarray, change) -> np.ndarray:
    """Rows of what faces see, changed, as the file keeps them."""
    count = int(seen[0]) - 1
    rows = change([seen[int(seen[f]) : int(seen[f + 1])] for f in range(count)])
    begins = count + 1 + np.concatenate([[0], np.cumsum([len(row) for row in rows])])
    return np.concatenate([begins, *rows])


CASES = {
    "one vertex far away": ("display/vertices", lambda a: np.concatenate([a[:1] + 1e6, a[1:]])),
    "rough": ("display/vertices", lambda a: a + np.random.default_rng(1).normal(size=a.shape).astype("f4") * 0.05),
    "all in one point": ("display/vertices", lambda a: a * 0),
    "vertices shuffled": ("display/vertices", lambda a: np.roll(a, 7, axis=0)),
    "vertices times 100": ("display/vertices", lambda a: a * 100),
    "vertices elsewhere": ("display/vertices", lambda a: a + 50),
    "normals inwards": ("display/normals", lambda a: -a),
    "normals of no length": ("display/normals", lambda a: a * 0),
    "normals of 1e30": ("display/normals", lambda a: a * 1e30),
    "triangles inside out": ("display/triangles", lambda a: a[:, [0, 2, 1]]),
    "triangles left out": ("display/triangles", lambda a: a[: len(a) // 2]),
    "a triangle left out": ("display/triangles", lambda a: a[1:]),
    "one face for all": ("display/face", lambda a: a * 0),
    "faces shuffled": ("display/face", lambda a: np.roll(a, 7)),
    "nodes in one point": ("level0/nodes", lambda a: a * 0),
    "nodes elsewhere": ("level0/nodes", lambda a: a + 5),
    "nodes shuffled": ("level0/nodes", lambda a: np.roll(a, 7, axis=0)),
    "nodes of a coarser level elsewhere": ("level1/nodes", lambda a: a + 5),
    "rows of other faces": ("level0/seen", lambda a: seen_by(a, lambda rows: rows[7:] + rows[:7])),
    "faces that nobody sees": ("level0/seen", lambda a: seen_by(a, lambda rows: [row[:0] for row in rows])),
    "the same face everywhere": (
        "level0/seen",
        lambda a: seen_by(a, lambda rows: [row * 0 + (i < 9) for i, row in enumerate(rows)]),
    ),
    "more rays than the rows are of": ("level0/seen_rays", lambda a: a * 2),
    "rays that no bake sends": ("level0/seen_rays", lambda a: a * 0 + 1000000),
    "links in another order": ("level0/links", lambda a: a[:, [1, 0, 2, 3]]),
}


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    folder = tmp_path_factory.mktemp("places")
    mesh = write_obj(torus(10, 4, 24, 12), folder / "ring.obj")
    bake(mesh, folder / "ring.qgraph", BakeOptions(unit="mm", levels=2, surface_vertices=120))
    return folder / "ring.qgraph"


def sealed(ring, path, section: str, change) -> None:
    """Write the file with one section changed and its checksums right."""
    file = qgraph_file.read(ring)
    sections = {name: array for name, array in file.sections.items() if name != "metadata"}
    sections[section] = np.ascontiguousarray(change(sections[section])).astype(sections[section].dtype)
    qgraph_file.write_sections(path, file.metadata, sections)


@pytest.mark.parametrize("case", CASES)
def test_sections_that_contradict_each_other_are_refused(ring, tmp_path, case):
    path = tmp_path / "bad.qgraph"
    sealed(ring, path, *CASES[case])
    with pytest.raises(FormatError, match=r"bad\.qgraph: (level|display)") as error:
        qgraph_file.read(path)
    assert len(str(error.value)) < 500


@pytest.mark.parametrize("scale", [1e-30, 1e-12, 1e12, 1e30])
def test_bodies_beyond_single_precision_are_refused(ring, tmp_path, scale):
    file = qgraph_file.read(ring)
    sections = {name: array for name, array in file.sections.items() if name != "metadata"}
    for name in sections:
        if name.endswith(("/vertices", "/nodes")):
            sections[name] = (sections[name] * scale).astype("<f4")
    path = tmp_path / "bad.qgraph"
    qgraph_file.write_sections(path, file.metadata, sections)
    with pytest.raises(FormatError, match=r"longest side|not positively oriented"):
        qgraph_file.read(path)


def test_a_display_that_is_finer_than_the_faces_is_good(ring):
    assert qgraph_file.read(ring).level_count == 2


SOLIDS = {
    "right-angled tetrahedron": [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]],
    "flat tetrahedron": [[0, 0, 0], [9, 0, 1], [1, 9, 0], [7, 6, 2]],
    "spike": [[2, 0, 0], [-1, 1.7, 0], [-1, -1.7, 0], [0, 0, 20]],
}


@pytest.mark.parametrize("corners", SOLIDS.values(), ids=SOLIDS.keys())
def test_bodies_of_sharp_corners_are_read_and_each_side_has_a_face_of_its_own(tmp_path, corners):
    """Every corner is a display vertex for each of its sides, with a normal near that side's."""
    hull = trimesh.convex.convex_hull(np.array(corners, float))
    path = write_levels(tmp_path / "sharp.qgraph", [from_trimesh(hull)])
    file = qgraph_file.read(path)
    faces = file.sections["level0/vertices"][file.sections["level0/faces"][file.sections["display/face"]]]
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", normals, file.sections["display/normals"]).min() > 0.7
