"""The methods that the suite holds against truth."""

from __future__ import annotations

from dataclasses import dataclass

from quadgraph.base.errors import InputError
from quadgraph_validation.truth.schemes import Scheme


@dataclass(frozen=True)
class StabilityMethod:
    """A scheme, whose model may be "auto", and a solver, by the names the engine uses."""

    name: str
    scheme: Scheme
    solver: str = "fmg-pcg"


DEFAULT = StabilityMethod("fem", Scheme("fem", "buried", "auto"))
METHODS = (
    DEFAULT,
    StabilityMethod("fem diffusion", Scheme("fem", "buried", "diffusion")),
    StabilityMethod("quadgraph-fv", Scheme("quadgraph-fv", "buried", "auto")),
    StabilityMethod("quadgraph-fdm", Scheme("quadgraph-fdm", "diffuse", "diffusion")),
)
# The default method with each solver: where iterations end, not where meshes do.
SOLVERS = (
    DEFAULT,
    *(StabilityMethod(f"fem {name}", DEFAULT.scheme, name) for name in ("vcycle", "dpcg", "cascade", "jacobi")),
)
# What has packed entries.
MODELS = (StabilityMethod("fem", Scheme("fem", "buried", "sp3")), METHODS[1])


def chosen(methods: tuple[StabilityMethod, ...], names: list[str]) -> list[StabilityMethod]:
    """Those of the given names, all if there are none."""
    return [method for method in methods if not names or method.name in names]


def check(names: list[str]) -> None:
    """Raise InputError for a name that no method has."""
    known = dict.fromkeys(method.name for method in (*METHODS, *SOLVERS))
    for name in names:
        if name not in known:
            raise InputError(f"method '{name}': allowed are {', '.join(known)}")
