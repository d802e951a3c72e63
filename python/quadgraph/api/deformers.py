"""Steps of a deformation, applied in order to the body at rest. docs/deformation.md tells what each does.

Lengths are mm, angles degrees. `axis` runs through `centre`, None for the middle of the box around the body; `range` is
two shares of that box along the axis, `range_mm` two coordinates along it. These four are given by name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from quadgraph import core
from quadgraph.api.values import Value, Vector, plain_members

Triangles: TypeAlias = Sequence[Sequence[int]] | npt.NDArray[np.integer[Any]]
Points: TypeAlias = Sequence[Vector] | npt.NDArray[np.floating[Any]]


@dataclass(frozen=True, repr=False)
class Deformer(Value):
    """Base of all steps. Where one is wanted, the object of a scene file does as well.

    Numbers are checked by the engine, when the step is set: InputError names the member and what is allowed.
    """


@dataclass(frozen=True, kw_only=True, repr=False)
class _AboutCentre(Deformer):
    """What turns or scales about a point."""

    axis: Vector | None = None
    centre: Vector | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class _AlongAxis(_AboutCentre):
    """What changes along an axis, within a range of it."""

    range: Vector | None = None
    range_mm: Vector | None = None


@dataclass(frozen=True, repr=False)
class Twist(_AlongAxis):
    """Sections across the axis turn, by up to `degrees` (at most 3600)."""

    type: ClassVar[str] = "twist"
    degrees: float


@dataclass(frozen=True, repr=False)
class Bend(_AlongAxis):
    """The axis becomes an arc of `degrees` to the side `towards`, its length kept."""

    type: ClassVar[str] = "bend"
    degrees: float
    towards: Vector | None = None


@dataclass(frozen=True, repr=False)
class Taper(_AlongAxis):
    """Sections across the axis are scaled, from 1 to `factor`."""

    type: ClassVar[str] = "taper"
    factor: float


@dataclass(frozen=True, repr=False)
class Stretch(_AlongAxis):
    """The range along the axis becomes `factor` times as long."""

    type: ClassVar[str] = "stretch"
    factor: float


@dataclass(frozen=True, repr=False)
class Transform(_AboutCentre):
    """Scaled along x, y, z about the centre, turned about the axis, moved by `translate`, mm."""

    type: ClassVar[str] = "transform"
    degrees: float | None = None
    scale: float | Vector | None = None
    translate: Vector | None = None


@dataclass(frozen=True, repr=False)
class Lattice(Deformer):
    """Free-form deformation by displacements of the control points of a box [Sederberg and Parry 1986].

    size: (n, m, k), 1 to 16 each; displacements: (n m k, 3), mm, x fastest; box: {"low", "high"}, mm.
    """

    type: ClassVar[str] = "lattice"
    size: Sequence[int]
    displacements: Points
    basis: Literal["bezier", "linear"] | None = None
    box: Mapping[str, Vector] | None = None


@dataclass(frozen=True, repr=False)
class Cage(Deformer):
    """Mean value coordinates in a closed triangle mesh [Ju et al. 2005].

    cage, moved: its vertices before and after, (n, 3) mm; triangles: (m, 3).
    """

    type: ClassVar[str] = "cage"
    cage: Points
    moved: Points
    triangles: Triangles


class Shapes:
    """Displacements of all vertices of a body, held in memory: what a .qshapes file has.

    display: (shapes, n_d, 3); levels: (shapes, n_v, 3) of each level, finest first; mm. Raises InputError.
    """

    def __init__(self, display: npt.ArrayLike, levels: Sequence[npt.ArrayLike]) -> None:
        """Copy the arrays. Raises InputError."""
        self._shapes = core.Shapes(np.asarray(display, np.float32), [np.asarray(each, np.float32) for each in levels])

    def __repr__(self) -> str:
        """Return their number."""
        return f"Shapes({self.count})"

    @property
    def count(self) -> int:
        """How many shapes there are."""
        return self._shapes.count


@dataclass(frozen=True, repr=False)
class Displaced(Deformer):
    """The weighted sum of given displacements of all vertices.

    shapes: a .qshapes file, or `Shapes` in memory; weights: one for each shape; frame: in place of
    weights where the shapes are frames, at or between two of which the body lies.
    """

    type: ClassVar[str] = "displaced"
    shapes: str | Shapes
    weights: Sequence[float] | None = None
    frame: float | None = None


def as_dict(step: Deformer | Mapping[str, Any]) -> dict[str, Any]:
    """Return the members of a step, with plain values, and shapes in memory as the compiled engine holds them."""
    members = step.to_dict() if isinstance(step, Deformer) else dict(step)
    if isinstance(shapes := members.get("shapes"), Shapes):
        members["shapes"] = shapes._shapes
    return plain_members(members)


def in_memory(step: Deformer | Mapping[str, Any]) -> bool:
    """Whether a step has shapes that no scene file can name."""
    members = step.to_dict() if isinstance(step, Deformer) else step
    return isinstance(members.get("shapes"), Shapes)


DEFORMERS = {kind.type: kind for kind in (Twist, Bend, Taper, Stretch, Transform, Lattice, Cage, Displaced)}


def deformer_from(members: Mapping[str, Any]) -> Deformer:
    """Return the step with the members of a scene file's object, whose `type` is known."""
    kind = DEFORMERS[members["type"]]
    return kind(**{each.name: members[each.name] for each in fields(kind) if each.name in members})
