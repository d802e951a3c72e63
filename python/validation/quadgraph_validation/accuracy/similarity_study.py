"""What the similarity relation costs: balls of a medium that scatters forwards, and of the reduced one, by walks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.base.relative_error import relative_rms
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import monte_carlo
from quadgraph_validation.truth.schemes import BodyOf

# Radius in reduced mean free paths, which are 1 mm here, reduced albedo, and index.
CASES = (
    (1.5, 0.9, 1.0),
    (3.0, 0.6, 1.3),
    (3.0, 0.95, 1.4),
    (6.0, 0.95, 1.0),
    (6.0, 0.99, 1.4),
    (10.0, 0.8, 1.3),
    (10.0, 0.999, 1.4),
)
FORWARD = (0.5, 0.8, 0.9)  # g
ZONES = 16  # of equal area, half of them lit
PARTS = {"whole": slice(None), "lit": slice(ZONES // 2, None), "unlit": slice(ZONES // 2)}
WALKS = 200_000
SEED = 1


def exitance(medium: Medium, radius: float, eta: float, g: float, walks: int, seed: int) -> tuple[Any, Any]:
    """All light that leaves a ball in parallel light along -z, scattered or not, by zone: (ZONES,) of what entered, the
    unlit ones first, and the standard error of each.
    """
    exits = monte_carlo.through_sphere(medium, radius, eta, walks, np.random.default_rng(seed), g)
    edges = np.linspace(-1, 1, ZONES + 1)
    shares = np.histogram(exits.position[:, 2] / radius, edges)[0] / walks
    return shares, np.sqrt(shares * (1 - shares) / walks)


def run(_body_of: BodyOf, walks: int = WALKS) -> dict[str, Any]:
    """Every case with every g against the reduced medium, and one half-way to it with the same second moment [Joseph
    1976], each by other random numbers.
    """
    return record_of([row for case in CASES for row in rows_of(case, walks)], walks)


def record_of(rows: list[dict[str, Any]], walks: int = WALKS) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"walks": walks, "seed": SEED, "zones": ZONES, "rows": rows}


def rows_of(case: tuple[float, float, float], walks: int = WALKS) -> list[dict[str, Any]]:
    """Of a ball, one for each g."""
    radius, albedo, eta = case
    rows = []
    reduced, noise = exitance(Medium(albedo, 1 - albedo), radius, eta, 0.0, walks, SEED)
    for g in FORWARD:
        full = Medium(albedo / (1 - g), 1 - albedo)
        truth, error = exitance(full, radius, eta, g, walks, SEED + 1)
        less = g / (1 + g)
        delta, delta_noise = exitance(Medium(albedo / (1 - less), 1 - albedo), radius, eta, less, walks, SEED + 2)
        rows.append(
            {
                "radius": radius,
                "albedo": albedo,
                "eta": eta,
                "g": g,
                "power": float(reduced.sum() / truth.sum() - 1),
                "delta": apart(delta, truth, delta_noise, error),
                **{name: apart(reduced[part], truth[part], noise[part], error[part]) for name, part in PARTS.items()},
            }
        )
    return rows


def apart(found: np.ndarray, truth: np.ndarray, *noises: np.ndarray) -> dict[str, float]:
    """Relative RMS of the difference less the noise of both, in quadrature, and that noise."""
    even, of = np.ones(len(truth)), truth[:, None]
    noise = math.hypot(*(relative_rms(even, each[:, None], of) for each in noises))
    found_off = relative_rms(even, found[:, None] - of, of)
    return {"error": float(np.sqrt(max(found_off**2 - noise**2, 0.0))), "noise": noise}


def by_ball(rows: list[dict[str, Any]]) -> dict[tuple[float, float, float], list[dict[str, Any]]]:
    """Rows of each radius, albedo and index, by g."""
    found: dict[tuple[float, float, float], list[dict[str, Any]]] = {}
    for row in sorted(rows, key=lambda row: row["g"]):
        found.setdefault((row["radius"], row["albedo"], row["eta"]), []).append(row)
    return found


def tables(record: dict[str, Any]) -> list[Table]:
    """One row per ball, three columns per g."""
    forward = sorted({row["g"] for row in record["rows"]})
    of_g = (f"g {g:g}: whole / lit / unlit (power), delta" for g in forward)
    table = Table(
        *("radius, mean free paths", "albedo", "eta", *of_g),
        title="reduced scattering in place of forward scattering: exitance, error in %",
    )
    for ball, rows in by_ball(record["rows"]).items():
        cells = [
            " / ".join(f"{100 * row[part]['error']:.1f}" for part in ("whole", "lit", "unlit"))
            + f" ({100 * row['power']:+.1f}), {100 * row['delta']['error']:.1f}"
            for row in rows
        ]
        table.add_row(*(f"{number:g}" for number in ball), *cells)
    return [table]
