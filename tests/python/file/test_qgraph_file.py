"""The .qgraph container: golden bytes, atomic writing, and refusal of everything damaged."""

import dataclasses
import hashlib
import os
import stat
import zlib

import numpy as np
import pytest

import tiny
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_file, sections

GOLDEN = "ecfb3d78283e90e1633fb45583bc7ca231ef80abb6ae186e5c5a9eff49386e50"


@pytest.fixture(scope="module")
def data() -> bytes:
    return tiny.PATH.read_bytes()


@pytest.fixture
def parts(data: bytes) -> tuple[dict, dict[str, np.ndarray]]:
    """Return metadata and writable copies of all other sections."""
    file = qgraph_file.parse(data, "tiny")
    return file.metadata, {name: array.copy() for name, array in file.sections.items() if name != "metadata"}


def test_golden_bytes(data, parts, tmp_path):
    size = qgraph_file.write(tmp_path / "again.qgraph", *parts)
    assert hashlib.sha256(data).hexdigest() == GOLDEN
    assert (tmp_path / "again.qgraph").read_bytes() == data
    assert size == len(data)


def test_the_hand_made_object_is_still_what_was_committed(parts):
    for name, array in tiny.all_sections().items():
        np.testing.assert_allclose(array, parts[1][name], atol=1e-6, err_msg=name)


def test_sections_are_aligned_views(data):
    file = qgraph_file.parse(data, "tiny")
    start = np.frombuffer(data, np.uint8).ctypes.data
    for array in file.sections.values():
        assert (array.ctypes.data - start) % 64 == 0
        assert not array.flags.writeable
    assert file.level_count == 2


def test_face_kinds_are_optional_and_checked(tmp_path):
    core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    levels = tiny.graphs()
    kinds = np.arange(len(levels[0].faces)) % 2
    levels[0] = dataclasses.replace(levels[0], face_kinds=kinds)
    sections_ = sections.whole_file(levels, tiny.six().boundary())
    path = tmp_path / "walls.qgraph"
    qgraph_file.write(path, tiny.metadata(levels), sections_)
    finest, coarsest = core.load(path).levels
    assert list(finest.face_kinds) == list(kinds)
    assert len(coarsest.face_kinds) == 0
    sections_["level0/face_kinds"] = np.full_like(sections_["level0/face_kinds"], 2)
    with pytest.raises(FormatError, match="face_kinds"):
        qgraph_file.write(path, tiny.metadata(levels), sections_)
    assert list(core.load(path).levels[0].face_kinds) == list(kinds)


def _with_seen(parts: tuple[dict, dict[str, np.ndarray]], level: int = 0) -> dict[str, np.ndarray]:
    """Sections with what the faces of a level see: face 2 sees 5 twice and 7, the last one sees 0."""
    n_f = len(parts[1][f"level{level}/faces"])
    begins = np.full(n_f + 1, n_f + 1)
    begins[3:], begins[-1] = n_f + 4, n_f + 5
    seen = np.concatenate([begins, [5, 5, 7, 0]]).astype("<u4")
    result = {}
    for name, array in parts[1].items():
        result[name] = array
        if name == f"level{level}/nodes":
            result |= {f"level{level}/seen_rays": np.array([3], "<u4"), f"level{level}/seen": seen}
    return result


