"""Files of bodies within others: what the reader refuses of them."""

from __future__ import annotations

import numpy as np
import pytest

import nested_cubes
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.base.errors import FormatError
from quadgraph.file import qgraph_file
from shapes import icosphere, moved, write_obj

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> qgraph_file.QGraphFile:
    """A stone in jelly, two levels, and a ball beside them."""
    folder = tmp_path_factory.mktemp("stone")
    shapes = {"jelly": icosphere(3, 5.0), "stone": icosphere(2, 2.0), "ball": moved(icosphere(2, 2.0), 9, 0, 0)}
    meshes = [BodyMesh(name, write_obj(shape, folder / f"{name}.obj"), unit="mm") for name, shape in shapes.items()]
    bake_bodies(meshes, folder / "three.qgraph", BakeOptions(visibility_rays=0, levels=2))
    return qgraph_file.read(folder / "three.qgraph")


def written(file, path, within: dict, **changed) -> None:
    """Write the file with other hosts of its bodies, by their numbers, and other sections."""
    bodies = [{key: value for key, value in body.items() if key != "within"} for body in file.metadata["bodies"]]
    for number, host in within.items():
        bodies[number] = bodies[number] | {"within": host}
    sections = {name: array for name, array in file.sections.items() if name != "metadata"}
    qgraph_file.write(path, file.metadata | {"bodies": bodies}, sections | changed)


def test_it_is_written_again_as_it_was(file, tmp_path):
    written(file, tmp_path / "same.qgraph", {1: "jelly"})
    assert _core.load(tmp_path / "same.qgraph").hosts == [0, 0, 2]


HOSTS = {
    "none": ({}, "level0/(links|tets): row .*another body|a link joins two bodies"),
    "another": ({1: "ball"}, "a link joins two bodies"),
    "one that is not there": ({1: "cup"}, "row 1: 'within' must be the name of another body"),
    "itself": ({1: "stone"}, "row 1: 'within' must be the name of another body"),
    "a number": ({1: 0}, "row 1: 'within' must be the name of another body"),
    "nothing": ({1: None}, "row 1: 'within' must be the name of another body"),
    "a circle": ({0: "stone", 1: "jelly"}, "row 0: 'within' leads in a circle"),
    "the wrong way round": ({0: "stone"}, "of a body within another, has a vertex on the surface"),
    "one that lies apart": ({1: "jelly", 2: "jelly"}, "has a vertex on the surface"),
}


@pytest.mark.parametrize(("within", "message"), HOSTS.values(), ids=HOSTS)
def test_hosts_that_cannot_be_are_refused(file, within, message, tmp_path):
    with pytest.raises(FormatError, match=message):
        written(file, tmp_path / "broken.qgraph", within)
    assert not list(tmp_path.iterdir())


def changed_bodies(file, which) -> np.ndarray:
    """The bodies of tets, in which one of those that `which` says has that of another."""
    bodies = file.sections["level0/tet_bodies"].copy()
    bodies[np.flatnonzero(which(bodies))[0]] = 1
    return bodies


def test_tets_of_the_wrong_body_are_refused(file, tmp_path):
    face_tets = file.sections["level0/face_tets"]
    at_surface = changed_bodies(file, lambda bodies: np.isin(np.arange(len(bodies)), face_tets) & (bodies == 0))
    with pytest.raises(FormatError, match="has a vertex on the surface"):
        written(file, tmp_path / "a.qgraph", {1: "jelly"}, **{"level0/tet_bodies": at_surface})
    of_ball = changed_bodies(file, lambda bodies: bodies == 2)
    with pytest.raises(FormatError, match=r"links: row .* a link joins two bodies"):
        written(file, tmp_path / "a.qgraph", {1: "jelly"}, **{"level0/tet_bodies": of_ball})
    of_coarse = file.sections["level0/inner_index"].copy()
    stone = np.flatnonzero(file.sections["level0/tet_bodies"] == 1)[0]
    of_coarse[stone, 0] = np.flatnonzero(file.sections["level1/tet_bodies"] == 2)[0]
    with pytest.raises(FormatError, match=r"inner_index: row .* takes from another body"):
        written(file, tmp_path / "a.qgraph", {1: "jelly"}, **{"level0/inner_index": of_coarse})


def test_golden_bytes_of_a_cube_within_a_cube(tmp_path):
    golden = qgraph_file.read(nested_cubes.PATH)
    content = {name: array for name, array in golden.sections.items() if name != "metadata"}
    qgraph_file.write(tmp_path / "again.qgraph", golden.metadata, content)
    assert (tmp_path / "again.qgraph").read_bytes() == nested_cubes.PATH.read_bytes()
    for name, array in nested_cubes.all_sections().items():
        assert np.array_equal(content[name], array), name
    loaded = _core.load(nested_cubes.PATH)
    assert (loaded.bodies, loaded.hosts) == (list(nested_cubes.NAMES), [1, 1])
    assert np.bincount(loaded.levels[0].tet_bodies)[0] == 6
