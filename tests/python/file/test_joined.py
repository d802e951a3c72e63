"""Files of several bodies: what they hold, and what is refused of them."""

from __future__ import annotations

import numpy as np
import pytest

import tiny
import two_cubes
from baked import write_levels
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import joined, qgraph_file, sections
from quadgraph.tets import exchange
from shapes import icosphere, moved

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

NAMES = ["left", "right"]


@pytest.fixture(scope="module")
def alone(tmp_path_factory) -> list[qgraph_file.QGraphFile]:
    """A ball of two levels, and another of one."""
    folder = tmp_path_factory.mktemp("alone")
    ball = [icosphere(2, 3.0), icosphere(1, 3.0)]
    other = moved(icosphere(1, 2.0), 7.0, 0.0, 0.0)
    paths = [write_levels(folder / "ball.qgraph", ball), write_levels(folder / "other.qgraph", [other])]
    return [qgraph_file.read(path) for path in paths]


@pytest.fixture(scope="module")
def parts(alone) -> tuple[dict, dict]:
    """Metadata and sections of both as one file, with what the faces see."""
    content = joined.join([{k: v for k, v in file.sections.items() if k != "metadata"} for file in alone])
    graphs = joined.graphs(content)
    metadata = alone[0].metadata | {
        "levels": [sections.level_metadata(graph) for graph in graphs],
        "bodies": [{"name": name} for name in NAMES],
    }
    return metadata, joined.with_seen(content, exchange.bake(graphs, 16))


def test_both_bodies_are_as_they_were_alone(alone, parts, tmp_path):
    path = tmp_path / "both.qgraph"
    qgraph_file.write(path, *parts)
    loaded = _core.load(path)
    assert loaded.bodies == NAMES
    assert [len(level.tets) for level in loaded.levels] == [
        len(alone[0].sections[f"level{i}/tets"]) + len(alone[1].sections["level0/tets"]) for i in (0, 1)
    ]
    fine = loaded.levels[0]
    for body, file in enumerate(alone):
        mine = np.flatnonzero(fine.tet_bodies == body)
        of = file.sections
        assert np.array_equal(fine.vertices[fine.tets[mine]], of["level0/vertices"][of["level0/tets"]])
        faces = np.flatnonzero(fine.tet_bodies[fine.face_tets] == body)
        assert np.array_equal(fine.vertices[fine.faces[faces]], of["level0/vertices"][of["level0/faces"]])
        shown = np.isin(loaded.display["face"], faces)
        assert np.array_equal(loaded.display["vertices"][shown], of["display/vertices"])


def test_values_go_from_level_to_level_within_a_body(parts, tmp_path):
    path = tmp_path / "both.qgraph"
    qgraph_file.write(path, *parts)
    fine, coarse = _core.load(path).levels
    index, weight = fine.inner
    assert (coarse.tet_bodies[index] == fine.tet_bodies[:, None]).all()
    constant = np.where(coarse.tet_bodies == 1, 5.0, 2.0)
    assert np.allclose((weight * constant[index]).sum(axis=1), np.where(fine.tet_bodies == 1, 5.0, 2.0))
    index, weight = fine.barycentric
    found = (weight[:, :, None] * coarse.vertices[index]).sum(axis=1)
    of_other = np.unique(fine.tets[fine.tet_bodies == 1])
    assert np.allclose(found[of_other], fine.vertices[of_other], atol=1e-5)  # its only level is both


def test_the_faces_of_one_body_see_those_of_the_other(parts, tmp_path):
    path = tmp_path / "both.qgraph"
    qgraph_file.write(path, *parts)
    level = next(level for level in _core.load(path).levels if len(level.seen))
    body, seen = level.tet_bodies[level.face_tets], level.seen.astype(np.int64)
    rows = np.repeat(np.arange(len(level.faces)), np.diff(seen[: len(level.faces) + 1]))
    met = seen[len(level.faces) + 1 :]
    assert len(met) > 0
    assert (body[rows] != body[met]).all()  # two balls, neither of which sees itself


