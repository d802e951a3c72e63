"""What `quadgraph acquire --volume` finds in a veined bunny photographed by random walks, by pictures in other light.

Sixteen wide lights all around, each alone, seen from six sides, with the noise of a camera and that of the walks. What
is found is judged by what the engine makes of it under lights that no photograph had, beside what it makes of the true
material; the same walks meet those lights, too.
"""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph import core
from quadgraph.acquisition.capture import capture
from quadgraph.acquisition.recovery import recover
from quadgraph.acquisition.volume.volume_options import VolumeOptions
from quadgraph.api.materials import Material, VolumeMaterial
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.bodies.bunny import bunny_mesh
from quadgraph_validation.truth import photographed
from quadgraph_validation.truth.photographed import PhotographOptions, Radiances, Subject

LENGTH = 40.0  # mm, longest side
VERTICES = 6000  # of the surface that the engine solves on
LIGHTS, HELD_OUT = 16, 4
VIEWS = 6
SIDE = 28  # pixels
NOISE = 0.01  # of a white pixel
ETA = 1.4
SCATTERING, ABSORPTION = np.array([1.0, 0.9, 0.8]), np.array([0.008, 0.016, 0.03])  # 1/mm, between the veins
IN_VEINS = 1.6, 4.0  # times as much of both, in their middle
_WIDTH = 2.5  # of a vein, mm, and its slopes
_FAR, _WIDE = 150.0, 120.0  # mm, of a light: from the middle; side
_RADIANCE = 1e-3  # W/(mm^2 sr)
_GRID = 0.5  # mm, of the true volume
_LIT = 0.2  # of the 95th percentile of what is seen: from there on a pixel is lit, and below of the far side


@dataclass(frozen=True)
class VeinedRun:
    """seed: of the first veins; count: of bodies; walks: of a pixel; device: as Engine takes it."""

    seed: int
    count: int
    walks: int
    device: str = ""


def run(wanted: VeinedRun, kept: KeptRows | None = None) -> dict[str, Any]:
    """Recover all, or what is not kept. Raises what bakes, walks and recoveries raise."""
    seeds = range(wanted.seed, wanted.seed + wanted.count)
    cases = ((f"veins {seed}", partial(_row, seed, wanted)) for seed in seeds)
    return record_of(wanted, (kept or KeptRows()).complete(cases))


def record_of(wanted: VeinedRun, rows: list[Row]) -> dict[str, Any]:
    """What a run found."""
    return {"seed": wanted.seed, "walks": wanted.walks, "rows": rows}


def veins(points: np.ndarray, seed: int) -> np.ndarray:
    """(n,) from 0 to 1 in the middle of a vein: around the zeros of a smooth random function, of points (n, 3) mm."""
    random = np.random.default_rng([seed, 21])
    waves = random.normal(size=(4, 3))
    waves *= 2 * np.pi / (LENGTH * random.uniform(0.5, 0.9, 4) * np.linalg.norm(waves, axis=1))[:, None]
    angles = points @ waves.T + random.uniform(0, 2 * np.pi, 4)
    value, slope = np.sin(angles).sum(axis=1), np.linalg.norm(np.cos(angles) @ waves, axis=1)
    return np.exp(-((value / np.maximum(slope, 0.05) / _WIDTH) ** 2))


