"""`--material own`: a mesh in the colours of its own file, where a command gets the mesh itself."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quadgraph.base import outputs
from quadgraph.base.errors import InputError
from quadgraph.mesh import mesh_names

if TYPE_CHECKING:
    from quadgraph.baking.colours.colour_options import ColourOptions
    from quadgraph.core import Engine
    from quadgraph.mesh.looks.parts import ColouredMesh

NAME = "own"
HELP = (
    "--material own, in render, solve, turntable and compare: the colours of the mesh file itself, as `quadgraph "
    "colours` makes a material of them; own,mean_free_path=1,depth=3,base=wax says what its options say"
)
_NUMBERS = ("mean_free_path", "depth", "eta", "spacing", "cells")


def is_own(text: str) -> bool:
    """Whether a material's text asks for the colours of the mesh."""
    return text == NAME or text.startswith(f"{NAME},")


@dataclass(frozen=True, eq=False)
class OwnColours:
    """What a mesh file says of colour, and how it becomes coefficients."""

    mesh: Path
    looks: ColouredMesh
    options: ColourOptions

    def set_on(self, engine: Engine, body: Path) -> str:
        """Give them to an engine of the body, and say what became of them. Raises InputError, FormatError."""
        from quadgraph.baking.colours.colour_volume import volume_of

        made, report = volume_of(self.looks, self.mesh, body, self.options)
        made.set_on(engine)
        return report.text


def read(text: str, mesh: Path, written: Iterable[Path | None]) -> OwnColours:
    """Read the colours of a mesh, before it is baked.

    text: as `options_of` takes it; written: the outputs of the run. Raises InputError, also where one of those is a
    picture of the mesh.
    """
    from quadgraph.mesh.looks.read_looks import read_looks

    options = options_of(text, mesh)
    found = OwnColours(mesh, read_looks(mesh), options)
    outputs.check_outputs(written, found.looks.files)
    return found


def options_of(text: str, mesh: Path) -> ColourOptions:
    """What goes with the name: own,mean_free_path=1,depth=3,base=wax; what follows base= is its.

    Raises InputError, also where the file is no mesh.
    """
    if not mesh_names.is_mesh(mesh):
        raise InputError(
            f"{mesh}: material '{NAME}' found with a file that has no colours; `quadgraph colours` makes a material of "
            "its mesh, or name the mesh here"
        )
    from quadgraph.baking.colours.colour_options import ColourOptions

    members: dict[str, Any] = {}
    head, found, base = text.partition(",base=")
    if found:
        members["base"] = base
    for part in head.split(",")[1:]:
        name, _, value = part.partition("=")
        if name not in _NUMBERS:
            allowed = ", ".join(_NUMBERS)
            raise InputError(f"material '{NAME}': {part[:80]!r} found, allowed are {allowed}, and base at the end")
        members[name] = _number(name, value)
    return ColourOptions(**members)


def _number(name: str, text: str) -> int | float | tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split("/"))
    except ValueError:
        values = ()
    if len(values) == 3 and name == "mean_free_path":
        return values
    if len(values) != 1 or (name == "cells" and not values[0].is_integer()):
        raise InputError(f"material '{NAME}', {name}: {text[:80]!r} found, a number is wanted")
    return int(values[0]) if name == "cells" else values[0]
