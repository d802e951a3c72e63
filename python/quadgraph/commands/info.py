"""`quadgraph info`: everything a .qgraph file holds, and the device memory that it will take."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from quadgraph.baking.budget import record
from quadgraph.base.errors import FormatError
from quadgraph.commands import device_memory
from quadgraph.commands.bake import exchange_line, level_table

_LINE = 2000  # characters of a line that come from a file


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("info", help="what a .qgraph file holds", description=__doc__)
    parser.add_argument("file", metavar="FILE", type=Path, help="a baked .qgraph")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(args: argparse.Namespace) -> int:
    """Read, validate and tell; 0 on success."""
    from quadgraph.file import qgraph_file, stated

    file = qgraph_file.read(args.file)
    stated.check(file, str(args.file))
    facts = describe(file) | {"device_memory": device_memory.ask(args.file)}
    if args.json:
        print(json.dumps(facts, indent=1))
    else:
        try:
            _print_facts(str(args.file), facts)
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            what = printable(repr(error))[:200]
            raise FormatError(f"{args.file}: metadata: not what a bake writes ({what}); bake it again") from error
    return 0


def describe(file) -> dict[str, Any]:
    """Return metadata, sections and mesh quality of a QGraphFile as plain values.

    Angles in degrees, lengths in mm; node counts and dihedral angles per level; `exchange.summary` or None.
    """
    from quadgraph.file import level_quality, sections
    from quadgraph.tets import exchange

    seen = sections.read_exchange(file)

    return {
        "byte_size": file.byte_size,
        "metadata": file.metadata,
        "sections": [
            {"name": name, "type": array.dtype.name, "shape": list(array.shape), "bytes": array.nbytes}
            for name, array in file.sections.items()
        ],
        "levels": [level_quality.of_level(file, number) for number in range(file.level_count)],
        "exchange": None if seen is None else exchange.summary(seen, level_quality.boundary(file, seen.level)),
        "display": {
            "vertices": len(file.sections["display/vertices"]),
            "triangles": len(file.sections["display/triangles"]),
            "size_mm": np.ptp(file.sections["display/vertices"], axis=0).tolist(),
        },
    }


def printable(text: str) -> str:
    """Return the text with what a terminal would obey written as it stands in the file, and cut short."""
    shown = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text[:_LINE])
    return shown + ("..." if len(text) > _LINE else "")


def _print_facts(name: str, facts: dict[str, Any]) -> None:
    from quadgraph.baking import inside
    from quadgraph.mesh.looks import file_normals

    console, metadata = Console(highlight=False), facts["metadata"]
    source, mesher = metadata["source"], metadata["mesher"]
    size = " x ".join(f"{extent:.4g}" for extent in facts["display"]["size_mm"])
    grading = "" if mesher["grading"] is None else f", grading {mesher['grading']}"
    repairs = ", ".join(f"{entry['what']}: {entry['count']}" for entry in metadata["repairs"]) or "none"
    tools = ", ".join(f"{tool} {version}" for tool, version in metadata["tools"].items())
    given = {key: value for key, value in metadata.get("options", {}).items() if value not in (None, [])}
    options = ", ".join(f"{key} {value}" for key, value in given.items()) or "unknown"
    lines = [
        f"{name}: {facts['byte_size'] / 1e6:.2f} MB, {size} mm, by {metadata['generator']}",
        f"source: {source['name']}, {source['vertices']:,} vertices, {source['triangles']:,} triangles, "
        f"unit {metadata['unit_mm']:g} mm",
        f"sha256: {source['sha256']}",
        f"mesher: {mesher['name']} {mesher['version']} {mesher['options']}{grading}",
        f"options: {options}",
        *([inside.sentence(metadata["interior"])] if "interior" in metadata else []),
        f"repairs: {repairs}",
        *([file_normals.sentence(metadata["normals"])] if "normals" in metadata else []),
        f"front: azimuth {metadata.get('front', 0):g} degrees",
        f"tools: {tools}",
    ]
    for line in lines:
        console.print(printable(line), markup=False, soft_wrap=True)
    console.print(exchange_line(facts["exchange"]), soft_wrap=True)
    for sentence in record.sentences(metadata["budget"], name) if "budget" in metadata else []:
        console.print(sentence, markup=False, soft_wrap=True)
    if metadata.get("bodies"):
        console.print(_body_table(metadata["bodies"]))
    if facts["levels"]:
        console.print(level_table(metadata["levels"]))
        console.print(_quality_table(facts["levels"]))
    else:
        console.print("levels: none, a surface alone: only --method shortest-path shows it", soft_wrap=True)
    console.print(_section_table(facts["sections"]))
    memory = facts["device_memory"]
    if memory["unknown"] is not None:
        console.print(f"device memory: unknown, {memory['unknown']}", markup=False, soft_wrap=True)
    else:
        console.print(device_memory.table(memory["entries"]))


def _body_table(bodies: list[dict[str, Any]]) -> Table:
    table = Table("body", "within", "mesh", "size, mm", "position, mm", "tets", "volume, mm3")
    for body in bodies:
        low, high = body["box_mm"]
        size = " x ".join(f"{b - a:.4g}" for a, b in zip(low, high, strict=True))
        place = ", ".join(f"{x:.4g}" for x in body["position"])
        names = (printable(str(text)) for text in (body["name"], body.get("within", ""), body["source"]["name"]))
        table.add_row(*map(escape, names), size, place, f"{body['tets']:,}", f"{body['volume_mm3']:,.1f}")
    return table


def _quality_table(levels: list[dict[str, Any]]) -> Table:
    table = Table("level", "nodes", "smallest dihedral", "1st percentile", "largest", "mean link, mm", "cache lines")
    for number, level in enumerate(levels):
        low, percentile, high = (level["dihedral_degrees"][key] for key in ("min", "percentile_1", "max"))
        table.add_row(
            str(number),
            f"{level['nodes']:,}",
            *(f"{angle:.2f}\N{DEGREE SIGN}" for angle in (low, percentile, high)),
            f"{level['mean_link_mm']:.3g}",
            f"{level['locality']['lines_per_block']:.0f} per 1024 nodes",
        )
    return table


def _section_table(entries: list[dict[str, Any]]) -> Table:
    table = Table("section", "type", "shape", "bytes")
    for entry in entries:
        shape = " x ".join(f"{n:,}" for n in entry["shape"])
        table.add_row(entry["name"], entry["type"], shape, f"{entry['bytes']:,}")
    return table
