"""The methods that the suite holds against truth."""

from __future__ import annotations

from dataclasses import dataclass

from quadgraph.base.errors import InputError
from quadgraph_validation.truth.schemes import Scheme


@dataclass(frozen=True)
class Method:
    """A scheme, whose model may be "auto", and a solver, by the names the engine uses."""

    name: str
    scheme: Scheme
    solver: str = "fmg-pcg"


DEFAULT = Method("fem", Scheme("fem", "buried", "auto"))
METHODS = (
    DEFAULT,
    Method("fem diffusion", Scheme("fem", "buried", "diffusion")),
    Method("quadgraph-fv", Scheme("quadgraph-fv", "buried", "auto")),
    Method("quadgraph-fdm", Scheme("quadgraph-fdm", "diffuse", "diffusion")),
)
# The default method with each solver: where iterations end, not where meshes do.
SOLVERS = (DEFAULT, *(Method(f"fem {name}", DEFAULT.scheme, name) for name in ("vcycle", "dpcg", "cascade", "jacobi")))
# What has packed entries.
MODELS = (Method("fem", Scheme("fem", "buried", "sp3")), METHODS[1])


def chosen(methods: tuple[Method, ...], names: list[str]) -> list[Method]:
    """Those of the given names, all if there are none."""
    return [method for method in methods if not names or method.name in names]


def check(names: list[str]) -> None:
    """Raise InputError for a name that no method has."""
    known = dict.fromkeys(method.name for method in (*METHODS, *SOLVERS))
    for name in names:
        if name not in known:
            raise InputError(f"method '{name}': allowed are {', '.join(known)}")
