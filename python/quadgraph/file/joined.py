"""The sections of several bodies as those of one file (docs/qgraph-format.md, "Several bodies")."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.file.sections import exchange
from quadgraph.tets.exchange import Seen
from quadgraph.tets.graph import Graph

MOST_BODIES = 256  # a tet's body is a byte
Sections = Mapping[str, np.ndarray]
_WIDTHS = {"inner": 8, "surface": 4, "barycentric": 4}


def level_count(sections: Sections) -> int:
    """Levels of detail of a file's sections."""
    return sum(name.startswith("level") and name.endswith("/vertices") for name in sections)


def join(bodies: Sequence[Sections], numbers: Sequence[Sequence[int]] | None = None) -> dict[str, np.ndarray]:
    """All sections of a file of these bodies, in file order, but for the metadata and what faces see.

    bodies: the sections of files of one body each, with levels; where one has fewer than another its coarsest is
    repeated. numbers: of each, what it and those within it, which its `tet_bodies` count, are in the file; None: one
    after the other, nothing within any. Raises InputError for more bodies than a file can hold, for a body without
    levels, and for a polygrid.
    """
    numbers = [[number] for number in range(len(bodies))] if numbers is None else numbers
    if (count := sum(map(len, numbers))) > MOST_BODIES:
        raise InputError(f"bodies: {count} found, at most {MOST_BODIES} allowed in one file")
    for body, own in zip(bodies, numbers, strict=True):
        nested = len(own) > 1
        if not level_count(body) or "level0/grid_links" in body or ("level0/tet_bodies" in body) != nested:
            raise InputError("bodies: one without levels, of a polygrid or of several bodies, which cannot be joined")
    levels = max(map(level_count, bodies))
    padded = [_padded(body, levels) for body in bodies]
    joined: dict[str, np.ndarray] = {}
    for number in range(levels):
        joined |= _level(number, padded, numbers)
        if number + 1 < levels:
            joined |= _transfers(number, padded)
    return joined | _display(padded)


def graphs(sections: Sections) -> list[Graph]:
    """The levels of a file's sections, finest first, double precision."""
    found = []
    for number in range(level_count(sections)):
        of = {
            name: sections[f"level{number}/{name}"]
            for name in ("vertices", "tets", "faces", "face_tets", "links", "nodes")
        }
        nodes, count = of["nodes"].astype(np.float64), len(of["tets"])
        tets, faces, face_tets, links = (of[name].astype(np.int64) for name in ("tets", "faces", "face_tets", "links"))
        vertices = of["vertices"].astype(np.float64)
        found.append(Graph(vertices, tets, faces, face_tets, links, nodes[:count], nodes[count:]))
    return found


def with_seen(sections: Sections, seen: Seen | None) -> dict[str, np.ndarray]:
    """The sections with what faces see in its place."""
    complete: dict[str, np.ndarray] = {}
    for name, array in sections.items():
        complete[name] = array
        if seen is not None and name == f"level{seen.level}/tet_bodies":
            complete |= exchange(seen)
    return complete


def _padded(body: Sections, levels: int) -> Sections:
    """A body with its coarsest level repeated, which takes all values as they are."""
    more, last = dict(body), level_count(body) - 1
    for number in range(last, levels - 1):
        names = [name.partition("/")[2] for name in body if name.startswith(f"level{last}/")]
        more |= {f"level{number + 1}/{name}": body[f"level{last}/{name}"] for name in names}
        rows = dict(zip(_WIDTHS, _counts(body, last), strict=True))
        for kind, width in _WIDTHS.items():
            more[f"level{number}/{kind}_index"] = np.repeat(np.arange(rows[kind], dtype="<u4")[:, None], width, axis=1)
            more[f"level{number}/{kind}_weight"] = np.tile(np.eye(1, width, dtype="<f4"), (rows[kind], 1))
    return more


def _counts(body: Sections, number: int) -> tuple[int, int, int]:
    """Tets, faces and vertices of a level."""
    tets, faces, vertices = (len(body[f"level{number}/{name}"]) for name in ("tets", "faces", "vertices"))
    return tets, faces, vertices


def _begins(counts: Sequence[int]) -> list[int]:
    return [0, *np.cumsum(counts)[:-1].tolist()]


def _vertex_numbers(number: int, bodies: Sequence[Sections]) -> list[np.ndarray]:
    """Of each body's vertices, what they are in the joined level: surfaces come first."""
    counts = [_counts(body, number)[2] for body in bodies]
    on_surface = [int(body[f"level{number}/faces"].max()) + 1 for body in bodies]
    below = [count - surface for count, surface in zip(counts, on_surface, strict=True)]
    all_on_surface = sum(on_surface)
    return [
        np.concatenate([begin + np.arange(surface), all_on_surface + under + np.arange(inner)])
        for begin, surface, under, inner in zip(_begins(on_surface), on_surface, _begins(below), below, strict=True)
    ]


