"""Wavefront OBJ and OFF, read by hand: the libraries split OBJ vertices at texture seams or crash on bad indices."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from quadgraph.base.errors import InputError

_PLAIN = frozenset(("v ", "f ", "vn", "vt", ""))  # how lines begin whose first word is known by that


def fan(polygons: list[list[int]]) -> np.ndarray:
    """(m, 3) int64 triangles: each polygon as a fan about its first corner."""
    triangles = [(p[0], p[i], p[i + 1]) for p in polygons for i in range(1, len(p) - 1)]
    return np.array(triangles, np.int64).reshape(-1, 3)


def _without_comments(path: Path) -> list[str]:
    text = path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ")
    return [line.partition("#")[0] for line in text.splitlines()]


def _numbered(lines: list[str]) -> list[tuple[int, list[str]]]:
    """(line number, words) of the lines that hold something."""
    return [(number, words) for number, words in enumerate(map(str.split, lines), 1) if words]


def numbered_lines(path: Path) -> list[tuple[int, list[str]]]:
    """(line number, words) of the lines of a file that hold more than a comment. Raises OSError."""
    return _numbered(_without_comments(path))


def read_obj(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) float64 vertices and (m, 3) int64 triangles of an OBJ file; raises InputError naming the line."""
    lines = _without_comments(path)
    try:
        return _plain_obj(lines)
    except (ValueError, OverflowError):
        return _obj_by_line(path, _numbered(lines))


