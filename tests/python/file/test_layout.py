"""The two definitions of the .qgraph layout agree, and so do the two readers."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_file

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

TINY = Path(__file__).parents[2] / "data" / "tiny.qgraph"


def fields(dtype: np.dtype) -> list[tuple[str, int, int]]:
    """Name, offset and size of every field."""
    return [(name, dtype.fields[name][1], dtype.fields[name][0].itemsize) for name in dtype.names]


def test_header_and_section_entry_have_the_same_bytes_in_numpy_and_c():
    layout = _core.qgraph_layout()
    assert fields(qgraph_file.HEADER) == list(layout["header"])
    assert fields(qgraph_file.SECTION) == list(layout["section"])
    assert qgraph_file.HEADER.itemsize == layout["header_size"]
    assert qgraph_file.SECTION.itemsize == layout["section_size"]
    assert layout["magic"] == qgraph_file.MAGIC
    assert layout["version"] == qgraph_file.VERSION


def test_both_readers_see_the_same_arrays():
    ours = qgraph_file.read(TINY)
    theirs = _core.load(TINY)
    assert json.loads(theirs.metadata) == ours.metadata
    for number, level in enumerate(theirs.levels):
        for name in ("vertices", "tets", "faces", "face_tets", "links", "nodes"):
            assert np.array_equal(getattr(level, name), ours.sections[f"level{number}/{name}"])
    assert np.array_equal(theirs.display["barycentric"], ours.sections["display/barycentric"])
    assert theirs.levels[-1].inner is None
    index, weight = theirs.levels[0].barycentric
    assert np.array_equal(index, ours.sections["level0/barycentric_index"])
    assert np.array_equal(weight, ours.sections["level0/barycentric_weight"])


def test_arrays_are_views_without_a_copy_and_cannot_be_written():
    graph = _core.load(TINY)
    vertices = graph.levels[0].vertices
    again = graph.levels[0].vertices
    assert vertices.__array_interface__["data"][0] == again.__array_interface__["data"][0]
    assert vertices.__array_interface__["data"][0] % 64 == 0
    del graph
    assert np.isfinite(vertices).all()
    with pytest.raises(ValueError, match="read-only"):
        vertices[0, 0] = 1


def test_damage_is_refused_with_the_same_class_of_error():
    data = bytearray(TINY.read_bytes())
    data[len(data) // 2] ^= 1
    with pytest.raises(FormatError, match="checksum"):
        _core.parse(bytes(data), "damaged.qgraph")
    with pytest.raises(FormatError, match="truncated"):
        _core.parse(TINY.read_bytes()[:-1], "short.qgraph")
    with pytest.raises(InputError, match=r"nowhere\.qgraph"):
        _core.load("nowhere.qgraph")
