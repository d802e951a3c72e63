"""What is lost where paths end after a number of scatterings: half-spaces and slabs, by walks and closed forms."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import half_space_orders, monte_carlo
from quadgraph_validation.truth.schemes import BodyOf
from quadgraph_validation.truth.slab_transport import discrete_ordinates

MOST = 15  # scatterings of a path: the default of `omni:rtx:rtpt:maxVolumeBounces` of NVIDIA's RTX renderer
THICKNESSES = (3.0, 7.0, 14.0, np.inf)  # mean free paths, which are 1 mm here; inf: a half-space
ALBEDOS = (0.9, 0.99, 0.999, 0.9992)
ETAS = (1.0, 1.4)
CASES = tuple(itertools.product(THICKNESSES, ALBEDOS, ETAS))
WALKS = 400_000
SEED = 1
_FEWEST = 100  # walks that tell a share


def run(_body_of: BodyOf, walks: int = WALKS) -> dict[str, Any]:
    """Every albedo, thickness and index under light at normal incidence."""
    return record_of([row for case in CASES for row in rows_of(case, walks)], walks)


def record_of(rows: list[dict[str, Any]], walks: int = WALKS) -> dict[str, Any]:
    """The record of a run with these rows, with what is known without walks beside them."""
    told = [row | {"exact": _exact(row["thickness"], row["albedo"], row["eta"])} for row in rows]
    return {"walks": walks, "seed": SEED, "most": MOST, "rows": told}


def rows_of(case: tuple[float, float, float], walks: int = WALKS) -> list[dict[str, Any]]:
    """What was walked of a thickness, an albedo and an index."""
    thickness, albedo, eta = case
    found = monte_carlo.after_many(Medium(albedo, 1 - albedo), thickness, eta, MOST, walks, SEED)
    row: dict[str, Any] = {"thickness": None if np.isinf(thickness) else thickness, "albedo": albedo, "eta": eta}
    sides = ("reflectance", "transmittance")
    for side, share, late, error in zip(sides, found.mean[:2], found.mean[2:], found.error[:2], strict=True):
        row[side] = {"walked": float(share), "standard_error": float(error)} | _lost(share, late, walks)
    return [row]


def _lost(share: float, late: float, walks: int) -> dict[str, float]:
    """Of a share of the walks that part which came late, and its standard error; nothing where too few tell it."""
    if share * walks < _FEWEST:
        return {}
    lost = late / share
    return {"lost": float(lost), "lost_error": float(np.sqrt(lost * (1 - lost) / (share * walks)))}


def _exact(thickness: float | None, albedo: float, eta: float) -> dict[str, float]:
    """Without walks: of a slab by discrete ordinates, of an index-matched half-space by its H function."""
    medium = Medium(albedo, 1 - albedo)
    if thickness is not None:
        light = discrete_ordinates(medium, thickness, eta, lambertian=False)
        return {"reflectance": light.reflectance, "transmittance": light.transmittance}
    if eta != 1:
        return {}
    whole = half_space_orders.reflectance(medium.albedo)
    kept = half_space_orders.by_scatterings(MOST) @ medium.albedo ** np.arange(MOST + 1)
    return {"reflectance": whole, "lost": float(1 - kept / whole)}


def tables(record: dict[str, Any]) -> list[Table]:
    """One row per thickness and albedo, for each index the share that is lost of what is reflected and let through."""
    etas = sorted({row["eta"] for row in record["rows"]})
    of_eta = (f"eta {eta:g}: {side}" for eta in etas for side in ("R, lost of it", "T, lost of it"))
    table = Table(
        *("thickness, mean free paths", "albedo", *of_eta),
        title=f"paths that end after {record['most']} scatterings, light at normal incidence; in brackets closed forms",
    )
    for thickness, albedo in dict.fromkeys((row["thickness"], row["albedo"]) for row in record["rows"]):
        rows = [row for row in record["rows"] if (row["thickness"], row["albedo"]) == (thickness, albedo)]
        cells = [cell(row, side) for row in rows for side in ("reflectance", "transmittance")]
        table.add_row("half-space" if thickness is None else f"{thickness:g}", f"{albedo:g}", *cells)
    return [table]


def cell(row: dict[str, Any], side: str) -> str:
    """Reflectance or transmittance of a row, %, and how much of it the cut loses, %; of closed forms in brackets."""
    if "lost" not in row[side]:
        return "\N{EN DASH}"
    exact = row["exact"]
    share = f" ({100 * exact[side]:.3g})" if side in exact else ""
    lost = f" ({100 * exact['lost']:.3g})" if "lost" in exact else ""
    return f"{100 * row[side]['walked']:.3g}{share}, {100 * row[side]['lost']:.3g}{lost}"
