"""How the error falls with the element size: round bodies and a manufactured solution, every method."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.base.relative_error import relative_rms
from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import manufactured, round_bodies
from quadgraph_validation.truth.round_bodies import Shell
from quadgraph_validation.truth.schemes import PUBLISHED, BodyOf, Scheme, StudyBody, StudyLight

ETA = 1.3
COEFFICIENTS = (0.5, 0.6, 0.4, 0.3)  # of q in Legendre polynomials or cosines, W/mm^2; q is positive everywhere
RADIUS, CORE_RADIUS = 10.0, 5.0  # mm
SOFT = Medium(0.2, 0.02)  # mean free path 4.5 mm: what even the coarsest mesh resolves
DENSE = Medium(0.5, 0.01)
FEM = (Scheme("fem", "diffuse", "diffusion"), Scheme("fem", "diffuse", "sp3"))
FV = (Scheme("quadgraph-fv", "diffuse", "diffusion"), Scheme("quadgraph-fv", "diffuse", "sp3"))
GRAPH_METHODS = (*FV, PUBLISHED)
METHODS = {"fem": FEM, "graph": GRAPH_METHODS}


@dataclass(frozen=True)
class OrdersBody:
    """A body of known solution. mesh: from the number of refinements; exact: moments at points (n, 3) mm."""

    name: str
    shells: tuple[Shell, ...]
    mesh: Callable[[int], Graph]
    form: Callable[..., np.ndarray]

    def angle(self, points: np.ndarray) -> np.ndarray:
        """What `form` takes beside the radius at points (n, 3) mm: cos theta from z, or the angle about it."""
        if self.form is round_bodies.sphere:
            return points[:, 2] / np.linalg.norm(points, axis=1)
        return np.arctan2(points[:, 1], points[:, 0])

    def irradiance(self, points: np.ndarray) -> np.ndarray:
        """q (n,), W/mm^2."""
        if self.form is round_bodies.sphere:
            return np.polynomial.legendre.legval(self.angle(points), COEFFICIENTS)
        return np.cos(np.outer(self.angle(points), np.arange(len(COEFFICIENTS)))) @ COEFFICIENTS

    def fluence(self, points: np.ndarray, scheme: Scheme) -> np.ndarray:
        """Exact fluence (n,) on the surface, W/mm^2, in the direction of the points."""
        radius = np.full(len(points), self.shells[-1].radius)
        model, condition = scheme.model_of, scheme.boundary(ETA)
        return self.form(self.shells, COEFFICIENTS, model, condition, radius, self.angle(points))[0]


BODIES = (
    OrdersBody("sphere", (Shell(SOFT, RADIUS),), lambda n: meshes.ball(RADIUS, n), round_bodies.sphere),
    OrdersBody(
        "two-layer sphere",
        (Shell(DENSE, CORE_RADIUS), Shell(SOFT, RADIUS)),
        lambda n: meshes.two_layer_ball(CORE_RADIUS, RADIUS, n),
        round_bodies.sphere,
    ),
    OrdersBody("cylinder", (Shell(SOFT, RADIUS),), lambda n: meshes.cylinder(RADIUS, 8 * 2**n), round_bodies.cylinder),
)
MANUFACTURED = ("manufactured", "fem")
CASES = (*itertools.product((body.name for body in BODIES), METHODS), MANUFACTURED)


def surface_error(body: StudyBody, case: OrdersBody, scheme: Scheme) -> float:
    """Relative area-weighted L2 error of the fluence on the open surface."""
    centre = np.concatenate([body.mesh.inner, body.centre])
    region = (np.linalg.norm(centre, axis=1) > case.shells[0].radius) * (len(case.shells) - 1)
    light = StudyLight(np.repeat(case.irradiance(body.centre)[:, None], 3, axis=1), (0.0, 0.0, -1.0))
    answer = body.piecewise([[shell.medium] * 3 for shell in case.shells], region, ETA, light, scheme)
    exact = case.fluence(body.centre, scheme)
    area = body.area * (np.ones_like(exact) if body.mesh.face_kinds is None else body.mesh.face_kinds == meshes.OPEN)
    return relative_rms(area, (answer.phi[:, 0] - exact)[:, None], exact[:, None])


def fitted_order(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """Slope of log(error) over log(size)."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def study(body_of: BodyOf, case: OrdersBody, refinements: int, schemes: Sequence[Scheme]) -> dict[str, Any]:
    """Errors and fitted orders of one body over meshes of halving element size."""
    bodies = [body_of(case.mesh(n)) for n in range(refinements)]
    sizes = [0.5**n for n in range(refinements)]
    errors = {scheme.name: [surface_error(body, case, scheme) for body in bodies] for scheme in schemes}
    return {
        "case": case.name,
        "tets": [len(body.mesh.tets) for body in bodies],
        "errors": errors,
        "orders": {name: fitted_order(sizes, values) for name, values in errors.items()},
    }


def run(body_of: BodyOf) -> dict[str, Any]:
    """Every body with every scheme; the manufactured solution on the CPU, whose rows alone take a volume source."""
    return record_of([row for case in CASES for row in rows_of(case, body_of)])


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"eta": ETA, "cases": rows}


def rows_of(case: tuple[str, str], body_of: BodyOf) -> list[dict[str, Any]]:
    """Of a body and its methods.

    The graph methods, which do not converge and whose systems are slow to solve, do without the finest mesh.
    """
    if case == MANUFACTURED:
        return [manufactured_study(3)]
    name, methods = case
    refinements = (4 if name == "cylinder" else 3) - (methods == "graph")
    (body,) = (one for one in BODIES if one.name == name)
    return [study(body_of, body, refinements, METHODS[methods])]


def manufactured_study(refinements: int) -> dict[str, Any]:
    """Errors of fem over the volume for a solution with smooth coefficients, (Graph) -> error by model."""
    graphs = [meshes.ball(1.0, n) for n in range(refinements)]
    errors = {scheme.name: [manufactured.volume_error(graph, scheme.model, ETA) for graph in graphs] for scheme in FEM}
    sizes = [0.5**n for n in range(refinements)]
    return {
        "case": "manufactured",
        "tets": [len(graph.tets) for graph in graphs],
        "errors": errors,
        "orders": {name: fitted_order(sizes, values) for name, values in errors.items()},
    }


def tables(record: dict[str, Any]) -> list[Table]:
    """One table per case."""
    result = []
    for case in record["cases"]:
        columns = (f"{tets:,} tets" for tets in case["tets"])
        table = Table("method / source / model", *columns, "order", title=f"{case['case']}: relative L2 error of phi")
        for name, errors in case["errors"].items():
            table.add_row(name, *(f"{error:.3%}" for error in errors), f"{case['orders'][name]:.2f}")
        result.append(table)
    return result
