"""PLY files, read by hand: sizes are held against the file before memory is taken, and nothing can end the program."""

from __future__ import annotations

import re
import warnings
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from quadgraph.base.errors import InputError
from quadgraph.mesh.ply_header import Element, Header, Property, read_header
from quadgraph.mesh.ply_rows import Rows, find_rows

_NUMBER = np.dtype(np.float64)  # of text, whatever types its header names
_WORD = re.compile(rb"\S+")
_FACE_LISTS = ("vertex_indices", "vertex_index")
_CHUNK = 1 << 20  # corners of polygons that are gathered at a time

Arrays = tuple[np.ndarray, np.ndarray]


def read_ply(path: Path) -> Arrays:
    """(n, 3) float64 vertices and (m, 3) int64 triangles of a PLY file: text, or binary of either byte order.

    Polygons become fans about their first corner, `tristrips` their triangles; triangles with a corner twice, and
    vertices that are not finite and in no triangle, are left out. Other elements and properties are skipped. Raises
    InputError naming element, property, what was found and what is allowed.
    """
    data = path.read_bytes()
    return _read(path, data, read_header(path, data), "xyz")


def read_coloured_ply(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Vertices and triangles as `read_ply`, and (n, 3) colours of the vertices, 0 to 1 as they are stored, or None.

    Those are `red`, `green`, `blue`, or the same behind `diffuse_`: whole numbers count as shares of their type's
    largest. Raises InputError also where some of the three are missing.
    """
    data = path.read_bytes()
    header = read_header(path, data)
    names = {item.name: item.item for each in header.elements if each.name == "vertex" for item in each.properties}
    found = next((prefix for prefix in ("", "diffuse_") if f"{prefix}red" in names), None)
    if found is None:
        return *_read(path, data, header, "xyz"), None
    channels = tuple(f"{found}{name}" for name in ("red", "green", "blue"))
    rows, triangles = _read(path, data, header, (*"xyz", *channels))
    kind = names[channels[0]]
    return rows[:, :3], triangles, rows[:, 3:] / (1 if kind.kind == "f" else np.iinfo(kind).max)


def read_ply_normals(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Vertices and triangles as `read_ply`, and the numbers `nx`, `ny`, `nz` of the vertices, (n, 3), or None.

    Raises InputError also where some of the three are missing.
    """
    data = path.read_bytes()
    header = read_header(path, data)
    names = {item.name for each in header.elements if each.name == "vertex" for item in each.properties}
    wanted = ("nx", "ny", "nz")
    if not names.intersection(wanted):
        return *_read(path, data, header, "xyz"), None
    rows, triangles = _read(path, data, header, (*"xyz", *wanted))
    return rows[:, :3], triangles, rows[:, 3:]


def _read(path: Path, data: bytes, header: Header, of_vertices: Sequence[str]) -> Arrays:
    """(n, k) numbers of the vertices, the first three their places, and triangles."""
    body = _Body.of(path, data, header)
    vertices, parts = np.empty((0, len(of_vertices))), [np.empty((0, 3), np.int64)]
    seen: set[str] = set()
    for element in header.elements:
        if element.name in seen and element.name in ("vertex", "face", "tristrips"):
            raise InputError(f"{path}, element {element.name}: stated twice")
        seen.add(element.name)
        if element.name == "vertex":
            vertices = body.vertices(element, of_vertices)
        elif element.name == "face":
            parts.append(body.polygons(element))
        elif element.name == "tristrips":
            parts.append(body.strips(element))
        else:
            body.rows(element, [])
    triangles = np.concatenate(parts)
    _check_corners(path, triangles, len(vertices))
    a, b, c = triangles.T
    return _without_unused(vertices, triangles[(a != b) & (b != c) & (c != a)])


def _check_corners(path: Path, triangles: np.ndarray, count: int) -> None:
    wrong = np.flatnonzero(((triangles < 0) | (triangles >= count)).any(axis=1))
    if len(wrong):
        found = triangles[wrong[0]].tolist()
        allowed = f"allowed are 0 to {count - 1}" if count else "but there are no vertices"
        raise InputError(f"{path}, triangle {wrong[0]}: vertex indices {found} found, {allowed}")


def _without_unused(vertices: np.ndarray, triangles: np.ndarray) -> Arrays:
    """Leave vertices out that are not finite where no triangle has them."""
    kept = np.isfinite(vertices[:, :3]).all(axis=1)
    kept[triangles] = True
    if kept.all():
        return vertices, triangles
    return vertices[kept], (np.cumsum(kept) - 1)[triangles]


def _numbers(text: bytes) -> tuple[np.ndarray, str]:
    """All numbers up to the first word that is none, and that word."""
    if not text.strip():
        return np.empty(0), ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # what NumPy 1 does of words that are no numbers
            return np.fromstring(text, sep=" "), ""
    except (ValueError, DeprecationWarning):
        values = array("d")
        for word in _WORD.finditer(text):
            try:
                if b"_" in word[0]:
                    raise ValueError
                values.append(float(word[0]))
            except ValueError:
                return np.array(values), word[0][:40].decode("ascii", "replace")
        return np.array(values), ""


@dataclass
class _Body:
    """The values of a file, of which elements are taken one after the other.

    data: (n,) uint8; at: the next byte; text: whether `data` are the numbers of a text, each as a float64.
    """

    path: Path
    data: np.ndarray
    order: str
    text: bool
    stop: str
    at: int = 0

    @classmethod
    def of(cls, path: Path, data: bytes, header: Header) -> _Body:
        if header.order == "=":
            values, stop = _numbers(data[header.end :])
            return cls(path, values.view(np.uint8), "=", True, stop)
        return cls(path, np.frombuffer(data, np.uint8, offset=header.end), header.order, False, "")

    def rows(self, element: Element, wanted: list[int]) -> Rows:
        """Where the properties `wanted` of an element's rows lie; the element is behind us then."""
        stored = replace(element, properties=[self._stored(item) for item in element.properties])
        unit = "numbers" if self.text else "bytes"
        try:
            rows = find_rows(stored, self.data, self.at, wanted, _NUMBER.itemsize if self.text else 1, unit)
        except InputError as error:
            hint = f"; {self.stop!r} is no number" if self.stop else ""
            raise InputError(f"{self.path}, {error}{hint}") from None
        self.at = rows.end
        return rows

    def vertices(self, element: Element, names: Sequence[str]) -> np.ndarray:
        """(n, k) numbers of these names."""
        where = [self._find(element, (name,), of_list=False) for name in names]
        rows = self.rows(element, where)
        vertices = np.empty((element.count, len(names)))
        for axis, index in enumerate(where):
            item = element.properties[index].item
            with np.errstate(over="ignore", invalid="ignore"):
                values = self._take(rows.places[:, axis], self._stored(element.properties[index]).item, 1)[:, 0]
                vertices[:, axis] = values.astype(item) if item.kind == "f" else values
        return vertices

    def polygons(self, element: Element) -> np.ndarray:
        """(m, 3) triangles of all polygons, each a fan about its first corner."""
        index, rows = self._lists(element)
        few = np.flatnonzero(rows.counts < 3)
        if len(few):
            raise InputError(
                f"{self.path}, element {element.name}, row {few[0]}: a list of {rows.counts[few[0]]} found, "
                "a polygon has 3 corners or more"
            )
        parts = [np.empty((0, 3), np.int64)]
        for first, last in rows.chunks(_CHUNK):
            counts, corners = rows.counts[first:last], self._corners(element, index, rows, first, last)
            begin = np.cumsum(counts) - counts
            at = np.repeat(begin - (np.cumsum(counts - 2) - (counts - 2)), counts - 2) + np.arange((counts - 2).sum())
            parts.append(np.column_stack([np.repeat(corners[begin], counts - 2), corners[at + 1], corners[at + 2]]))
        return np.concatenate(parts)

    def strips(self, element: Element) -> np.ndarray:
        """(m, 3) triangles of strips: three corners in a row are one, turned at every second; -1 begins a new strip."""
        index, rows = self._lists(element)
        parts = [np.empty((0, 3), np.int64)]
        for first, last in rows.chunks(_CHUNK):
            corners = self._corners(element, index, rows, first, last)
            ends = np.cumsum(rows.counts[first:last])
            corners = np.insert(corners, ends, -1)  # a row ends its last strip
            begin = np.maximum.accumulate(np.where(corners == -1, np.arange(1, len(corners) + 1), 0))
            triples = sliding_window_view(corners, 3) if len(corners) > 2 else np.empty((0, 3), np.int64)
            whole = np.flatnonzero((triples != -1).all(axis=1))
            turned = (whole - begin[whole]) % 2 == 1
            found = triples[whole]
            found[turned] = found[turned][:, [1, 0, 2]]
            parts.append(found)
        return np.concatenate(parts)

    def _lists(self, element: Element) -> tuple[int, Rows]:
        index = self._find(element, _FACE_LISTS, of_list=True)
        rows = self.rows(element, [index])
        if element.properties[index].item.kind == "f":
            raise InputError(
                f"{self.path}, element {element.name}, property {element.properties[index].name}: a list of "
                f"{element.properties[index].item.name} found, allowed are whole numbers"
            )
        return index, rows

    def _corners(self, element: Element, index: int, rows: Rows, first: int, last: int) -> np.ndarray:
        """(k,) int64 indices of the lists of rows first to last, one after the other."""
        item, counts, places = self._stored(element.properties[index]).item, rows.counts[first:last], rows.places
        places = places[first:last, 0]
        if (counts == counts[0]).all():
            values = self._take(places, item, int(counts[0])).reshape(-1)
        else:
            begin = np.cumsum(counts) - counts
            steps = np.arange(counts.sum()) - np.repeat(begin, counts)
            values = self._take(np.repeat(places, counts) + steps * item.itemsize, item, 1)[:, 0]
        if item.kind == "f":
            bad = np.flatnonzero(~((values == np.floor(values)) & (np.abs(values) < 2.0**53)))
            if len(bad):
                raise InputError(
                    f"{self.path}, element {element.name}, property {element.properties[index].name}: "
                    f"{values[bad[0]]:g} found, allowed are whole numbers"
                )
        return values.astype(np.int64)

    def _take(self, places: np.ndarray, item: np.dtype, count: int) -> np.ndarray:
        """(n, count) values that begin at `places`, in bytes."""
        if not len(places) or not count:
            return np.empty((len(places), count), item)
        return sliding_window_view(self.data, count * item.itemsize)[places].view(item)

    def _find(self, element: Element, names: tuple[str, ...], of_list: bool) -> int:
        for index, item in enumerate(element.properties):
            if item.name in names and (item.count is not None) == of_list:
                return index
        found = ", ".join(item.name for item in element.properties)[:200] or "none"
        kind = "list" if of_list else "number"
        raise InputError(
            f"{self.path}, element {element.name}: properties {found} found, a {kind} '{names[0]}' is wanted"
        )

    def _stored(self, item: Property) -> Property:
        """The property with the types as which its values are stored."""
        if self.text:
            return Property(item.name, _NUMBER, _NUMBER if item.count is not None else None)
        count = item.count.newbyteorder(self.order) if item.count is not None else None  # type: ignore[arg-type]
        return Property(item.name, item.item.newbyteorder(self.order), count)  # type: ignore[arg-type]
