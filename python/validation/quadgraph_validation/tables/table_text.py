"""The tables as Markdown, from a record alone: what was measured, and what the paper says."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from quadgraph_validation.tables import published
from quadgraph_validation.tables.table_record import TITLES
from quadgraph_validation.tables.table_ways import DEFAULT, NAMES, TARGET

LEVELS_OF_ERROR = (0.1, 0.01, 0.001)  # at which the curves of Figure 14 are read
FITTED_FROM = 20_000  # tets; smaller bodies are all overhead


def document(record: dict[str, Any]) -> str:
    """All tables that the record has, each under its title."""
    parts = [f"## {TITLES[name]}\n\n{section(record, name)}" for name in TITLES if name in record["tables"]]
    return "\n\n".join(parts) + "\n"


def filled(document: str, record: dict[str, Any]) -> str:
    """A document with what stands between `<!-- table NAME -->` and `<!-- end -->` replaced by the record's table of
    that name, where the record has one. Raises ValueError for a name that no table has, or without an end.
    """
    parts = document.split("<!-- table ")
    for index, part in enumerate(parts[1:], 1):
        name, mark, rest = part.partition(" -->")
        old, end, after = rest.partition("<!-- end -->")
        if name not in TITLES or not mark or not end:
            raise ValueError(
                f"table '{name.strip()[:20]}': allowed are {', '.join(TITLES)}, each with its <!-- end -->"
            )
        shown = f"\n{section(record, name)}\n" if name in record["tables"] else old
        parts[index] = f"{name}{mark}{shown}{end}{after}"
    return "<!-- table ".join(parts)


def section(record: dict[str, Any], name: str) -> str:
    """A table with its machine and what was left out."""
    entry = record["tables"][name]
    rows = list(entry["rows"].values())
    made = {"1": _table_1, "12": _figure_12, "13": _figure_13, "14": _figure_14, "packing": _packing}[name]
    body = made(rows if name != "12" else growth(record)) if rows else []
    left = [f"Left out: {key}: {why}" for key, why in entry["left_out"].items()]
    begun = [] if entry["complete"] else ["Not finished: the same command goes on."]
    return "\n\n".join([device_text(record, name), *body, *left, *begun])


def device_text(record: dict[str, Any], name: str) -> str:
    """What times are of, in words."""
    entry, settings = record["tables"][name], record["settings"]
    machine = entry["machine"]
    loads = [row["load"] for row in entry["rows"].values()]
    load = f"load {min(loads):g} to {max(loads):g}" if loads else "nothing measured"
    drawn = f", pictures of {settings['pixels']}² pixels, best of {2 * settings['repeats']} frames"
    return (
        f"{machine['device'].split(' (')[0]}, {machine['cores']} cores, {load}; scale {settings['scale']:g}"
        f"{drawn if name in ('1', '12') else ''}; commit {machine['commit']}"
    )


def grid(head: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1) -> str:
    """A Markdown table; the first `left` columns are words."""
    rule = ["---" if i < left else "--:" for i in range(len(head))]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [head, rule, *rows])


def percent(value: float) -> str:
    """A relative error in %: two digits, or thousandths where it is below a tenth."""
    shown = 100 * value
    return f"{shown:.0f}%" if shown >= 9.5 else f"{shown:.2g}%" if shown >= 0.0995 else f"{shown:.3f}%"


def measured(row: dict[str, Any]) -> str:
    """K of a mesh, where anything lies deep enough to tell."""
    return f"{row['grading']:.2f}" if row["grading"] else "none"


def errors(found: dict[str, float] | None) -> str:
    """Whole / unlit, where there is one."""
    return "" if not found else " / ".join(percent(found[part]) for part in ("whole", "unlit") if part in found)


def number(value: float) -> str:
    """Three digits, no exponent."""
    return f"{value:,.0f}" if value >= 99.5 else f"{value:.3g}"


def done(row: dict[str, Any], way: str) -> dict[str, Any] | None:
    """What was measured of a way, None if it failed."""
    entry = row["ways"].get(way)
    return None if entry is None or entry.get("failed") else entry


def _table_1(rows: list[dict[str, Any]]) -> list[str]:
    head = ["scene", "body", "N_s", "N_i", "K", "L", "bake, s", "paper: N_s", "N_i", "K", "L", "prep, min"]
    bodies, methods = [], []
    for row in rows:
        paper, nodes = published.scene(row["paper"]), row["nodes"][0]
        body = row["body"] + ("" if not row["other"] else " (another)")
        ours = [f"{nodes['surface']:,}", f"{nodes['inner']:,}", measured(row), str(len(row["nodes"]))]
        theirs = [f"{paper.surface_nodes}k", f"{paper.inner_nodes}k", f"{paper.grading:g}", str(paper.levels)]
        bodies.append([paper.name, body, *ours, number(row["bake_s"]), *theirs, str(paper.minutes)])
        methods += [_method(row, paper, way) for way in NAMES]
    others = [f"{row['paper']}: {row['other']}; {row['body']} takes its place." for row in rows if row["other"]]
    return [grid(head, bodies, 2), *others, grid(_METHOD_HEAD, methods, 2), _ratios(rows)]


_METHOD_HEAD = [
    "scene", "method", "iterations", "work", "MB", "bytes a node", "frame, ms", "without picture", "frames/s",
    "error left", f"to {100 * TARGET:g}%: iterations", "work", "ms",
]  # fmt: skip


def _method(row: dict[str, Any], paper: published.PublishedScene, way: str) -> list[str]:
    entry = row["ways"][way]
    if entry.get("failed"):
        return [paper.name, way, entry["failed"], *[""] * (len(_METHOD_HEAD) - 3)]
    quoted = (lambda value: f" (paper: {value})") if way == NAMES[0] else (lambda value: "")
    each = f"{entry['iterations'][0]}" if way == NAMES[0] else ", ".join(map(str, entry["iterations"]))
    least = entry.get("least")
    to_target = ["not reached", "", ""]
    if least:
        to_target = [str(least["iterations"]), number(least["work"]), number(least["ms"])]
    per_node = entry["solve_bytes"] / sum(row["nodes"][0].values())
    paper_per_node = 1e3 * paper.megabytes / (paper.surface_nodes + paper.inner_nodes)
    memory = [
        f"{entry['solve_bytes'] / 1e6:.1f}{quoted(paper.megabytes)}",
        f"{per_node:.0f}{quoted(f'{paper_per_node:.0f}')}",
    ]
    rate = f"{entry['frames_per_s']:.2g}{quoted(paper.frames_per_s)}"
    left = errors(entry.get("error"))
    times = [number(entry["ms"]), number(without_picture(entry))]
    each += quoted(paper.iterations)
    return [paper.name, way, each, number(entry["work"]), *memory, *times, rate, left, *to_target]


def _ratios(rows: list[dict[str, Any]]) -> str:
    texts = []
    for way in NAMES[1:]:
        found = [ratio for row in rows if (ratio := ratios(row, way))]
        if found:
            spans = [f"{min(of):.2g} to {max(of):.2g}" for of in zip(*found, strict=True)]
            texts.append(f"{way}: {spans[0]} and {spans[1]}")
    return f"Work and time to {100 * TARGET:g}%, of the published method over ours: " + "; ".join(texts) + "."


def ratios(row: dict[str, Any], way: str) -> tuple[float, float] | None:
    """Work and time of the published method to TARGET, over those of a way; None where one did not get there."""
    theirs, ours = ((done(row, name) or {}).get("least") for name in (NAMES[0], way))
    return (theirs["work"] / ours["work"], theirs["ms"] / ours["ms"]) if theirs and ours else None


def growth(record: dict[str, Any]) -> list[dict[str, Any]]:
    """The rows of Figure 12 with those of Table 1, by size."""
    tables = [record["tables"][name]["rows"].values() for name in ("12", "1") if name in record["tables"]]
    return sorted((row for of in tables for row in of), key=lambda row: row["nodes"][0]["inner"])


def _figure_12(rows: list[dict[str, Any]]) -> list[str]:
    head = ["body", "tets", "published: iterations", "ms"]
    head += [f"{way}, to {100 * TARGET:g}%: {what}" for way in NAMES for what in ("iterations", "ms")]
    cells = []
    for row in rows:
        entry = done(row, NAMES[0])
        frame = [str(row["published_iterations"]), number(without_picture(entry)) if entry else ""]
        least = [(done(row, way) or {}).get("least") for way in NAMES]
        pairs = [[str(of["iterations"]), number(of["ms"])] if of else ["not reached", ""] for of in least]
        cells.append([row["body"], f"{row['nodes'][0]['inner']:,}", *frame, *(text for pair in pairs for text in pair)])
    fits = [f"{way}: {power:.2f}" for way in NAMES if (power := exponent(rows, way)) is not None]
    told = (
        [f"Time to {100 * TARGET:g}% grows as the number of tets to the power " + ", ".join(fits) + "."] if fits else []
    )
    return [grid(head, cells), *told, f"Paper: “{published.FIGURE_12}”"]


def without_picture(entry: dict[str, Any]) -> float:
    """Time of a frame until the exitance is known, ms."""
    return sum(ms for stage, ms in entry["stages"].items() if stage != "picture")


def exponent(rows: list[dict[str, Any]], way: str) -> float | None:
    """Slope of log time to TARGET over log tets, of bodies from FITTED_FROM tets on; None for fewer than three."""
    pairs = [(row["nodes"][0]["inner"], ((done(row, way) or {}).get("least") or {}).get("ms")) for row in rows]
    fitted = [(tets, ms) for tets, ms in pairs if ms and tets >= FITTED_FROM]
    if len(fitted) < 3:
        return None
    tets, ms = np.log(fitted).T
    return float(np.polyfit(tets, ms, 1)[0])


_JUDGED = [(way, what) for way in NAMES for what in ("picture", "mesh") if (way, what) != (DEFAULT, "mesh")]


def _figure_13(rows: list[dict[str, Any]]) -> list[str]:
    head = [
        "scene",
        "K",
        "as measured",
        "N_s",
        "N_i",
        *(f"{way}: {what}" for way, what in _JUDGED),
    ]
    cells = []
    for row in rows:
        for of in row["gradings"]:
            nodes = of["nodes"][0]
            start = [
                row["body"],
                f"{of['K']:g}",
                measured(of),
                f"{nodes['surface']:,}",
                f"{nodes['inner']:,}",
            ]
            cells.append(start + [errors(of["errors"][way].get(what)) for way, what in _JUDGED])
    return [
        grid(head, cells),
        "picture: against path tracing; mesh: of the exitance, against the same equations on the mesh of the "
        "smallest K with every tet cut in eight; whole / unlit.",
        f"Paper: “{published.FIGURE_13}”; Figure 11, of one body: "
        + ", ".join(f"K = {k:g}: {nodes}k nodes, {ms} ms" for k, (nodes, ms) in published.FIGURE_11.items()),
    ]


def _figure_14(rows: list[dict[str, Any]]) -> list[str]:
    head = ["body", "method"]
    head += [f"to {100 * target:g}%: {what}" for target in LEVELS_OF_ERROR for what in ("iterations", "work", "ms")]
    cells = []
    for row in rows:
        for name, curve in row["curves"].items():
            points = [reaching(curve, target) for target in LEVELS_OF_ERROR]
            parts = [
                [str(p["iterations"]), number(p["work"]), number(p["ms"])] if p else ["none", "", ""] for p in points
            ]
            cells.append([row["body"], name, *(text for part in parts for text in part)])
    return [grid(head, cells, 2), f"Paper: “{published.FIGURE_14}”"]


def worst(point: dict[str, Any]) -> float:
    """The larger of the errors over the whole surface and its unlit part."""
    return max(point["whole"], point["unlit"])


def reaching(curve: list[dict[str, Any]], target: float) -> dict[str, Any] | None:
    """The point of a curve of least work whose errors are both no larger."""
    return min((point for point in curve if worst(point) <= target), key=lambda point: point["work"], default=None)


def _packing(rows: list[dict[str, Any]]) -> list[str]:
    head = ["body", "nodes", "method", "in blocks, ms", "at random, ms", "gain"]
    cells = []
    for row in rows:
        nodes = sum(row["nodes"][0].values())
        for way, entry in row["ways"].items():
            ms = entry["ms"]
            cells.append([row["body"], f"{nodes:,}", way, *(number(ms[order]) for order in ("blocks", "random"))])
            cells[-1].append(percent(entry["gain"]) if entry["gain"] > 0 else f"{100 * entry['gain']:.1f}%")
    return [grid(head, cells, 3), f"Paper: “{published.PACKING}”"]