BROKEN = {
    "an index of no body": ("level0/tet_bodies", lambda a: a + 1, "index 2, allowed is below 2"),
    "all of one body": ("level1/tet_bodies", lambda a: a * 0, "body 1 has no tet"),
    "other rows": ("level0/tet_bodies", lambda a: a[:-1], "rows, expected"),
    "a tet of the wrong body": ("level0/tet_bodies", lambda a: np.r_[1 - a[:1], a[1:]], "two bodies|another body"),
    "levels that mix": ("level0/inner_index", lambda a: a * 0, "takes from another body"),
    "surfaces that mix": ("level0/surface_index", lambda a: a * 0, "takes from another body"),
    "vertices that mix": ("level0/barycentric_index", lambda a: a * 0, "takes from another body"),
    "left out": ("level0/tet_bodies", None, "the section is missing"),
}


@pytest.mark.parametrize(("name", "change", "message"), BROKEN.values(), ids=BROKEN)
def test_broken_rules_of_bodies_are_named(parts, name, change, message, tmp_path):
    metadata, content = parts
    damaged = {k: v for k, v in content.items() if k != name or change}
    if change:
        damaged[name] = np.ascontiguousarray(change(content[name]))
    with pytest.raises(FormatError, match=message):
        qgraph_file.write(tmp_path / "broken.qgraph", metadata, damaged)
    assert not list(tmp_path.iterdir())


NAMED = {
    "none": [],
    "one that is no object": ["left", "right"],
    "one twice": [{"name": "left"}, {"name": "left"}],
    "empty": [{"name": ""}, {"name": "right"}],
    "a path": [{"name": "a/b"}, {"name": "right"}],
    "long": [{"name": "a" * 65}, {"name": "right"}],
    "too few": [{"name": "left"}],
    "a number": 7,
}


@pytest.mark.parametrize("bodies", NAMED.values(), ids=NAMED)
def test_names_of_bodies_are_checked(parts, bodies, tmp_path):
    metadata, content = parts
    with pytest.raises(FormatError, match=r"bodies|body|allowed is below"):
        qgraph_file.write(tmp_path / "broken.qgraph", metadata | {"bodies": bodies}, content)


def test_a_file_that_states_bodies_and_has_none_is_refused(alone, tmp_path):
    content = {k: v for k, v in alone[0].sections.items() if k != "metadata"}
    with pytest.raises(FormatError, match="tet_bodies: the section is missing"):
        qgraph_file.write(tmp_path / "x.qgraph", alone[0].metadata | {"bodies": [{"name": "left"}]}, content)


def test_every_damaged_byte_of_what_is_new_is_refused(parts, tmp_path):
    path = tmp_path / "both.qgraph"
    qgraph_file.write(path, *parts)
    data = bytearray(path.read_bytes())
    at = data.find(bytes(parts[1]["level1/tet_bodies"].tobytes()))
    assert at > 0
    for byte in range(at, at + len(parts[1]["level1/tet_bodies"])):
        data[byte] ^= 1
        with pytest.raises(FormatError):
            _core.parse(bytes(data))
        data[byte] ^= 1


def test_what_cannot_be_joined_is_said(parts):
    with pytest.raises(InputError, match="several bodies"):
        joined.join([parts[1], parts[1]])
    with pytest.raises(InputError, match="257 found, at most 256"):
        joined.join([parts[1]] * 257)


def test_golden_bytes_of_two_bodies(tmp_path):
    file = qgraph_file.read(two_cubes.PATH)
    content = {name: array for name, array in file.sections.items() if name != "metadata"}
    qgraph_file.write(tmp_path / "again.qgraph", file.metadata, content)
    assert (tmp_path / "again.qgraph").read_bytes() == two_cubes.PATH.read_bytes()
    for name, array in two_cubes.all_sections().items():
        np.testing.assert_allclose(array, content[name], atol=1e-6, err_msg=name)
    assert _core.load(two_cubes.PATH).bodies == list(two_cubes.NAMES)


def test_files_without_bodies_are_one_without_a_name():
    loaded = _core.load(tiny.PATH)
    assert loaded.bodies == []
    assert len(loaded.levels[0].tet_bodies) == 0
