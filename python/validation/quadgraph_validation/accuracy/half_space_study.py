"""The response of a half-space to light patterns: M/q under q = cos(2 pi x / wavelength), collimated and normal."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.table import Table

from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import closed_forms, monte_carlo
from quadgraph_validation.truth.schemes import DIFFUSION, PUBLISHED, SP3, BodyOf, Scheme, StudyBody, StudyLight

# Of an index and an albedo, wavelengths in mean free paths, which are 1 mm here.
WAVELENGTHS = {
    (1.3, 0.999): (np.inf, 30.0, 10.0, 5.0, 3.0, 2.0),
    (1.3, 0.98): (np.inf, 30.0, 10.0, 5.0, 3.0),
    (1.3, 0.9): (np.inf, 30.0, 10.0, 5.0, 3.0),
    (1.3, 0.7): (np.inf, 30.0, 10.0, 5.0),
    (1.0, 0.9): (np.inf, 30.0, 10.0, 5.0, 3.0),
}
CASES = tuple(WAVELENGTHS)
ACROSS = 24  # cells along half a wavelength
WIDEST = 30.0  # mm, of a block under uniform light
WALKS = 1_000_000
SEED = 1


def medium_of(albedo: float) -> Medium:
    """A medium with a mean free path of 1 mm."""
    return Medium(albedo, 1 - albedo)


def block(body_of: BodyOf, medium: Medium, wavelength: float) -> StudyBody:
    """Half a period of the half-space, deep enough that nothing reaches the bottom."""
    width = min(wavelength, WIDEST)
    depth = 8 + 6 / max(medium.sigma_tr, 0.15)
    return body_of(meshes.half_period(width, ACROSS, meshes.graded(width / ACROSS / 4, 1.15, depth)))


def response(body: StudyBody, medium: Medium, eta: float, wavelength: float, scheme: Scheme) -> tuple[float, float]:
    """M/q of a block, and its least exitance, W/mm^2, under q = 1 + cos(2 pi x / wavelength), which is never negative.

    M/q is the share of the exitance that follows the cosine.
    """
    lit = body.normal[:, 2] < -0.5
    wave = np.cos(2 * np.pi * body.centre[:, 0] / wavelength)
    light = StudyLight(np.outer(np.where(lit, 1 + wave, 0), np.ones(3)), (0.0, 0.0, 1.0))
    exitance = body.homogeneous([medium] * 3, eta, light, scheme).exitance[:, 0]
    weight = body.area * lit * wave
    share = 2 if np.isinf(wavelength) else 1  # without a wave, 1 + cos is 2 all over
    return float(weight @ exitance / (weight @ wave)) / share, float(exitance[lit].min())


def run(body_of: BodyOf) -> dict[str, Any]:
    """Random walks, the published condition solved exactly, and the mesh with either model."""
    return record_of([row for case in CASES for row in rows_of(case, body_of)])


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"walks": WALKS, "seed": SEED, "across": ACROSS, "rows": rows}


def rows_of(case: tuple[float, float], body_of: BodyOf) -> list[dict[str, Any]]:
    """Of an index and an albedo, one for each wavelength; walks serve them all."""
    eta, albedo = case
    medium, wavelengths = medium_of(albedo), np.array(WAVELENGTHS[case])
    walked = monte_carlo.half_space(medium, eta, wavelengths, WALKS, SEED)
    published = closed_forms.half_space_response(
        medium, wavelengths, PUBLISHED.model_of, PUBLISHED.boundary(eta), buried=False
    )
    rows = []
    for index, wavelength in enumerate(wavelengths.tolist()):
        body = block(body_of, medium, wavelength)
        found = {scheme.model: response(body, medium, eta, wavelength, scheme) for scheme in (DIFFUSION, SP3)}
        rows.append(
            {
                "eta": eta,
                "albedo": albedo,
                "wavelength": None if np.isinf(wavelength) else wavelength,
                "monte_carlo": float(walked.mean[index]),
                "standard_error": float(walked.error[index]),
                "published": float(published[index]),
                "diffusion": found["diffusion"][0],
                "sp3": found["sp3"][0],
                "least_exitance": min(least for _, least in found.values()),
            }
        )
    return rows


def tables(record: dict[str, Any]) -> list[Table]:
    """One row per index, albedo and wavelength."""
    table = Table(
        *("eta", "albedo", "wavelength", "random walks", "published, exact", "diffusion", "SP3"),
        title="half-space: M/q (error in %), wavelengths in mean free paths",
    )
    for row in record["rows"]:
        truth = row["monte_carlo"]
        table.add_row(
            f"{row['eta']:g}",
            f"{row['albedo']:g}",
            "uniform" if row["wavelength"] is None else f"{row['wavelength']:g}",
            f"{truth:.4f} ± {row['standard_error']:.4f}",
            *(f"{row[name]:.3f} ({100 * (row[name] / truth - 1):+.1f})" for name in ("published", "diffusion", "sp3")),
        )
    return [table]
