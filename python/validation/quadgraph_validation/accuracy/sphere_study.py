"""A sphere in parallel light: exitance by the angle from the light, against random walks."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from rich.table import Table
from scipy.special import eval_legendre

from quadgraph.base.relative_error import relative_rms
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import monte_carlo, round_bodies
from quadgraph_validation.truth.fresnel import transmittance_from_outside
from quadgraph_validation.truth.round_bodies import Shell
from quadgraph_validation.truth.schemes import DIFFUSION, PUBLISHED, SP3, BodyOf, Scheme, StudyBody, StudyLight

RADIUS = 10.0  # mm
MEDIUM = Medium(2.0, 0.01)
INDICES = (1.0, 1.3)
CASES = tuple(itertools.product(INDICES))
ZONES = 20  # of equal cos(theta), theta from the direction that the light comes from
WALKS = 4_000_000
SEED = 1
REFINEMENTS = (1, 2)
SCHEMES = (PUBLISHED, DIFFUSION, SP3)
_LEGENDRE = 60  # terms of the irradiance
_SAMPLES = 400 * ZONES  # of cos(theta)
_PARTS = 6  # of an edge: a face that straddles zones is shared between them


def by_zone(body: StudyBody, values: np.ndarray) -> np.ndarray:
    """Area-weighted mean (zones,) of values per face (n_f,)."""
    i, j = (part.ravel() for part in np.mgrid[:_PARTS, :_PARTS])
    inside = i + j < _PARTS
    a, b = (i[inside] + 1 / 3) / _PARTS, (j[inside] + 1 / 3) / _PARTS
    weights = np.column_stack([1 - a - b, a, b])
    points = np.einsum("pk,fki->fpi", weights, body.mesh.vertices[body.mesh.faces])
    cosine = points[..., 2] / np.linalg.norm(points, axis=2)
    zone = np.clip(((cosine + 1) / 2 * ZONES).astype(int), 0, ZONES - 1)
    area = np.broadcast_to(body.area[:, None], zone.shape)
    total = np.bincount(zone.ravel(), (area * values[:, None]).ravel(), ZONES)
    return total / np.bincount(zone.ravel(), area.ravel(), ZONES)


def exitance(body: StudyBody, eta: float, scheme: Scheme) -> np.ndarray:
    """Scattered exitance (zones,), W/mm^2, from the dark side to the lit one, in 1 W/mm^2 along -z."""
    cosine = np.clip(body.normal[:, 2], 0, 1)
    q = cosine * transmittance_from_outside(cosine, eta)
    light = StudyLight(np.repeat(q[:, None], 3, axis=1), (0.0, 0.0, -1.0))
    return by_zone(body, body.homogeneous([MEDIUM] * 3, eta, light, scheme).exitance[:, 0])


def published(eta: float) -> np.ndarray:
    """The published model's exitance (zones,) solved exactly, W/mm^2."""
    cosine = (np.arange(_SAMPLES) + 0.5) * 2 / _SAMPLES - 1
    clamped = np.clip(cosine, 0, 1)
    q = clamped * transmittance_from_outside(clamped, eta)
    coefficients = [(2 * order + 1) * np.mean(q * eval_legendre(order, cosine)) for order in range(_LEGENDRE)]
    condition = PUBLISHED.boundary(eta)
    shells, radius = [Shell(MEDIUM, RADIUS)], np.full(len(cosine), RADIUS)
    phi = round_bodies.sphere(shells, coefficients, PUBLISHED.model_of, condition, radius, cosine)[0]
    leaving = condition.matrix[0, 0] * phi - condition.reflected * q
    return leaving.reshape(ZONES, -1).mean(axis=1)


def halves(found: np.ndarray, truth: np.ndarray) -> tuple[float, float]:
    """Relative RMS errors over the lit and over the dark half."""
    lit = np.arange(ZONES) >= ZONES // 2
    over_lit, over_dark = (relative_rms(half, (found - truth)[:, None], truth[:, None]) for half in (lit, ~lit))
    return over_lit, over_dark


def run(body_of: BodyOf) -> dict[str, Any]:
    """Profiles of every scheme on every mesh, beside random walks and the published model solved exactly."""
    return record_of([row for case in CASES for row in rows_of(case, body_of)])


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"radius_mm": RADIUS, "walks": WALKS, "seed": SEED, "rows": rows}


def rows_of(case: tuple[float], body_of: BodyOf) -> list[dict[str, Any]]:
    """Of an index."""
    (eta,) = case
    truth = monte_carlo.sphere(MEDIUM, RADIUS, eta, ZONES, WALKS, SEED)
    profiles = [("published, exact", 0, published(eta))]
    for body in (body_of(meshes.ball(RADIUS, n)) for n in REFINEMENTS):
        profiles += [(scheme.name, len(body.mesh.vertices), exitance(body, eta, scheme)) for scheme in SCHEMES]
    return [
        {
            "eta": eta,
            "monte_carlo": truth.mean.tolist(),
            "standard_error": truth.error.tolist(),
            "noise": halves(truth.mean + truth.error, truth.mean),
            "profiles": [
                {"scheme": name, "vertices": count, "exitance": values.tolist(), "rms": halves(values, truth.mean)}
                for name, count, values in profiles
            ],
        }
    ]


def tables(record: dict[str, Any]) -> list[Table]:
    """Per index, the RMS errors and the profile on the finest mesh."""
    result = []
    for row in record["rows"]:
        errors = Table("scheme", "vertices", "lit half", "dark half", title=f"sphere, eta {row['eta']:g}: RMS error")
        for profile in row["profiles"]:
            vertices = f"{profile['vertices']:,}" if profile["vertices"] else ""
            errors.add_row(profile["scheme"], vertices, *(f"{100 * rms:.2f}%" for rms in profile["rms"]))
        errors.add_row("random walks, standard error", "", *(f"{100 * rms:.2f}%" for rms in row["noise"]))
        finest = [row["profiles"][0], *row["profiles"][-len(SCHEMES) :]]
        names = (profile["scheme"] for profile in finest)
        angles = Table("cos theta", "random walks", *names, title=f"sphere, eta {row['eta']:g}: exitance, error in %")
        for zone in reversed(range(ZONES)):
            truth = row["monte_carlo"][zone]
            angles.add_row(
                f"{2 * (zone + 0.5) / ZONES - 1:+.2f}",
                f"{truth:.5f} ± {row['standard_error'][zone]:.5f}",
                *(f"{100 * (profile['exitance'][zone] / truth - 1):+.1f}" for profile in finest),
            )
        result += [errors, angles]
    return result
