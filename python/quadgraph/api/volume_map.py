"""How a volume of coefficients that was found in one body is carried into another."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

from quadgraph import core
from quadgraph.api.reprs import members_text

MapKind: TypeAlias = Literal["box", "shell", "volume"]
MapRepeat: TypeAlias = Literal["mirror", "clamp"]


@dataclass(frozen=True, repr=False)
class VolumeMap:
    """How a volume is carried into a body (docs/acquisition.md, "Onto other shapes").

    kind: "shell", by the place on the surface and the depth below it; "box", the volume's box stretched to the body's;
    "volume", a harmonic map of the body's tets; scale: of "shell", mm of the body for one of the source, of "box", the
    source's box over the body's, 0.01 to 100; repeat: what is beyond the source's edges; depth: mm of the source that
    "shell" goes by its places, half the block's least side where it is left out; source: the .qgraph that the volume
    was found in, None for the volume's own box. Raises InputError.
    """

    kind: MapKind
    scale: float = 1.0
    repeat: MapRepeat = "mirror"
    depth: float | None = None
    source: str | Path | None = None

    def __post_init__(self) -> None:
        """Check. Raises InputError."""
        core.with_map("any.npz", self.text)

    def __repr__(self) -> str:
        """Return name and members in one line."""
        return members_text(self)

    @property
    def text(self) -> str:
        """The text as --map takes it."""
        usual = {"scale": 1.0, "repeat": "mirror", "depth": None, "source": None}
        given = {name: value for name in usual if (value := getattr(self, name)) != usual[name]}
        named = {"from" if name == "source" else name: value for name, value in given.items()}
        return ",".join([self.kind, *(f"{name}={value}" for name, value in named.items())])


@dataclass(frozen=True)
class MapReport:
    """What a map did.

    stretch: the lengths that a millimetre of the source has in the body, of which 5, 50 and 95% are shorter; core: the
    share of the inside that no place of the source falls on, which is interpolated; coarser: how many times as wide as
    the source's the cells are; tets and flipped_tets: of a harmonic map, all, and those that it turns inside out;
    text: the same in words.
    """

    stretch: tuple[float, float, float]
    core: float
    coarser: float
    tets: int
    flipped_tets: int
    text: str
