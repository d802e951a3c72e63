"""A mesh in the place of a baked file: its size, and the bake that a command does by itself."""

from __future__ import annotations

import argparse
import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rich.console import Console

from quadgraph.base.arguments import length_mm
from quadgraph.base.errors import InputError
from quadgraph.base.units import UNITS_MM
from quadgraph.mesh import mesh_names

_MEMBERS = {"unit": "unit", "height": "height_mm", "longest": "longest_mm", "wrap": "wrap"}  # of BakeOptions
NAMES = tuple(_MEMBERS)  # of the options of meshes


def add_size_arguments(parser: argparse.ArgumentParser | argparse._ArgumentGroup) -> None:
    """Add how large the body of a mesh is, and what is baked for one that is no solid."""
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--unit", choices=tuple(UNITS_MM), help="unit of a mesh's coordinates")
    size.add_argument("--height", type=length_mm, metavar="L", help="a mesh's extent upwards, like 100mm or 1.8m")
    size.add_argument(
        "--longest",
        type=length_mm,
        metavar="L",
        help="longest side of a mesh (default: glTF in metres where that is plausible, else 100mm)",
    )
    parser.add_argument(
        "--wrap",
        type=wrap_size,
        metavar="SIZE",
        help="bake a closed surface around a mesh that is open, torn, crossing or in pieces: it covers holes narrower "
        "than SIZE, like 2mm; auto: the finest of a few sizes that does not go in through a hole",
    )


def wrap_size(text: str) -> float | str:
    """Argument type: auto, or a length, mm."""
    return text if text == "auto" else length_mm(text)


def sizes(args: argparse.Namespace) -> dict[str, Any]:
    """Keyword arguments of BakeOptions for what the arguments say of the size and the wrap."""
    return {_MEMBERS[name]: value for name, value in _given(args).items()}


def _given(args: argparse.Namespace) -> dict[str, Any]:
    return {name: value for name in _MEMBERS if (value := getattr(args, name, None)) is not None}


@contextlib.contextmanager
def body(file: Path, args: argparse.Namespace, surface_only: bool) -> Iterator[Path]:
    """Give a baked file as it is, and of a mesh one that is made of it, there as long as the block runs.

    surface_only: without levels, which takes no time and any mesh; else baked, and kept for the next time. Progress is
    told on standard error. Raises InputError, ToolError.
    """
    if not mesh_names.is_mesh(file):
        if sizes(args):
            raise InputError(
                f"{file}: --unit, --height, --longest and --wrap are for meshes; a baked file knows its size"
            )
        yield file
        return
    errors = Console(stderr=True, highlight=False, soft_wrap=True)

    def tell(text: str) -> None:
        errors.print(text, markup=False)

    if not surface_only:
        from quadgraph.baking import kept
        from quadgraph.baking.pipeline import BakeOptions

        with contextlib.ExitStack() as stack:
            with errors.status(f"baking {file.name}, once for this mesh and size"):
                path = stack.enter_context(kept.body(file, BakeOptions(**sizes(args)), tell))
            yield path
        return
    if getattr(args, "wrap", None) is not None:
        raise InputError("--wrap: found with --method shortest-path, which takes any mesh as it is")
    from quadgraph.baking import bare

    with tempfile.TemporaryDirectory(prefix="quadgraph-") as folder:
        path = Path(folder) / f"{file.stem}.qgraph"
        note = bare.write(file, path, **sizes(args)).size_note
        if note:
            tell(note)
        yield path
