"""What `quadgraph acquire` finds in homogeneous bodies photographed by random walks, beside what is in them.

The twelve measured materials [Jensen et al. 2001], then random ones; each in a smooth body of 40 mm of its own, under
two wide lights seen from two sides, with the noise of a camera. Every body is recovered twice: with known gains, and
from photographs of which each has a gain of its own that nobody knows.
"""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from rich.table import Table

from quadgraph import core
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.homogeneous.fitting import Fit
from quadgraph.acquisition.model.prediction import NAMES
from quadgraph.acquisition.recovery import Recovered, recover
from quadgraph.api.materials import Material
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.mesh.surface import Surface
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.bodies import unseen_bodies
from quadgraph_validation.truth import photographed

LENGTH = 40.0  # mm, longest side
SIDE = 32  # pixels
GAINS = 0.2  # by how much unknown gains are off
PALE = 0.999  # albedo, above which an absorption need only lie within its own deviations
_PATHS = (5.0, 60.0)  # mean free paths across the longest side, of random materials
_ABSORBED = (3e-4, 0.3)  # share of extinction of the same
_ETA = (1.3, 1.5)
_CHANNELS = 0.4  # by how much the logarithms of a random material's channels differ
_WIDE = 4  # subdivisions of an icosahedron
_CAMERA = {"azimuth": 20, "elevation": 15, "fov": 24}


@dataclass(frozen=True)
class AcquireRun:
    """seed: of the first random body; count: of random bodies, after the measured materials; walks: of a pixel; device:
    as Engine takes it.
    """

    seed: int
    count: int
    walks: int
    device: str = ""


def run(wanted: AcquireRun, kept: KeptRows | None = None) -> dict[str, Any]:
    """Recover all, or what is not kept. Raises what bakes, walks and recoveries raise."""
    bodies = [(name, number, Material.parse(name)) for number, name in enumerate(measured())]
    seeds = range(wanted.seed, wanted.seed + wanted.count)
    bodies += [(f"seed {seed}", 1000 + seed, drawn(seed)) for seed in seeds]
    cases = ((name, partial(_row, number, material, wanted)) for name, number, material in bodies)
    return record_of(wanted, (kept or KeptRows()).complete(cases))


def record_of(wanted: AcquireRun, rows: list[Row]) -> dict[str, Any]:
    """What a run found."""
    return {"seed": wanted.seed, "walks": wanted.walks, "rows": rows, "summary": summary(rows)}


def measured() -> list[str]:
    """The names of the measured materials."""
    return [name for name in core.material_names() if core.material_source(name).startswith("measured")]


def drawn(seed: int) -> Material:
    """The random material of a seed."""
    random = np.random.default_rng([seed, 5])

    def between(ends: tuple[float, float]) -> np.ndarray:
        middle = random.uniform(*np.log(ends))
        return np.exp(np.clip(middle + random.uniform(-_CHANNELS, _CHANNELS, 3), *np.log(ends)))

    extinction, absorbed = between(_PATHS) / LENGTH, between(_ABSORBED)
    scattering, absorption = extinction * (1 - absorbed), extinction * absorbed
    return Material(_rounded(scattering), _rounded(absorption), round(random.uniform(*_ETA), 2))


def _rounded(values: np.ndarray) -> tuple[float, float, float]:
    red, green, blue = (float(f"{value:.4g}") for value in values)
    return red, green, blue


def body(seed: int) -> Surface:
    """A smooth body without symmetry, LENGTH long."""
    random = np.random.default_rng([seed, 6])
    ball = trimesh.creation.icosphere(_WIDE)
    waves = random.normal(size=(5, 3))
    bumps = np.sin(1.6 * ball.vertices @ waves.T + random.uniform(0, 6, 5)) @ random.uniform(0.03, 0.09, 5)
    vertices = ball.vertices * random.uniform(0.7, 1, 3) * (1 + bumps[:, None])
    return Surface(vertices * LENGTH / np.ptp(vertices, axis=0).max(), np.asarray(ball.faces)).rounded()


def _row(seed: int, material: Material, wanted: AcquireRun) -> Row:
    with tempfile.TemporaryDirectory(prefix="quadgraph-acquire-") as folder:
        return _recovered(seed, material, wanted, Path(folder))


def _recovered(seed: int, material: Material, wanted: AcquireRun, folder: Path) -> Row:
    unseen_bodies.write(folder / "body.ply", body(seed))
    bake(folder / "body.ply", folder / "body.qgraph", bake_options(material))
    (folder / "scene.json").write_text(json.dumps(_scene(material)))
    found = photographed.subject(folder / "scene.json")
    options = photographed.PhotographOptions(walks=wanted.walks, seed=seed + 1)
    cameras = photographed.views(found, options)
    radiances = photographed.by_walks(found, cameras, options, lambda share: None)
    row: Row = {"true": [_three(material.sigma_a), _three(material.sigma_s_prime)], "eta": material.eta}
    for kind, gains in (("known", 0.0), ("unknown", GAINS)):
        options = photographed.PhotographOptions(walks=wanted.walks, seed=seed + 1, gains=gains)
        photographed.write(folder / f"{kind}.json", found, cameras, photographed.taken(radiances, options), {})
        read = capture.read(folder / f"{kind}.json")
        row[kind] = _found(recover(read, True, None, lambda text: None, lambda share: None, wanted.device))
    return row


