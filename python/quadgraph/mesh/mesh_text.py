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
    polygons = np.array(corners, np.int64).T
    if polygons.min() < 1:
        raise ValueError  # counted from the last vertex before it, or no index
    k = np.arange(1, polygons.shape[1] - 1)
    fans = np.stack([np.zeros_like(k), k, k + 1], axis=1)
    return np.ascontiguousarray(vertices), polygons[:, fans].reshape(-1, 3) - 1


def _words_by_column(lines: list[str], kind: str) -> list[list[str]]:
    """Words of the lines of a kind, by column without the first; ValueError unless all have as many, at least 3."""
    found = [line for line in lines if line[:2] == f"{kind} "]
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