def truth(points: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """sigma_s_prime and sigma_a at points (n, 3), (n, 3) each, 1/mm."""
    share = veins(np.asarray(points, np.float64), seed)[:, None]
    more_scattering, more_absorption = (times**share for times in IN_VEINS)
    return SCATTERING * more_scattering, ABSORPTION * more_absorption


def lights(middle: np.ndarray) -> list[dict[str, Any]]:
    """Wide ones around a point, evenly; after those that photographs have those that they have not, in between."""
    result = []
    for count, turn in ((LIGHTS, 0.0), (HELD_OUT, 6.1)):
        for k in range(count):
            height, angle = 1 - (2 * k + 1) / count, turn + 2.399963 * k
            flat = np.sqrt(1 - height**2)
            away = np.array([flat * np.cos(angle), height, flat * np.sin(angle)])
            u = np.cross([0.0, 1.0, 0.0], away)
            u /= np.linalg.norm(u)
            sides = [_WIDE * u, _WIDE * np.cross(-away, u)]
            places = [[round(float(x), 4) for x in each] for each in (middle + _FAR * away, *sides)]
            power = np.pi * _WIDE**2 * _RADIANCE
            result.append(dict(zip(("centre", "u", "v"), places, strict=True)) | {"type": "rectangle", "power": power})
    return result


def cameras(middle: np.ndarray, radius: float) -> dict[str, dict[str, Any]]:
    """From all around, by turns from above and from below."""
    fov = 24.0
    distance = 1.05 * radius / np.sin(np.radians(fov / 2))
    result = {}
    for k in range(VIEWS):
        way = photographed.backward(360 * k / VIEWS, 25.0 if k % 2 == 0 else -15.0, "y")
        places = {"eye": (middle + distance * way).round(4).tolist(), "look_at": middle.round(4).tolist()}
        result[f"view{k + 1}"] = places | {"up": "y", "fov": fov, "width": SIDE, "height": SIDE}
    return result


def _row(seed: int, wanted: VeinedRun) -> Row:
    with tempfile.TemporaryDirectory(prefix="quadgraph-veined-") as name:
        return _judged(seed, wanted, Path(name))


def _judged(seed: int, wanted: VeinedRun, folder: Path) -> Row:
    material = Material(_three(SCATTERING * IN_VEINS[0] ** 0.5), _three(ABSORPTION * IN_VEINS[1] ** 0.5), ETA)
    options = BakeOptions(longest_mm=LENGTH, surface_vertices=VERTICES, for_materials=(material.text,))
    bake(bunny_mesh(), folder / "body.qgraph", options)
    vertices = core.load(folder / "body.qgraph").display["vertices"]
    box = np.array([vertices.min(axis=0), vertices.max(axis=0)], np.float64)
    middle = box.mean(axis=0)
    radius = float(np.linalg.norm(vertices - middle, axis=1).max())
    around = box + np.array([[-1], [1]])
    VolumeMaterial.from_function(partial(truth, seed=seed), around, _GRID, ETA).save(folder / "truth.npz")
    scene = {"quadgraph_scene": 1, "body": "body.qgraph", "material": "truth.npz", "lights": lights(middle)}
    (folder / "scene.json").write_text(json.dumps(scene))
    found, views = photographed.subject(folder / "scene.json"), cameras(middle, radius)
    how = PhotographOptions(walks=wanted.walks, noise=NOISE, seed=seed)
    begun = time.process_time()
    seen = photographed.by_walks(found, views, how, lambda share: None)
    walked = time.process_time() - begun
    names = list(found.lights)
    photographs = photographed.taken({key: each for key, each in seen.items() if key[1] in names[:LIGHTS]}, how)
    photographed.write(folder / "capture.json", _with(found, names[:LIGHTS]), views, photographs, {})
    begun = time.process_time()
    quiet = (lambda text: None), (lambda share: None)
    recovered = recover(capture.read(folder / "capture.json"), True, VolumeOptions(), *quiet, wanted.device)
    seconds = time.process_time() - begun
    recovered.material.save(folder / "found.npz")
    others = _with(found, names[LIGHTS:])
    held_out = {key: each for key, each in seen.items() if key[1] in others.lights}
    errors = {}
    for kind in ("truth", "found"):
        scene_of = {**others.document, "material": str(folder / f"{kind}.npz")}
        pictures = photographed.by_engine(
            replace(others, document=scene_of), views, folder / "body.qgraph", wanted.device, lambda share: None
        )
        errors[kind] = differences(held_out, pictures)
    return {
        "held_out": errors,
        "noise": noise(held_out),
        "chi_squared": recovered.fit.chi_squared.tolist(),
        "seconds": {"walks": walked, "acquire": seconds},
    }


def _with(found: Subject, names: Sequence[str]) -> Subject:
    """The subject under some of its lights."""
    return replace(found, lights={name: found.lights[name] for name in names})


def _three(values: np.ndarray) -> tuple[float, float, float]:
    red, green, blue = (float(f"{value:.4g}") for value in values)
    return red, green, blue


def _parts(radiance: np.ndarray) -> dict[str, np.ndarray]:
    """Which values of a picture (h, w, 3) are lit, and which of the far side."""
    seen = radiance > 0
    bright = radiance >= _LIT * np.quantile(radiance[seen], 0.95)
    return {"lit": seen & bright, "far": seen & ~bright}


def _relative(squares: dict[str, list[float]], size: dict[str, list[float]]) -> dict[str, float]:
    return {part: float(np.sqrt(max(sum(squares[part]), 0) / sum(size[part]))) for part in squares}


def differences(true: Radiances, other: Radiances) -> dict[str, float]:
    """RMS of the differences over that of the truth, its noise taken away in quadrature; where pixels of both see the
    body.
    """
    squares: dict[str, list[float]] = {"lit": [], "far": []}
    size: dict[str, list[float]] = {"lit": [], "far": []}
    for key, (radiance, spread) in true.items():
        found = other[key][0]
        whole = (radiance > 0) & _inner(found[..., 0] > 0)[..., None]
        for part, chosen in _parts(radiance).items():
            at = chosen & whole
            squares[part].append(float(((found[at] - radiance[at]) ** 2 - spread[at] ** 2).sum()))
            size[part].append(float((radiance[at] ** 2).sum()))
    return _relative(squares, size)


def noise(true: Radiances) -> dict[str, float]:
    """RMS of the truth's own noise, over that of the truth."""
    squares: dict[str, list[float]] = {"lit": [], "far": []}
    size: dict[str, list[float]] = {"lit": [], "far": []}
    for radiance, spread in true.values():
        for part, at in _parts(radiance).items():
            squares[part].append(float((spread[at] ** 2).sum()))
            size[part].append(float((radiance[at] ** 2).sum()))
    return _relative(squares, size)


def _inner(covered: np.ndarray) -> np.ndarray:
    """Pixels whose neighbours are covered, too: the outline lies in none of them."""
    padded = np.pad(covered, 1)
    across = padded[:, :-2] & padded[:, 1:-1] & padded[:, 2:]
    return across[:-2] & across[1:-1] & across[2:]


def tables(record: dict[str, Any]) -> list[Table]:
    """A row a body."""
    table = Table(title=f"a veined bunny under {HELD_OUT} lights of no photograph, RMS of lit pixels and far side")
    for head in ("veins", "found, %", "the true material in the engine, %", "noise of the walks, %", "chi^2", "CPU s"):
        table.add_column(head)
    for row in record["rows"]:
        cells = [row["held_out"]["found"], row["held_out"]["truth"], row["noise"]]
        table.add_row(
            row["name"],
            *(f"{100 * each['lit']:.2f} / {100 * each['far']:.2f}" for each in cells),
            "/".join(f"{value:.2f}" for value in row["chi_squared"]),
            " + ".join(f"{value:.0f}" for value in row["seconds"].values()),
        )
    return [table]