def _by_vertex(number: int, bodies: Sequence[Sections], rows: Sequence[np.ndarray]) -> np.ndarray:
    """Rows of each body's vertices in the order of the joined level."""
    order = np.argsort(np.concatenate(_vertex_numbers(number, bodies)))
    return np.concatenate(rows)[order]


def _level(number: int, bodies: Sequence[Sections], body_numbers: Sequence[Sequence[int]]) -> dict[str, np.ndarray]:
    def of(name: str) -> list[np.ndarray]:
        return [body[f"level{number}/{name}"] for body in bodies]

    numbers = _vertex_numbers(number, bodies)
    tets, faces = ([len(rows) for rows in of(name)] for name in ("tets", "faces"))
    first_tet, first_face = _begins(tets), _begins(faces)
    links = [
        np.where(own < count, own + tet, own.astype(np.int64) - count + sum(tets) + face)
        for own, count, tet, face in zip(of("links"), tets, first_tet, first_face, strict=True)
    ]
    regions = [body.get(f"level{number}/tet_bodies", np.zeros(n, "u1")) for body, n in zip(bodies, tets, strict=True)]
    nodes = [(own[:count], own[count:]) for own, count in zip(of("nodes"), tets, strict=True)]
    kinds: dict[str, np.ndarray] = {}
    if any(f"level{number}/face_kinds" in body for body in bodies):
        kinds["face_kinds"] = np.concatenate(
            [
                body.get(f"level{number}/face_kinds", np.zeros(count, "<u4"))
                for body, count in zip(bodies, faces, strict=True)
            ]
        )
    made = {
        "vertices": _by_vertex(number, bodies, of("vertices")),
        "tets": _numbered(zip(of("tets"), numbers, strict=True)),
        "faces": _numbered(zip(of("faces"), numbers, strict=True)),
        "face_tets": _moved(of("face_tets"), first_tet),
        "links": np.concatenate(links).astype("<u4"),
        "nodes": np.concatenate([inner for inner, _ in nodes] + [surface for _, surface in nodes]),
        **kinds,
        "tet_bodies": np.concatenate(
            [np.array(of_body, "u1")[region] for of_body, region in zip(body_numbers, regions, strict=True)]
        ),
    }
    return {f"level{number}/{name}": array for name, array in made.items()}


def _numbered(pairs) -> np.ndarray:
    return np.concatenate([numbers[own] for own, numbers in pairs]).astype("<u4")


def _moved(arrays: Sequence[np.ndarray], begins: Sequence[int]) -> np.ndarray:
    return np.concatenate([own + begin for own, begin in zip(arrays, begins, strict=True)]).astype("<u4")


def _transfers(number: int, bodies: Sequence[Sections]) -> dict[str, np.ndarray]:
    """Transfers stay within each body."""

    def of(name: str) -> list[np.ndarray]:
        return [body[f"level{number}/{name}"] for body in bodies]

    tets, faces, _ = zip(*(_counts(body, number + 1) for body in bodies), strict=True)
    coarse = _vertex_numbers(number + 1, bodies)
    vertex_index = [numbers[own] for own, numbers in zip(of("barycentric_index"), coarse, strict=True)]
    made = {
        "inner_index": _moved(of("inner_index"), _begins(tets)),
        "inner_weight": np.concatenate(of("inner_weight")),
        "surface_index": _moved(of("surface_index"), _begins(faces)),
        "surface_weight": np.concatenate(of("surface_weight")),
        "barycentric_index": _by_vertex(number, bodies, vertex_index).astype("<u4"),
        "barycentric_weight": _by_vertex(number, bodies, of("barycentric_weight")),
    }
    return {f"level{number}/{name}": array for name, array in made.items()}


def _display(bodies: Sequence[Sections]) -> dict[str, np.ndarray]:
    def of(name: str) -> list[np.ndarray]:
        return [body[f"display/{name}"] for body in bodies]

    made = {name: np.concatenate(of(name)) for name in ("vertices", "normals")}
    made["triangles"] = _moved(of("triangles"), _begins([len(rows) for rows in of("vertices")]))
    made["face"] = _moved(of("face"), _begins([_counts(body, 0)[1] for body in bodies]))
    made["barycentric"] = np.concatenate(of("barycentric"))
    return {f"display/{name}": array for name, array in made.items()}
