"""Sections of a `.qgraph` file: their names, types and shapes, and the rules between them (docs/qgraph-format.md)."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from quadgraph.base.errors import FormatError
from quadgraph.file import place_rules, seen_rules
from quadgraph.tets import exchange
from quadgraph.tets.tet_geometry import FACE_CORNERS, determinants

MAX_LEVELS = 16
MAX_NODES = 2**31
SUM_TOLERANCE = 1e-5
METADATA_KEYS = ("generator", "source", "unit_mm", "mesher", "repairs", "levels", "tools")


_U8, _U32, _F32 = np.dtype("u1"), np.dtype("<u4"), np.dtype("<f4")
_LEVEL = {
    "vertices": (_F32, ("n_v", 3)),
    "tets": (_U32, ("n_t", 4)),
    "faces": (_U32, ("n_f", 3)),
    "face_tets": (_U32, ("n_f",)),
    "links": (_U32, ("n_t", 4)),
    "nodes": (_F32, ("n_n", 3)),
}
_KINDS = {"face_kinds": (_U32, ("n_f",))}
_GRID = {"grid_links": (_U32, ("n_i", 6))}
_SEEN = {"seen_rays": (_U32, (1,)), "seen": (_U32, ("n_s",))}
_OPTIONAL = (_KINDS, _GRID, _SEEN)
_TRANSFERS = {
    "inner_index": (_U32, ("n_t", 8)),
    "inner_weight": (_F32, ("n_t", 8)),
    "surface_index": (_U32, ("n_f", 4)),
    "surface_weight": (_F32, ("n_f", 4)),
    "barycentric_index": (_U32, ("n_v", 4)),
    "barycentric_weight": (_F32, ("n_v", 4)),
}
_DISPLAY = {
    "vertices": (_F32, ("n_d", 3)),
    "normals": (_F32, ("n_d", 3)),
    "triangles": (_U32, ("n_p", 3)),
    "face": (_U32, ("n_d",)),
    "barycentric": (_F32, ("n_d", 3)),
}
_DISPLAY_ALONE = {field: _DISPLAY[field] for field in ("vertices", "normals", "triangles")}


def level_count(sections: dict[str, np.ndarray]) -> int:
    """Number of levels, going by the section names."""
    return sum(name.startswith("level") and name.endswith("/vertices") for name in sections)


def section_names(levels: int, present: Collection[str] = ()) -> list[str]:
    """Names of all sections of a file with that many levels, in file order; optional ones where `present` has them."""
    names = ["metadata"]
    for i in range(levels):
        optional = [group for group in _OPTIONAL if any(f"level{i}/{field}" in present for field in group)]
        fields = [*_LEVEL, *(field for group in optional for field in group), *(_TRANSFERS if i + 1 < levels else ())]
        names += [f"level{i}/{field}" for field in fields]
    return names + [f"display/{field}" for field in (_DISPLAY if levels else _DISPLAY_ALONE)]


def check(sections: dict[str, np.ndarray], metadata: dict[str, Any], name: str) -> None:
    """Check all sections, 'metadata' first, against every rule of the document.

    Raises FormatError that names the file (`name`), the section and the rule.
    """
    levels = level_count(sections)
    _require(levels <= MAX_LEVELS, name, f"{levels} levels found, 0 to {MAX_LEVELS} allowed")
    _check_names(list(sections), section_names(levels, sections), name)
    for i in range(levels):
        counts = _level_counts(sections, i)
        _check_fields(sections, f"level{i}/", _LEVEL, counts, name)
        _check_level({field: sections[f"level{i}/{field}"] for field in _LEVEL}, counts, f"{name}: level{i}")
        if f"level{i}/face_kinds" in sections:
            _check_fields(sections, f"level{i}/", _KINDS, counts, name)
            _check_range(sections[f"level{i}/face_kinds"], 2, f"{name}: level{i}/face_kinds")
    _check_grid(sections, levels, name)
    _check_seen(sections, levels, name)
    for i in range(levels - 1):
        _check_fields(sections, f"level{i}/", _TRANSFERS, _level_counts(sections, i), name)
        coarse = _level_counts(sections, i + 1)
        for transfer, key in (("inner", "n_t"), ("surface", "n_f"), ("barycentric", "n_v")):
            prefix = f"level{i}/{transfer}"
            _check_range(sections[f"{prefix}_index"], coarse[key], f"{name}: {prefix}_index")
            _check_weights(sections[f"{prefix}_weight"], f"{name}: {prefix}_weight")
    for i in range(levels):
        place_rules.check_level({field: sections[f"level{i}/{field}"] for field in _LEVEL}, f"{name}: level{i}")
        if f"level{i}/seen" in sections:
            vertices, faces, seen = (sections[f"level{i}/{field}"] for field in ("vertices", "faces", "seen"))
            seen_rules.check_some(
                vertices, faces, seen, int(sections[f"level{i}/seen_rays"][0]), f"{name}: level{i}/seen"
            )
    _check_display(sections, _level_counts(sections, 0)["n_f"] if levels else None, name)
    _check_metadata(metadata, levels, name)


def _require(condition: bool, where: str, what: str) -> None:
    if not condition:
        raise FormatError(f"{where}: {what}")


def _check_names(found: list[str], expected: list[str], name: str) -> None:
    missing = [section for section in expected if section not in set(found)]
    _require(not missing, name, f"section {missing[0] if missing else ''} is missing")
    unknown = [section for section in found if section not in set(expected)]
    _require(not unknown, name, f"section {unknown[0] if unknown else ''} is not known")
    _require(found == expected, name, "sections are not in the order of the document")


def _level_counts(sections: dict[str, np.ndarray], level: int) -> dict[str, int]:
    n_v, n_t, n_f = (len(sections[f"level{level}/{field}"]) for field in ("vertices", "tets", "faces"))
    n_i = n_v - int(sections[f"level{level}/faces"].max()) - 1
    return {"n_v": n_v, "n_t": n_t, "n_f": n_f, "n_n": n_t + n_f, "n_i": n_i}


def _check_fields(
    sections: dict[str, np.ndarray], prefix: str, fields: dict, counts: dict[str, int], name: str
) -> None:
    for field, (dtype, dimensions) in fields.items():
        array, where = sections[prefix + field], f"{name}: {prefix}{field}"
        _require(array.dtype == dtype, where, f"type {array.dtype} found, {dtype} allowed")
        shape = tuple(counts.get(n, n) for n in dimensions)
        _require(array.shape == shape, where, f"shape {array.shape} found, {shape} allowed")
        if dtype == _F32:
            _require(bool(np.isfinite(array).all()), where, "a value is not finite")


def _check_range(index: np.ndarray, limit: int, where: str) -> None:
    largest = int(index.max())
    _require(largest < limit, where, f"index {largest} found, 0 to {limit - 1} allowed")


def _check_weights(weights: np.ndarray, where: str) -> None:
    _require(bool((weights >= 0).all()), where, "a weight is negative")
    sums = weights.sum(axis=1, dtype=np.float64)
    worst = float(sums[np.abs(sums - 1).argmax()])
    _require(abs(worst - 1) <= SUM_TOLERANCE, where, f"weights of a row sum to {worst:.8g}, 1 allowed")


def _check_level(level: dict[str, np.ndarray], counts: dict[str, int], where: str) -> None:
    n_v, n_t, n_f, n_n = (counts[k] for k in ("n_v", "n_t", "n_f", "n_n"))
    _require(n_n < MAX_NODES, where, f"{n_n} nodes found, fewer than {MAX_NODES} allowed")
    _check_range(level["tets"], n_v, f"{where}/tets")
    _check_range(level["faces"], n_v, f"{where}/faces")
    _check_range(level["face_tets"], n_t, f"{where}/face_tets")
    _check_range(level["links"], n_n, f"{where}/links")
    wrong = np.flatnonzero(~(determinants(level["vertices"], level["tets"]) > 0))
    _require(not len(wrong), f"{where}/tets", f"tet {wrong[0] if len(wrong) else ''} is not positively oriented")
    orphans = np.setdiff1d(np.arange(n_v), level["tets"])
    _require(not len(orphans), f"{where}/vertices", f"vertex {orphans[0] if len(orphans) else ''} is used by no tet")
    used = np.unique(level["faces"])
    _require(len(used) == used[-1] + 1, f"{where}/vertices", "the vertices on the surface do not come first")
    _check_inner_links(level["links"], level["tets"], n_t, f"{where}/links")
    _check_surface_links(level, n_t, n_f, where)


def _check_inner_links(links: np.ndarray, tets: np.ndarray, n_t: int, where: str) -> None:
    # Each directed link as one number; symmetric if the set equals that of the reversed links.
    source, target = np.divmod(np.flatnonzero(links < n_t), 4)[0].astype(np.int64), links[links < n_t].astype(np.int64)
    forward, backward = np.sort(source * n_t + target), np.sort(target * n_t + source)
    _require(bool((forward == backward).all()), where, "inner links are not symmetric")
    _require(bool((source != target).all()), where, "a node is linked to itself")
    tet, corner = np.nonzero(links < n_t)
    across, others = tets[tet[:, None], FACE_CORNERS[corner]].T, tets[links[tet, corner]].T
    shared = np.all([np.any([vertex == other for other in others], axis=0) for vertex in across], axis=0)
    _require(bool(shared.all()), where, "a link leads to a tet that does not have the face across which it is")


def _check_surface_links(level: dict[str, np.ndarray], n_t: int, n_f: int, where: str) -> None:
    links, faces, face_tets = level["links"], level["faces"], level["face_tets"]
    tet, corner = np.nonzero(links >= n_t)
    _require(len(tet) == len(np.unique(tet)), f"{where}/links", "a tet has more than one outside face")
    surface = links[tet, corner].astype(np.int64) - n_t
    once = len(surface) == n_f and bool((np.bincount(surface, minlength=n_f) == 1).all())
    _require(once, f"{where}/links", "a surface node is not linked exactly once")
    _require(bool((face_tets[surface] == tet).all()), f"{where}/face_tets", "a surface node's link is another tet")
    outward = level["tets"][tet[:, None], FACE_CORNERS[corner]]
    stored = faces[surface]
    same = np.zeros(n_f, bool)
    for shift in range(3):
        same |= (np.roll(stored, shift, axis=1) == outward).all(axis=1)
    _require(bool(same.all()), f"{where}/faces", "a face is not the outward face of its tet")


def _check_grid(sections: dict[str, np.ndarray], levels: int, name: str) -> None:
    found = [i for i in range(levels) if f"level{i}/grid_links" in sections]
    _require(len(found) in (0, levels), f"{name}: grid_links", "some levels have it, but not all")
    for i in found:
        counts = _level_counts(sections, i)
        _check_fields(sections, f"level{i}/", _GRID, counts, name)
        _check_grid_links(sections[f"level{i}/grid_links"], counts, f"{name}: level{i}/grid_links")


def _check_grid_links(links: np.ndarray, counts: dict[str, int], where: str) -> None:
    first = counts["n_v"] - counts["n_i"]
    _check_range(links, counts["n_v"], where)
    own = links == first + np.arange(len(links))[:, None]
    _require(not own[:, :5].any(), where, "a vertex is linked to itself")
    outside = links[links < first]
    once = len(outside) == first and bool((np.bincount(outside, minlength=first) == 1).all())
    _require(once, where, "a vertex on the surface is not linked exactly once")
    # Breadth first from the surface: the vertices of a layer follow those of the one before.
    layer = np.full(counts["n_v"], counts["n_v"])
    layer[:first] = 0
    while True:
        reached = np.minimum(layer[first:], layer[links].min(axis=1) + 1)
        if (reached == layer[first:]).all():
            break
        layer[first:] = reached
    _require(bool((layer[first:] <= len(links)).all()), where, "a vertex is not linked to the surface")
    _require(bool((np.diff(layer) >= 0).all()), where, "vertices are not in the order of their layers")


def _check_seen(sections: dict[str, np.ndarray], levels: int, name: str) -> None:
    found = [i for i in range(levels) if f"level{i}/seen" in sections]
    _require(len(found) <= 1, f"{name}: level{found[-1] if found else ''}/seen", "only one level may have it")
    for i in found:
        counts = _level_counts(sections, i) | {"n_s": sections[f"level{i}/seen"].size}
        _check_fields(sections, f"level{i}/", _SEEN, counts, name)
        rays = int(sections[f"level{i}/seen_rays"][0])
        _require(
            1 <= rays <= exchange.MOST_RAYS,
            f"{name}: level{i}/seen_rays",
            f"{rays} found, 1 to {exchange.MOST_RAYS} allowed",
        )
        _check_seen_rows(sections[f"level{i}/seen"].astype(np.int64), rays, counts["n_f"], f"{name}: level{i}/seen")


def _check_seen_rows(seen: np.ndarray, rays: int, n_f: int, where: str) -> None:
    _require(len(seen) >= n_f + 1, where, f"{len(seen)} values found, at least {n_f + 1} needed")
    begins, faces = seen[: n_f + 1], seen[n_f + 1 :]
    _require(int(begins[0]) == n_f + 1, where, f"the first row begins at {begins[0]}, {n_f + 1} allowed")
    _require(int(begins[-1]) == len(seen), where, f"the last row ends at {begins[-1]}, the section at {len(seen)}")
    lengths = np.diff(begins)
    _require(bool((lengths >= 0).all()), where, "a row ends before it begins")
    _require(int(lengths.max()) <= rays, where, f"a row has {lengths.max()} entries, at most {rays} allowed")
    if not len(faces):
        return
    _check_range(faces, n_f, where)
    rows = np.repeat(np.arange(n_f), lengths)
    _require(bool((faces != rows).all()), where, "a face does not see itself")
    # Rows follow each other, so that one ascending key means ascending faces in each.
    _require(bool((np.diff(rows * n_f + faces) >= 0).all()), where, "faces of a row are not in ascending order")


def _check_display(sections: dict[str, np.ndarray], n_f: int | None, name: str) -> None:
    counts = {"n_d": len(sections["display/vertices"]), "n_p": len(sections["display/triangles"])}
    _check_fields(sections, "display/", _DISPLAY_ALONE if n_f is None else _DISPLAY, counts, name)
    _check_range(sections["display/triangles"], counts["n_d"], f"{name}: display/triangles")
    place_rules.check_size(sections["display/vertices"], f"{name}: display/vertices")
    lengths = np.linalg.norm(sections["display/normals"].astype(np.float64), axis=1)
    _require(bool((np.abs(lengths - 1) <= 1e-3).all()), f"{name}: display/normals", "a normal is not of unit length")
    if n_f is None:
        return
    _check_range(sections["display/face"], n_f, f"{name}: display/face")
    _check_weights(sections["display/barycentric"], f"{name}: display/barycentric")
    place_rules.check_display(sections, name)


def _check_metadata(metadata: dict[str, Any], levels: int, name: str) -> None:
    missing = [key for key in METADATA_KEYS if key not in metadata]
    _require(not missing, f"{name}: metadata", f"key {missing[0] if missing else ''!r} is missing")
    front = metadata.get("front", 0)
    _require(
        isinstance(front, (int, float)) and not isinstance(front, bool) and -180 <= front <= 360,
        f"{name}: metadata",
        f"'front' is {front!r}, allowed are -180 to 360 degrees",
    )
    stated = metadata["levels"]
    _require(
        isinstance(stated, list) and len(stated) == levels, f"{name}: metadata", f"'levels' must list {levels} levels"
    )