def test_what_faces_see_is_optional_and_read_as_written(parts, data, tmp_path):
    """A cube sees the sky alone."""
    core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    path, written = tmp_path / "seen.qgraph", _with_seen(parts)
    written["level0/seen"] = np.full(13, 13, "<u4")
    qgraph_file.write(path, parts[0], written)
    finest, coarsest = core.load(path).levels
    assert list(finest.seen) == [13] * 13
    assert finest.seen_rays == 3
    assert (len(coarsest.seen), coarsest.seen_rays) == (0, 0)
    assert qgraph_file.read(path).sections["level0/seen"].tolist() == list(finest.seen)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s.update({"level0/seen_rays": np.zeros(1, "<u4")}), r"level0/seen_rays: 0 found, 1 to 4096 allowed"),
        (
            lambda s: s.update({"level0/seen_rays": np.array([2], "<u4")}),
            r"level0/seen: row 2: 3 entries, allowed are at most 2",
        ),
        (lambda s: s.update({"level0/seen_rays": np.array([2, 2], "<u4")}), r"level0/seen_rays: one number expected"),
        (lambda s: s.update({"level0/seen": s["level0/seen"][:12]}), r"level0/seen: 12 values, expected at least 13"),
        (lambda s: s.update({"level0/seen": s["level0/seen"][:-1]}), r"level0/seen: the last row ends at 17"),
        (lambda s: s["level0/seen"].__setitem__(0, 12), r"level0/seen: row 0: must begin at 13"),
        (lambda s: s["level0/seen"].__setitem__(4, 15), r"level0/seen: row 3: ends before it begins"),
        (lambda s: s["level0/seen"].__setitem__(16, 12), r"level0/seen: row 11: face 12, allowed is below 12"),
        (lambda s: s["level0/seen"].__setitem__(16, 11), r"level0/seen: row 11: a face does not see itself"),
        (lambda s: s["level0/seen"].__setitem__(14, 8), r"level0/seen: row 2: faces are not in ascending order"),
        (
            lambda s: None,
            r"level0/seen: 4 of the 36 rays of 12 rows meet other faces than are stored, allowed are 2; bake",
        ),
        (lambda s: s.pop("level0/seen"), r"expected 'level0/seen'"),
        (lambda s: s.pop("level0/seen_rays"), r"expected 'level0/seen_rays'"),
    ],
)
def test_broken_rules_of_what_faces_see_are_named(parts, change, message, tmp_path):
    sections_ = _with_seen(parts)
    change(sections_)
    with pytest.raises(FormatError, match=message):
        qgraph_file.write(tmp_path / "bad.qgraph", parts[0], sections_)
    assert not list(tmp_path.iterdir())


def test_only_one_level_tells_what_its_faces_see(parts, tmp_path):
    both = _with_seen((parts[0], _with_seen(parts, 0)), 1)
    with pytest.raises(FormatError, match="level1/seen: only one level may have it"):
        qgraph_file.write(tmp_path / "bad.qgraph", parts[0], both)


def test_every_truncated_prefix_is_refused(data):
    for length in range(len(data)):
        with pytest.raises(FormatError):
            qgraph_file.parse(data[:length], "prefix")


def test_every_damaged_byte_is_refused(data):
    generator = np.random.default_rng(1)
    for position in range(len(data)):
        damaged = bytearray(data)
        damaged[position] ^= int(generator.integers(1, 256))
        with pytest.raises(FormatError):
            qgraph_file.parse(bytes(damaged), "damaged")


@pytest.mark.parametrize("extra", [1, 64])
def test_trailing_bytes_are_refused(data, extra):
    longer = bytearray(data + bytes(extra))
    with pytest.raises(FormatError, match="file_size"):
        qgraph_file.parse(bytes(longer), "longer")
    longer[24:32] = len(longer).to_bytes(8, "little")
    with pytest.raises(FormatError, match="the last section ends at"):
        qgraph_file.parse(bytes(longer), "longer")


def test_huge_shapes_are_refused_before_anything_is_allocated(data):
    forged = bytearray(data)
    entry = 64 + 128  # level0/vertices
    forged[entry + 72 : entry + 80] = (2**62).to_bytes(8, "little")
    forged[entry + 104 : entry + 112] = (2**64 - 12).to_bytes(8, "little")
    table = bytes(forged[64 : 64 + 128 * int.from_bytes(forged[16:20], "little")])
    forged[20:24] = zlib.crc32(table).to_bytes(4, "little")
    with pytest.raises(FormatError, match="level0/vertices: shape does not fit"):
        qgraph_file.parse(bytes(forged), "forged")


