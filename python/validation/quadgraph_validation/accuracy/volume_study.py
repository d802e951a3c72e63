"""What `quadgraph acquire --volume` finds in a block with two balls, beside what is in it and beside other schemes.

A block of 16 x 16 x 8 mm with a ball that absorbs four times as much and one that scatters twice as much, lit patch by
patch as by a projector and seen from the front and from the back. The engine photographs it on a mesh of its own, finer
than the one that the photographs are held against, with the noise of a camera. First the same block by every scheme;
then with the balls at growing depths; with gains that are not known; and draws: balls of random places, sizes and
contrasts, each with other noise.
"""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph import core
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.model.prediction import NAMES
from quadgraph.acquisition.recovery import recover
from quadgraph.acquisition.volume.volume_fit import VolumeFit
from quadgraph.acquisition.volume.volume_options import SCHEMES, VolumeOptions
from quadgraph.api.materials import Material, VolumeMaterial
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.mesh.surface import Surface
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.bodies import boxes, unseen_bodies
from quadgraph_validation.truth import photographed

SIDES = np.array([16, 16, 8])  # mm
SCATTERING, ABSORPTION = np.array([1.2, 1.0, 0.8]), np.array([0.01, 0.02, 0.03])  # 1/mm, of the block
ETA = 1.4
DEPTHS = (2.5, 3.0, 3.5, 4.0)  # mm, of the balls' middles below the front
NOISE = 0.003  # of a white pixel
GAINS = 0.2  # by how much unknown gains are off
_COARSE, _FINE = 2.0, 3.0  # faces a mm along an edge: of the mesh that is fitted on, and of the photographed one
_PATCHES = 4  # a side, each lit by a spot of its own
_SPOT = {"angle": 5.0, "edge": 1.0, "power": 100.0}
_SPOT_DISTANCE, _CAMERA_DISTANCE = 40.0, 60.0  # mm, from the front; from the middle
_PIXELS = 20
_SWEEP_POINTS = 640_000  # of the photographs' correction: its noise costs up to a fifth of a contrast
_CORE, _BESIDE = 0.65, 1.6  # radii of a ball: within, its own; beyond that of both, beside them
_OTHER_LIGHT = {"type": "rectangle", "centre": [0, 60, 60], "u": [60, 0, 0], "v": [0, -40, 40], "power": 100}
_OTHER_CAMERA = {"azimuth": 15, "elevation": 20}


@dataclass(frozen=True)
class Ball:
    """middle, mm; radius, mm; factor: how many times the coefficient of the block."""

    middle: tuple[float, float, float]
    radius: float
    factor: float


@dataclass(frozen=True)
class Block:
    """name; what absorbs more, and what scatters more; seed: of the noise; gains: by how much unknown ones are off."""

    name: str
    dark: Ball
    cloudy: Ball
    seed: int = 1
    gains: float = 0.0


@dataclass(frozen=True)
class VolumeRun:
    """seed: of the first draw; count: of draws; schemes: for the first block; device: as Engine takes it."""

    seed: int
    count: int
    schemes: tuple[str, ...] = SCHEMES
    device: str = ""


def at_depth(depth: float) -> Block:
    """The block with its two balls so far below the front."""
    z = SIDES[2] / 2 - depth
    return Block(f"{depth:g} mm deep", Ball((3.5, 0.5, z), 2.0, 4.0), Ball((-3.5, -0.5, z), 2.0, 2.0))


def drawn(seed: int) -> Block:
    """The block of a draw."""
    random = np.random.default_rng([seed, 9])
    balls = []
    for side, most in ((1, 4.0), (-1, 2.0)):
        radius, depth = random.uniform(1.6, 2.4), random.uniform(2.5, 3.5)
        middle = side * random.uniform(3, 4), random.uniform(-3, 3), SIDES[2] / 2 - depth
        balls.append(Ball(middle, radius, float(np.exp(random.uniform(0.4, 1) * np.log(most)))))
    return Block(f"draw {seed}", balls[0], balls[1], seed=1000 + seed)


def run(wanted: VolumeRun, kept: KeptRows | None = None) -> dict[str, Any]:
    """Recover all, or what is not kept. Raises what bakes, photographs and recoveries raise."""
    with tempfile.TemporaryDirectory(prefix="quadgraph-volume-") as name:
        folder = Path(name)
        for mesh, per_mm in (("body", _COARSE), ("finer", _FINE)):
            unseen_bodies.write(folder / f"{mesh}.ply", block(per_mm))
            bake(folder / f"{mesh}.ply", folder / f"{mesh}.qgraph", bake_options())
        cases = (
            (_name(case, scheme), partial(_row, case, scheme, folder, wanted.device)) for case, scheme in _cases(wanted)
        )
        return record_of(wanted, (kept or KeptRows()).complete(cases))


