"""Wavefront OBJ and OFF, read by hand: the libraries split OBJ vertices at texture seams or crash on bad indices."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from quadgraph.base.errors import InputError


def fan(polygons: list[list[int]]) -> np.ndarray:
    """(m, 3) int64 triangles: each polygon as a fan about its first corner."""
    triangles = [(p[0], p[i], p[i + 1]) for p in polygons for i in range(1, len(p) - 1)]
    return np.array(triangles, np.int64).reshape(-1, 3)


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    """(line number, words) of the lines that hold something besides a comment."""
    text = path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ")
    numbered = ((number, line.split("#", 1)[0].split()) for number, line in enumerate(text.splitlines(), 1))
    return [(number, words) for number, words in numbered if words]


def read_obj(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) float64 vertices and (m, 3) int64 triangles of an OBJ file; raises InputError naming the line."""
    vertices: list[list[float]] = []
    polygons: list[list[int]] = []
    for number, words in _lines(path):
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
    lines = _lines(path)
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