def _poke(name: str, where: object, value: float):
    def change(sections: dict[str, np.ndarray]) -> None:
        sections[name][where] = value

    return change


def _swap(name: str, a: object, b: object):
    def change(sections: dict[str, np.ndarray]) -> None:
        array = sections[name]
        array[a], array[b] = array[b].copy(), array[a].copy()

    return change


def _unlink(sections: dict[str, np.ndarray]) -> None:
    links, n_t = sections["level0/links"], len(sections["level0/tets"])
    row, column = np.argwhere(links < n_t)[0]
    links[row, column] = (links[row, column] + 1) % n_t


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_poke("level0/tets", (0, 0), 14), r"level0/tets: row 0: index 14, allowed is below 14"),
        (_swap("level0/tets", (0, 0), (0, 1)), r"level0/tets: row 0: not positively oriented"),
        (_poke("level1/vertices", (0, 0), np.nan), r"level1/vertices: row 0: a value is not finite"),
        (_poke("level0/face_tets", 0, 24), r"level0/face_tets: row 0: index 24, allowed is below 24"),
        (_swap("level0/face_tets", 0, 1), r"level0/face_tets: row 0: does not name the tet"),
        (_swap("level0/faces", (0, 0), (0, 1)), r"level0/faces: row 0: not the outward face"),
        (_poke("level0/links", (0, 0), 36), r"level0/links: row 0: index 36"),
        (_unlink, r"level0/links: row 0: no link back from tet 2"),
        (_poke("level0/inner_weight", (0, 0), -0.5), r"level0/inner_weight: row 0: a weight is negative"),
        (_poke("level0/surface_weight", (0, 0), 7), r"level0/surface_weight: row 0: weights sum to"),
        (_poke("level0/barycentric_index", (0, 0), 12), r"level0/barycentric_index: row 0: index 12"),
        (_poke("display/triangles", (0, 0), 24), r"display/triangles: row 0: index 24"),
        (_poke("display/face", 0, 12), r"display/face: row 0: index 12"),
        (_poke("display/barycentric", (0, 0), 2), r"display/barycentric: row 0: weights"),
        (lambda s: s.pop("level0/inner_index"), r"expected 'level0/inner_index'"),
        (lambda s: s.update(extra=np.zeros(1, "<u4")), r"found 'extra', expected no more sections"),
        (lambda s: s.update({"level0/tets": s["level0/tets"].astype("<f4")}), "level0/tets: wrong type or shape"),
        (lambda s: s.update({"level0/nodes": s["level0/nodes"][:-1]}), r"level0/nodes: 35 rows, expected 36"),
    ],
)
def test_broken_rules_are_named(parts, change, message, tmp_path):
    metadata, sections = parts
    change(sections)
    with pytest.raises(FormatError, match=message):
        qgraph_file.write(tmp_path / "bad.qgraph", metadata, sections)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("key", ["generator", "levels"])
def test_missing_metadata_is_named(parts, key, tmp_path):
    metadata, sections = parts
    del metadata[key]
    with pytest.raises(FormatError, match=f"metadata: key '{key}' is missing"):
        qgraph_file.write(tmp_path / "bad.qgraph", metadata, sections)


@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_an_interrupted_write_leaves_the_old_file(parts, data, failure, tmp_path, monkeypatch):
    path = tmp_path / "kept.qgraph"
    path.write_bytes(b"old")

    def fail(handle: int) -> None:
        raise failure

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises((InputError, KeyboardInterrupt)):
        qgraph_file.write(path, *parts)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_written_files_follow_the_umask(parts, tmp_path):
    old = os.umask(0o027)
    try:
        qgraph_file.write(tmp_path / "a.qgraph", *parts)
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "a.qgraph").stat().st_mode) == 0o640


def test_unreadable_and_unwritable_paths(parts, tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        qgraph_file.read(tmp_path / "absent.qgraph")
    with pytest.raises(InputError, match="cannot be written"):
        qgraph_file.write(tmp_path / "absent" / "a.qgraph", *parts)