def record_of(wanted: VolumeRun, rows: list[Row]) -> dict[str, Any]:
    """What a run found."""
    return {"seed": wanted.seed, "rows": rows, "within_two_deviations": _within(rows)}


def bake_options() -> BakeOptions:
    """Tets sized for the block's material."""
    material = Material(tuple(SCATTERING.tolist()), tuple(ABSORPTION.tolist()), ETA)
    return BakeOptions(unit="mm", for_materials=(material.text,))


def _name(case: Block, scheme: str) -> str:
    return case.name if scheme == SCHEMES[0] else f"{case.name}, {scheme}"


def _cases(wanted: VolumeRun) -> Iterator[tuple[Block, str]]:
    first = at_depth(DEPTHS[0])
    for scheme in wanted.schemes:
        yield first, scheme
    for depth in DEPTHS[1:]:
        yield at_depth(depth), SCHEMES[0]
    yield replace(first, name="gains unknown", gains=GAINS), SCHEMES[0]
    for seed in range(wanted.seed, wanted.seed + wanted.count):
        yield drawn(seed), SCHEMES[0]


def block(per_mm: float) -> Surface:
    """A block around the origin, of so many pairs of triangles a mm along each edge."""
    return boxes.surface(SIDES, per_mm)


def truth(case: Block, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sigma_s_prime and sigma_a at points (n, 3), (n, 3) each, 1/mm."""
    dark, cloudy = (_distance(ball, points) < 1 for ball in (case.dark, case.cloudy))
    return (
        np.where(cloudy[:, None], case.cloudy.factor, 1) * SCATTERING,
        np.where(dark[:, None], case.dark.factor, 1) * ABSORPTION,
    )


def _distance(ball: Ball, points: np.ndarray) -> np.ndarray:
    """(n,) from a ball's middle, in radii."""
    return np.linalg.norm(points - np.array(ball.middle), axis=1) / ball.radius


def scene() -> dict[str, Any]:
    """Each patch of the front lit by a spot."""
    places = (np.arange(_PATCHES) + 0.5) / _PATCHES - 0.5
    front = float(SIDES[2] / 2 + _SPOT_DISTANCE)
    spots = [
        {"type": "spot", "position": [float(x * SIDES[0]), float(y * SIDES[1]), front], "direction": [0, 0, -1]} | _SPOT
        for y in places
        for x in places
    ]
    return {"quadgraph_scene": 1, "body": "../body.qgraph", "material": "truth.npz", "lights": spots}


def cameras() -> dict[str, dict[str, Any]]:
    """Of front and back."""
    fov = float(np.degrees(2 * np.arctan(0.56 * SIDES[0] / (_CAMERA_DISTANCE - SIDES[2] / 2))))
    common = {"look_at": [0, 0, 0], "up": "y", "fov": fov, "width": _PIXELS, "height": _PIXELS}
    return {name: {"eye": [0, 0, side * _CAMERA_DISTANCE]} | common for name, side in (("front", 1), ("back", -1))}


def _row(case: Block, scheme: str, folder: Path, device: str) -> Row:
    taken = folder / case.name
    if not taken.exists():
        taken.mkdir()
        _photograph(case, folder, taken, device)
    begun = time.process_time()
    quiet = (lambda text: None), (lambda share: None)
    recovered = recover(capture.read(taken / "capture.json"), True, VolumeOptions(scheme=scheme), *quiet, device)
    seconds = time.process_time() - begun
    recovered.material.save(taken / "found.npz")
    assert isinstance(recovered.fit, VolumeFit)
    return {
        "scheme": scheme,
        **judged(case, recovered.fit),
        "relighting": _relit(folder / "body.qgraph", taken, device),
        "chi_squared": recovered.fit.chi_squared.tolist(),
        "points": recovered.fit.grid.count,
        "seconds": seconds,
    }


def _photograph(case: Block, folder: Path, taken: Path, device: str) -> None:
    """Write a capture of a block, and what is in it."""
    box = np.stack([-SIDES, SIDES]) * 0.55
    material = VolumeMaterial.from_function(lambda points: truth(case, points), box, 0.25, ETA)
    material.save(taken / "truth.npz")
    (taken / "scene.json").write_text(json.dumps(scene()))
    found = photographed.subject(taken / "scene.json")
    options = photographed.PhotographOptions(noise=NOISE, seed=case.seed, gains=case.gains)
    body = folder / "finer.qgraph"
    radiances = photographed.by_engine(found, cameras(), body, device, lambda share: None, _SWEEP_POINTS)
    photographed.write(taken / "capture.json", found, cameras(), photographed.taken(radiances, options), {})


def judged(case: Block, fit: VolumeFit) -> Row:
    """Of sigma_a and sigma_s_prime, by channel: bias and RMS beside the balls, relative; contrast of the own ball,
    found over true; what is seen in the other ball, over the block; and the share within two deviations, if stated.
    """
    points = np.random.default_rng(1).uniform(-SIDES / 2, SIDES / 2, (40_000, 3))
    scattering, absorption = truth(case, points)
    dark, cloudy = (_distance(ball, points) for ball in (case.dark, case.cloudy))
    beside = np.minimum(dark, cloudy) > _BESIDE
    result = {}
    between = fit.grid.weights(points)
    balls = ((dark, cloudy, case.dark), (cloudy, dark, case.cloudy))
    for row, (name, true, (own, other, ball)) in enumerate(zip(NAMES, (absorption, scattering), balls, strict=True)):
        values = between @ fit.coefficients[row]
        off = np.log(values / true)
        block_mean = values[beside].mean(axis=0)
        contrast = values[own < _CORE].mean(axis=0) / block_mean - 1
        numbers: dict[str, Any] = {
            "bias": (block_mean / true[beside][0] - 1).tolist(),
            "rms": np.sqrt((off[beside] ** 2).mean(axis=0)).tolist(),
            "contrast": (contrast / (ball.factor - 1)).tolist(),
            "other_ball": (values[other < _CORE].mean(axis=0) / block_mean - 1).tolist(),
        }
        if fit.deviations is not None:
            within = np.abs(off) < 2 * (between @ fit.deviations[row])
            numbers["within_two_deviations"] = float(within.mean())
            numbers["within_two_deviations_beside"] = float(within[beside].mean())
        result[name] = numbers
    return result


def _relit(body: Path, taken: Path, device: str) -> float:
    """RMS between pictures of the found and of the true material under a light of no photograph, relative."""
    pictures = []
    for name in ("truth.npz", "found.npz"):
        stage = core.Stage(device)
        document: dict[str, Any] = {"body": str(body), "material": str(taken / name)}
        size = {"width": 96, "height": 96, "samples": 4}
        document |= {"lights": [_OTHER_LIGHT], "camera": _OTHER_CAMERA, "picture": size}
        stage.show(core.scene_file(json.dumps(document)).at(0))
        stage.solve()
        pictures.append(np.array(stage.render().scattered, np.float64))
    return float(np.sqrt(((pictures[1] - pictures[0]) ** 2).mean() / (pictures[0] ** 2).mean()))


def _within(rows: Sequence[Row]) -> dict[str, float]:
    """Of all draws, the share of places within two deviations."""
    draws = [row for row in rows if row["name"].startswith("draw")]
    if not draws:
        return {}
    return {name: float(np.mean([row[name]["within_two_deviations"] for row in draws])) for name in NAMES}


def tables(record: dict[str, Any]) -> list[Table]:
    """A row a block and scheme, red/green/blue."""
    table = Table(title="a block with two balls: sigma_a | sigma_s', red/green/blue")
    heads = ("block", "bias, %", "RMS, %", "contrast, of 1", "other ball, %", "within 2 deviations, %")
    for head in (*heads, "relighting, %", "CPU s"):
        table.add_column(head)
    for row in record["rows"]:
        of = [row[name] for name in NAMES]
        cells = [_cell([each[key] for each in of], scale) for key, scale in _SHOWN]
        shares = [
            f"{100 * each['within_two_deviations']:.0f}" if "within_two_deviations" in each else "-" for each in of
        ]
        table.add_row(
            row["name"],
            *cells,
            " | ".join(shares),
            f"{100 * row['relighting']:.2f}",
            f"{row['seconds']:.0f}",
        )
    return [table]


_SHOWN = (("bias", 100), ("rms", 100), ("contrast", 1), ("other_ball", 100))


def _cell(values: Sequence[Sequence[float]], scale: float) -> str:
    digits = 1 if scale > 1 else 2
    return " | ".join("/".join(f"{scale * each:+.{digits}f}" for each in part) for part in values)