def _plain_obj(lines: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """An OBJ file as programs write them, all at once; ValueError for others, which need not be wrong."""
    if any(line[:2] not in _PLAIN and line.split(None, 1)[:1] in (["v"], ["f"]) for line in lines):
        raise ValueError
    columns = _words_by_column(lines, "v")[:3]
    corners = [[int(word.partition("/")[0]) for word in column] for column in _words_by_column(lines, "f")]
    vertices = np.array([list(map(float, column)) for column in columns], np.float64).T
    return np.ascontiguousarray(vertices), _plain_fans(corners)


def _plain_fans(columns: list[list[int]]) -> np.ndarray:
    """(m, 3) indices from 0 of the triangles of polygons by the columns of their corners; ValueError below 1."""
    polygons = np.array(columns, np.int64).T
    if polygons.min() < 1:
        raise ValueError  # counted from the last vertex before it, or no index
    k = np.arange(1, polygons.shape[1] - 1)
    fans = np.stack([np.zeros_like(k), k, k + 1], axis=1)
    return polygons[:, fans].reshape(-1, 3) - 1


def _words_by_column(lines: list[str], kind: str) -> list[list[str]]:
    """Words of the lines of a kind, by column without the first; ValueError unless all have as many, at least 3."""
    found = [line for line in lines if line.startswith(f"{kind} ")]
    words = " ".join(found).split()
    each = len(words) // max(len(found), 1)
    # As many times as there are lines, each time at the begin of a row: so rows are lines.
    if each < 4 or len(words) != each * len(found) or not words.count(kind) == words[::each].count(kind) == len(found):
        raise ValueError
    return [words[k::each] for k in range(1, each)]


def _obj_by_line(path: Path, lines: list[tuple[int, list[str]]]) -> tuple[np.ndarray, np.ndarray]:
    vertices: list[list[float]] = []
    polygons: list[list[int]] = []
    for number, words in lines:
        try:
            if words[0] == "v":
                vertices.append([float(words[1]), float(words[2]), float(words[3])])
            elif words[0] == "f":
                indices = [int(word.split("/", 1)[0]) for word in words[1:]]
                polygons.append([i - 1 if i > 0 else len(vertices) + i for i in indices])
                if min(indices) <= -len(vertices) - 1 or 0 in indices or len(indices) < 3:
                    raise ValueError
        except (ValueError, IndexError):
            raise InputError(f"{path}, line {number}: cannot read '{' '.join(words)[:80]}'") from None
    return np.array(vertices, np.float64).reshape(-1, 3), fan(polygons)


def read_obj_normals(path: Path, next_step: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Corners (m, 3, 3) of the triangles of a readable OBJ file and its `vn` there, 0 where a corner has none.

    None of a file without any. next_step: what errors end with. Raises InputError naming the line.
    """
    lines = _without_comments(path)
    if not any(line.split(None, 1)[:1] == ["vn"] for line in lines if "vn" in line):
        return None
    try:
        places, normals, corners = _plain_normals(lines)
    except (ValueError, OverflowError):
        places, normals, corners = _normals_by_line(path, _numbered(lines), next_step)
    last = corners[:, :, 1].max(initial=0)
    if last >= len(normals):
        raise InputError(f"{path}: a face has normal {last}, but there are {len(normals) - 1} (vn){next_step}")
    return places[corners[:, :, 0]], normals[corners[:, :, 1]]


def _plain_normals(lines: list[str]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `_normals_by_line`, of a file as programs write them, all at once; ValueError for others."""
    if any(line[:3] != "vn " and line.split(None, 1)[:1] == ["vn"] for line in lines if "vn" in line):
        raise ValueError
    places, triangles = _plain_obj(lines)
    normals = np.array([list(map(float, column)) for column in _words_by_column(lines, "vn")[:3]], np.float64).T
    faces = _words_by_column(lines, "f")
    if not all(word.count("/") == 2 for column in faces for word in column):
        raise ValueError
    of = _plain_fans([[int(word.rpartition("/")[2]) for word in column] for column in faces])
    if triangles.max() >= len(places):
        raise ValueError
    before = np.zeros((1, 3))
    return np.concatenate([before, places]), np.concatenate([before, normals]), np.stack([triangles, of], axis=2) + 1


def _normals_by_line(
    path: Path, lines: list[tuple[int, list[str]]], next_step: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places and normals with a row of 0 before them, and triangles (m, 3, 2) of indices into both."""
    places, normals = [[0.0] * 3], [[0.0] * 3]
    polygons: list[list[tuple[int, int]]] = []
    for number, words in lines:
        try:
            if words[0] in ("v", "vn"):
                rows = places if words[0] == "v" else normals
                rows.append([float(words[1]), float(words[2]), float(words[3])])
            elif words[0] == "f":
                fields = [word.split("/") for word in words[1:]]
                polygons.append(
                    [(_from_1(f[0], places), _from_1(f[2], normals) if len(f) > 2 and f[2] else 0) for f in fields]
                )
        except (ValueError, IndexError):
            found = " ".join(words)[:80]
            raise InputError(f"{path}, line {number}: cannot read the normals of '{found}'{next_step}") from None
    corners = np.array([(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)], np.int64)
    return np.array(places), np.array(normals), corners.reshape(-1, 3, 2)


def _from_1(word: str, rows: list[list[float]]) -> int:
    """An index as OBJ counts, where `rows` has one row before its first; ValueError for 0 and before that."""
    index = int(word) if int(word) > 0 else len(rows) + int(word)
    if int(word) == 0 or index < 1:
        raise ValueError
    return index


def read_off(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) float64 vertices and (m, 3) int64 triangles of an ASCII OFF file; raises InputError naming the line."""
    lines = numbered_lines(path)
    if not lines or not lines[0][1][0].endswith("OFF") or "BINARY" in lines[0][1]:
        raise InputError(f"{path}: an ASCII OFF file starts with the word OFF")
    header = lines[0][1][1:]
    rows = lines[1:]
    if not header:
        header, rows = (rows[0][1], rows[1:]) if rows else ([], [])
    try:
        n, m = int(header[0]), int(header[1])
    except (ValueError, IndexError):
        raise InputError(f"{path}, field counts: '{' '.join(header)[:80]}' found, two numbers expected") from None
    if n < 0 or m < 0 or len(rows) < n + m:
        raise InputError(f"{path}, field counts: {n} vertices and {m} faces announced, {len(rows)} lines found")
    vertices, polygons = [], []
    for k, (number, words) in enumerate(rows[: n + m]):
        try:
            if k < n:
                vertices.append([float(words[0]), float(words[1]), float(words[2])])
            else:
                polygons.append([int(words[1 + i]) for i in range(int(words[0]))])
        except (ValueError, IndexError):
            raise InputError(f"{path}, line {number}: cannot read '{' '.join(words)[:80]}'") from None
    return np.array(vertices, np.float64).reshape(-1, 3), fan(polygons)