def bake_options(material: Material) -> BakeOptions:
    """Tets sized for the material, or by the shape where it absorbs nothing."""
    return BakeOptions(unit="mm", for_materials=(material.text,) if max(_three(material.sigma_a)) > 0 else ())


def _scene(material: Material) -> dict[str, Any]:
    """Lights as far from the body as they are wide, for that is how far the engine's own light is right."""
    return {
        "quadgraph_scene": 1,
        "body": "body.qgraph",
        "material": json.loads(core.material_json(material.text)),
        "lights": [
            {"type": "rectangle", "centre": [-96, 124, 124], "u": [144, 0, 80], "v": [32, -112, 96], "power": 120},
            {"type": "rectangle", "centre": [160, 14, -80], "u": [-72, 0, -120], "v": [0, -144, 0], "power": 100},
        ],
        "camera": _CAMERA,
        "picture": {"width": SIDE, "height": SIDE},
    }


def _three(value: Any) -> list[float]:
    return [float(each) for each in np.broadcast_to(value, 3)]


def _found(recovered: Recovered) -> dict[str, Any]:
    fit = recovered.fit
    assert isinstance(fit, Fit)  # homogeneous
    return {
        "coefficients": fit.coefficients.tolist(),
        "deviations": fit.deviations.tolist(),
        "chi_squared": fit.chi_squared.tolist(),
        "undetermined": recovered.undetermined,
        "findings": recovered.findings,
        "notes": recovered.notes,
    }


def off(row: Row, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """(2, 3) by how much sigma_a and sigma_s_prime are off, relative and in standard deviations of their logarithms;
    where the true one is 0, relative to sigma_s_prime and 0.
    """
    true, found = np.array(row["true"]), np.array(row[kind]["coefficients"])
    none = true == 0
    size = np.where(none, true[1], true)
    relative = found / size - 1 + none
    logs = np.log(np.where(none, 1, found) / np.where(none, 1, true))
    return relative, logs / np.maximum(row[kind]["deviations"], 1e-300)


def summary(rows: list[Row]) -> dict[str, Any]:
    """Of all channels of all rows, by kind of gains: the share within the goals, and within two deviations."""
    result: dict[str, Any] = {}
    for kind in ("known", "unknown"):
        relative, deviations = (np.stack(each) for each in zip(*(off(row, kind) for row in rows), strict=True))
        true = np.array([row["true"] for row in rows])
        pale = true[:, 1] > PALE * true.sum(axis=1)
        within = np.abs(deviations) <= 2
        absorption = (np.abs(relative[:, 0]) <= 0.10) | (pale & within[:, 0])
        result[kind] = {
            "sigma_s_prime_within_5_percent": float((np.abs(relative[:, 1]) <= 0.05).mean()),
            "sigma_a_within_10_percent_or_pale_and_two_deviations": float(absorption.mean()),
            "within_two_deviations": dict(zip(NAMES, within.mean(axis=(0, 2)).tolist(), strict=True)),
        }
    return result


def tables(record: dict[str, Any]) -> list[Table]:
    """Every body's errors, and how many are within what."""
    each = Table("material", "sigma_a off, %", "sigma_s' off, %", "gains unknown: sigma_a", "sigma_s'", "chi^2")
    for row in record["rows"]:
        cells = [_cell(row, kind, of) for kind in ("known", "unknown") for of in range(2)]
        each.add_row(row["name"], *cells, "/".join(f"{value:.2f}" for value in row["known"]["chi_squared"]))
    each.title = "recovered from walks, red/green/blue; in brackets: standard deviations off"
    shares = Table("gains", "sigma_s' within 5%", "sigma_a within 10%", "within two deviations: sigma_a", "sigma_s'")
    for kind, found in record["summary"].items():
        shares.add_row(kind, *(f"{share:.0%}" for share in _flat(found)))
    return [each, shares]


def _cell(row: dict[str, Any], kind: str, of: int) -> str:
    relative, deviations = (part[of] for part in off(row, kind))
    pairs = zip(relative, deviations, strict=True)
    return " / ".join(f"{100 * value:+.1f} ({number:+.1f})" for value, number in pairs)


def _flat(found: dict[str, Any]) -> list[float]:
    return [value for each in found.values() for value in (each.values() if isinstance(each, dict) else [each])]
