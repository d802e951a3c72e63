"""Radiance of slabs in ten bins of the outside cosine against exact transport and random walks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table

from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import exit_angles
from quadgraph_validation.truth.exit_angles import BIN_AREA, BINS
from quadgraph_validation.truth.fresnel import composite_gauss, entering_share, transmittance_from_outside
from quadgraph_validation.truth.schemes import DIFFUSION, SP3, Answer, BodyOf, Scheme, StudyBody, StudyLight
from quadgraph_validation.truth.slab_transport import radiance_by_angle

ALBEDOS = (0.999, 0.9, 0.5)  # one per channel
MEDIA = [Medium(albedo, 1 - albedo) for albedo in ALBEDOS]  # mean free path 1 mm
DEPTHS = (12.0, 2.0)  # mm
ETAS = (1.0, 1.3)
COSINES = (1.0, 0.3)  # of the light, outside
SIDES = ("lit", "unlit")
FINE, COARSE = 8, 1  # layers of elements to a mean free path
WALKS = (200_000, 400_000, 1_000_000)  # per albedo: the fewer collisions, the more
_PER_BIN, _AZIMUTHS = 3, 4


class RadianceCase(NamedTuple):
    """A slab `depth` mm thick and the light on it."""

    depth: float
    eta: float
    cosine: float


CASES = [RadianceCase(depth, eta, cosine) for eta in ETAS for depth in DEPTHS for cosine in COSINES]


@dataclass(frozen=True)
class Found:
    """What one side sends out in three channels: radiance (BINS, 3) per W/mm^2 that entered, and exitance (3,)."""

    radiance: np.ndarray
    exitance: np.ndarray

    @property
    def integral(self) -> np.ndarray:
        """Integral of the radiance over the hemisphere, as a share of the exitance (3,)."""
        return np.pi * BIN_AREA @ self.radiance / self.exitance


def column(body_of: BodyOf, depth: float, layers_per_mm: int) -> StudyBody:
    """A column of elements with reflecting walls: a slanted beam stands for itself and its mirror images."""
    thicknesses = np.full(round(depth * layers_per_mm), 1 / layers_per_mm)
    return body_of(meshes.column(thicknesses, 2 * thicknesses[0]))


def solved(body: StudyBody, case: RadianceCase, scheme: Scheme) -> Answer:
    """Light that enters uniformly at z = 0."""
    lit = body.normal[:, 2] < -0.5
    direction = (float(np.sqrt(1 - case.cosine**2)), 0.0, case.cosine)
    return body.homogeneous(MEDIA, case.eta, StudyLight(np.outer(lit, np.ones(3)), direction), scheme)


def gathered(body: StudyBody, case: RadianceCase, scheme: Scheme) -> list[Found]:
    """The lit and the unlit side; means over azimuths and the faces of the side."""
    answer = solved(body, case, scheme)
    cosine, weight = composite_gauss(_PER_BIN, BINS)
    azimuth = 2 * np.pi * (np.arange(_AZIMUTHS) + 0.25) / _AZIMUTHS
    sine = np.sqrt(1 - cosine**2)[:, None]
    along = np.stack(np.broadcast_arrays(sine * np.cos(azimuth), sine * np.sin(azimuth), cosine[:, None]), axis=-1)
    weight = (weight * cosine).reshape(BINS, _PER_BIN)
    result = []
    for outward in (-1.0, 1.0):
        faces = np.flatnonzero(body.normal[:, 2] * outward > 0.5)
        directions = (along * [1, 1, outward]).reshape(-1, 3)
        pairs = np.repeat(faces, len(directions)), np.tile(directions, (len(faces), 1))
        radiance = answer.leaving(*pairs).reshape(len(faces), BINS, _PER_BIN, _AZIMUTHS, 3).mean(axis=(0, 3))
        binned = (radiance * weight[:, :, None]).sum(axis=1) / weight.sum(axis=1)[:, None]
        result.append(Found(binned, body.mean(answer.exitance, np.isin(np.arange(len(body.area)), faces))))
    return result


def lambertian(found: Found, eta: float) -> np.ndarray:
    """The published angular distribution M F_t(mu) / integral, (BINS, 3)."""
    cosine, weight = composite_gauss(_PER_BIN, BINS)
    values = (transmittance_from_outside(cosine, eta) * weight * cosine).reshape(BINS, -1).sum(axis=1)
    shape = values / (weight * cosine).reshape(BINS, -1).sum(axis=1) / (np.pi * entering_share(True, eta))
    return np.outer(shape, found.exitance)


def run(body_of: BodyOf) -> dict[str, Any]:
    """Per slab, light, side and albedo: exact radiance, random walks, and relative errors of every scheme per bin."""
    return record_of([row for case in CASES for row in rows_of(case, body_of)])


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"albedos": ALBEDOS, "layers_per_mean_free_path": [FINE, COARSE], "walks": WALKS, "rows": rows}


def rows_of(numbers: tuple[float, float, float], body_of: BodyOf) -> list[dict[str, Any]]:
    """Of a case by its numbers, one for each albedo and side."""
    case = RadianceCase(*numbers)
    truth = [radiance_by_angle(medium, case.depth, case.eta, case.cosine) for medium in MEDIA]
    walks = [
        exit_angles.slab(medium, case.depth, case.eta, case.cosine, count, seed=1)
        for medium, count in zip(MEDIA, WALKS, strict=True)
    ]
    fine = column(body_of, case.depth, FINE)
    found = {
        "diffusion": gathered(fine, case, DIFFUSION),
        "SP3": gathered(fine, case, SP3),
        "SP3, coarse": gathered(column(body_of, case.depth, COARSE), case, SP3),
    }
    rows = []
    for channel, albedo in enumerate(ALBEDOS):
        estimates = walks[channel].lit, walks[channel].unlit
        for side, name in enumerate(SIDES):
            exact = truth[channel][side]
            exitance = np.pi * BIN_AREA @ exact
            rows.append(
                {
                    **case._asdict(),
                    "side": name,
                    "albedo": albedo,
                    "exitance": float(exitance),
                    "radiance": exact.tolist(),
                    "walks": (estimates[side].mean / exact - 1).tolist(),
                    "walks_error": (estimates[side].error / exact).tolist(),
                    "errors": _errors(found, side, channel, case.eta, exact),
                    "exitance_error": {
                        key: float(sides[side].exitance[channel] / exitance - 1) for key, sides in found.items()
                    },
                    "integral": {key: float(sides[side].integral[channel] - 1) for key, sides in found.items()},
                }
            )
    return rows


def _errors(
    found: dict[str, list[Found]], side: int, channel: int, eta: float, exact: np.ndarray
) -> dict[str, list[float]]:
    even = lambertian(found["SP3"][side], eta)[:, channel]
    radiance = {"Lambertian": even} | {key: sides[side].radiance[:, channel] for key, sides in found.items()}
    return {key: (values / exact - 1).tolist() for key, values in radiance.items()}


def tables(record: dict[str, Any]) -> list[Table]:
    """One table per index, side and light."""
    result = []
    for eta in ETAS:
        for side in SIDES:
            for cosine in COSINES:
                rows = [r for r in record["rows"] if (r["eta"], r["side"], r["cosine"]) == (eta, side, cosine)]
                result.append(_table(rows, f"eta {eta:g}, {side} side, light at cosine {cosine:g}"))
    return result


def _table(rows: list[dict[str, Any]], title: str) -> Table:
    table = Table(
        *("mean free paths", "albedo", "M", "", "ten bins, grazing to face on", "M off", "integral / M"),
        title=f"radiance, {title}: error in %",
    )
    for row in rows:
        head = f"{row['depth']:g}", f"{row['albedo']:g}", f"{row['exitance']:.2e}"
        for scheme, errors in row["errors"].items():
            ends = (f"{100 * row[key][scheme]:+.1f}" if scheme in row[key] else "" for key in _ENDS)
            table.add_row(*head, scheme, _percent(errors, "+.1f"), *ends)
            head = "", "", ""
        table.add_row(*head, "random walks", _percent(row["walks"], "+.1f"), "", "")
        table.add_row(*head, "their standard error", _percent(row["walks_error"], ".1f"), "", "", end_section=True)
    return table


_ENDS = ("exitance_error", "integral")


def _percent(values: list[float], form: str) -> str:
    return " ".join(f"{100 * value:{form}}" for value in values)
