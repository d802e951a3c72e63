"""Reflectance and transmittance of slabs, 5 mm thick, against exact transport."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import CHANNELS, NAMES, Medium, media
from quadgraph_validation.truth import closed_forms
from quadgraph_validation.truth.schemes import DIFFUSION, PUBLISHED, SP3, BodyOf, Scheme, StudyBody, StudyLight
from quadgraph_validation.truth.slab_transport import SlabLight, discrete_ordinates, entry

THICKNESS = 5.0  # mm
LAYERS = 40  # of elements
SCHEMES = (PUBLISHED, DIFFUSION, SP3)
ETAS = (1.0, 1.3)
LIGHTS = ("collimated", "Lambertian")
CASES = tuple(itertools.product(NAMES))


def column(body_of: BodyOf, layers: int = LAYERS) -> StudyBody:
    """A column of `layers` layers of elements that stands for the infinite slab."""
    thicknesses = np.full(layers, THICKNESS / layers)
    return body_of(meshes.column(thicknesses, 2 * thicknesses[0]))


def solved(body: StudyBody, channels: list[Medium], eta: float, lambertian: bool, scheme: Scheme) -> list[SlabLight]:
    """What a column does, per channel, to light that entered at z = 0, collimated or Lambertian."""
    lit, unlit = body.normal[:, 2] < -0.5, body.normal[:, 2] > 0.5
    light = StudyLight(np.outer(lit, np.ones(3)), None if lambertian else (0.0, 0.0, 1.0))
    answer = body.homogeneous(channels, eta, light, scheme)
    entered = answer.energy["entered"]
    reflected, transmitted = body.mean(answer.exitance, lit), body.mean(answer.exitance, unlit)
    shares = reflected, transmitted, answer.energy["absorbed"] / entered, answer.energy["unscattered_out"] / entered
    return [SlabLight(*(float(share) for share in row)) for row in zip(*shares, strict=True)]


def relative_errors(found: SlabLight, truth: SlabLight) -> list[float]:
    """Relative errors of scattered reflectance and transmittance."""
    return [found.reflectance / truth.reflectance - 1, found.transmittance / truth.transmittance - 1]


def run(body_of: BodyOf) -> dict[str, Any]:
    """Truth and relative errors of R and T for every medium, channel, index and light."""
    return record_of([row for case in CASES for row in rows_of(case, body_of)])


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"thickness_mm": THICKNESS, "layers": LAYERS, "rows": rows}


def rows_of(case: tuple[str], body_of: BodyOf) -> list[dict[str, Any]]:
    """Of a medium, one for each index, light and channel."""
    (name,) = case
    body = column(body_of)
    rows = []
    for eta, light in itertools.product(ETAS, LIGHTS):
        lambertian = light == "Lambertian"
        found = {scheme: solved(body, media(name), eta, lambertian, scheme) for scheme in SCHEMES}
        for index, medium in enumerate(media(name)):
            truth = discrete_ordinates(medium, THICKNESS, eta, lambertian)
            errors = {"closed": relative_errors(_published(medium, eta), truth)}
            errors |= {scheme.name: relative_errors(found[scheme][index], truth) for scheme in SCHEMES}
            rows.append(
                {
                    "medium": f"{name} {CHANNELS[index]}",
                    "albedo": medium.albedo,
                    "eta": eta,
                    "light": light,
                    "reflectance": truth.reflectance,
                    "transmittance": truth.transmittance,
                    "errors": errors,
                }
            )
    return rows


def _published(medium: Medium, eta: float) -> SlabLight:
    return closed_forms.slab(medium, THICKNESS, PUBLISHED.model_of, PUBLISHED.boundary(eta))


def closed(medium: Medium, eta: float, lambertian: bool, scheme: Scheme) -> SlabLight:
    """The scheme's model solved exactly."""
    light = entry(lambertian, eta) if scheme.source == "buried" else None
    return closed_forms.slab(medium, THICKNESS, scheme.model_of, scheme.boundary(eta), eta, light)


def tables(record: dict[str, Any]) -> list[Table]:
    """One table per index and light."""
    result = []
    for eta, light in itertools.product(ETAS, LIGHTS):
        table = Table(
            *("medium", "albedo", "R", "T", "published, exact", PUBLISHED.method, "diffusion", "SP3"),
            title=f"slab, {record['thickness_mm']:g} mm, eta {eta:g}, {light}: error of R, T in %",
        )
        for row in record["rows"]:
            if (row["eta"], row["light"]) == (eta, light):
                errors = (f"{100 * r:+.2f} {100 * t:+.2f}" for r, t in row["errors"].values())
                table.add_row(
                    row["medium"],
                    f"{row['albedo']:.3f}",
                    f"{row['reflectance']:.5f}",
                    f"{row['transmittance']:.5f}",
                    *errors,
                )
        result.append(table)
    return result
