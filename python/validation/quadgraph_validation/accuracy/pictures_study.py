"""Pictures of bodies that nobody tuned for, beside random walks from the camera."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from quadgraph.api.engine import Engine
from quadgraph.api.lights import AmbientLight, RectangleLight
from quadgraph.api.options import Camera
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph_validation.accuracy import unseen_engine
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.base import extra_module
from quadgraph_validation.bodies import unseen_bodies, unseen_cases
from quadgraph_validation.bodies.smooth_sky import SmoothSky
from quadgraph_validation.bodies.unseen_cases import UnseenCase

PIXELS, BLOCK = 96, 4  # of a picture, and of what is compared, along a side
# Of a picture: the surface is as smooth for light that comes out as it is for the walks.
AS_WALKED: dict[str, Any] = {"width": PIXELS, "height": PIXELS, "transmission_roughness": 0}
FRAMES = 20  # in motion, before the picture that is judged
WAYS = ("rest", "motion", "uncorrected")
PARTS = ("whole", "dimmest")
TOLD = 0.05  # the truth's noise above which a part is not judged


@dataclass(frozen=True)
class PicturesRun:
    """seed: of the first body; count: of bodies; walks: of each pixel; device: as Engine takes it."""

    seed: int
    count: int
    walks: int
    device: str = ""


@dataclass(frozen=True, eq=False)
class Sight:
    """What is photographed, and from where: eye and look_at (3,) mm, fov: vertical, degrees."""

    case: UnseenCase
    eye: np.ndarray
    look_at: np.ndarray
    fov: float


def run(wanted: PicturesRun, kept: KeptRows | None = None) -> dict[str, Any]:
    """Judge all bodies, or what is not kept. Raises InputError, and what bakes and solves raise."""
    extra_module.load("numba", "walks")
    seeds = range(wanted.seed, wanted.seed + wanted.count)
    cases = [(str(seed), partial(_row, seed, wanted)) for seed in seeds]
    return record_of(wanted, (kept or KeptRows()).complete(cases))


def record_of(wanted: PicturesRun, rows: list[Row]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"seed": wanted.seed, "walks": wanted.walks, "pixels": PIXELS, "rows": rows, "summary": summary(rows)}


def drawn(seed: int) -> Sight:
    """A seed's body and material, in even light where the seed is even, else before a rectangle that faces it."""
    surface = unseen_bodies.surface_of(seed)
    generator = np.random.default_rng([seed, 4])
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    light = AmbientLight(1.0) if seed % 2 == 0 else _rectangle(generator, middle, radius)
    backward = generator.normal(size=3)
    backward *= np.array([1, 0.5, 1]) / np.linalg.norm(backward)  # rarely from straight above
    distance = 3.2 * radius
    eye = middle + distance * backward / np.linalg.norm(backward)
    case = unseen_cases.drawn(seed, surface)
    seen = UnseenCase(seed, surface, case.medium, light, case.size, case.albedo)
    return Sight(seen, eye, middle, float(2 * np.degrees(np.arcsin(radius / distance))))


def _rectangle(generator: np.random.Generator, middle: np.ndarray, radius: float) -> RectangleLight:
    """As large as the body or up to twice that, so that walks meet it; nowhere in the body."""
    towards = generator.normal(size=3)
    towards /= np.linalg.norm(towards)
    across = np.cross(towards, generator.normal(size=3))
    across /= np.linalg.norm(across)
    edges = generator.uniform(1, 2, 2)[:, None] * radius * np.stack([across, np.cross(towards, across)])
    distance = radius * generator.uniform(1.5, 2.5)
    vectors = (middle - distance * towards, *edges)
    centre, u, v = (_vector(np.array([float(f"{value:.6g}") for value in vector])) for vector in vectors)
    return RectangleLight(centre, u, v, float(f"{np.pi * (distance + radius) ** 2:.6g}"))


def _row(seed: int, wanted: PicturesRun) -> Row:
    sight = drawn(seed)
    case = sight.case
    truth, deviation = truth_of(sight, wanted.walks)
    found, covered, stated = _pictures(sight, wanted.device)
    inside = blocks(covered) > 0.999
    noise = np.sqrt(blocks(deviation**2)[inside]) / BLOCK
    wanted_blocks = blocks(truth)[inside]
    true = {way: errors(blocks(found[way])[inside], wanted_blocks, noise) for way in WAYS}
    return {
        "seed": case.seed,
        "light": "ambient" if isinstance(case.light, AmbientLight) else "rectangle",
        "kind": case.medium.kind,
        "eta": case.medium.eta,
        "size": case.size,
        "albedo": case.albedo,
        "blocks": int(inside.sum()),
        "noise": errors(wanted_blocks + noise, wanted_blocks, np.zeros_like(noise)),
        "true": true,
        "ratio": {way: float(blocks(found[way])[inside].sum() / wanted_blocks.sum()) for way in WAYS},
        "stated": stated,
    }


def truth_of(sight: Sight, walks: int) -> tuple[np.ndarray, np.ndarray]:
    """Radiance (h, w) of scattered light by so many walks a pixel, and its standard error."""
    from quadgraph_validation.truth import camera_walks, mesh_walk

    case = sight.case
    walker = camera_walks.CameraWalker(case.surface, [_document(case)])
    eye = camera_walks.Eye(sight.eye.copy(), sight.look_at.copy(), sight.fov, "y", PIXELS, PIXELS)
    volume = mesh_walk.volume_of(case.medium)
    truth = walker.see(eye, 0, volume, case.medium.eta, walks, case.seed, lambda _share: None)
    return truth.radiance[0], truth.noise[0]


def _document(case: UnseenCase) -> dict[str, Any]:
    """The light as scene files have it."""
    light = case.light
    if isinstance(light, AmbientLight):
        return {"type": "ambient", "irradiance": 1.0}
    assert isinstance(light, RectangleLight)
    return {"type": "rectangle", "centre": light.centre, "u": light.u, "v": light.v, "power": light.power}


def _pictures(sight: Sight, device: str) -> tuple[dict[str, np.ndarray], np.ndarray, dict[str, dict[str, float]]]:
    """Radiance (h, w) of scattered light in each way, coverage, and the error stated of it, where one is, by way."""
    case, light = sight.case, sight.case.light
    found: dict[str, np.ndarray] = {}
    stated: dict[str, dict[str, float]] = {}
    assert not isinstance(light, SmoothSky)
    with tempfile.TemporaryDirectory(prefix="quadgraph-pictures-") as name:
        mesh, file = Path(name) / "body.ply", Path(name) / "body.qgraph"
        unseen_bodies.write(mesh, case.surface)
        bake(mesh, file, BakeOptions(unit="mm"))
        with Engine(file, device=device) as engine:
            engine.material = unseen_engine.material_of(case.medium)
            engine.lights = [light]
            for way in WAYS:
                if way == "motion":
                    for _ in range(FRAMES):
                        engine.solve(motion=True)
                else:
                    engine.solve(correction=way == "rest")
                picture = engine.render(camera_of(sight), **AS_WALKED, samples=4)
                found[way] = picture.scattered[..., 0].astype(float)
                if picture.error is not None:
                    stated[way] = {part: getattr(picture.error, part) for part in PARTS}
    return found, picture.alpha.astype(float), stated


def camera_of(sight: Sight) -> Camera:
    """Where it is photographed from."""
    return {"eye": _vector(sight.eye), "look_at": _vector(sight.look_at), "fov": sight.fov, "up": "y"}


def _vector(place: np.ndarray) -> tuple[float, float, float]:
    x, y, z = map(float, place)
    return x, y, z


def blocks(picture: np.ndarray) -> np.ndarray:
    """Means over blocks of pixels, (h, w)."""
    height, width = (side // BLOCK for side in picture.shape)
    return picture.reshape(height, BLOCK, width, BLOCK).mean(axis=(1, 3))


def errors(found: np.ndarray, truth: np.ndarray, noise: np.ndarray) -> dict[str, float]:
    """Relative RMS over blocks (n,), without the truth's noise; of all, and of the third that `found` has dimmest."""
    order = np.argsort(found)
    parts = {"whole": order, "dimmest": order[: max(len(order) // 3, 1)]}
    return {name: _error(found[part], truth[part], noise[part]) for name, part in parts.items()}


def _error(found: np.ndarray, truth: np.ndarray, noise: np.ndarray) -> float:
    chance = float((noise**2).sum())
    size = float((truth**2).sum()) - chance
    return float(np.sqrt(max(((found - truth) ** 2).sum() - chance, 0) / size)) if size > 0 else 0.0


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """By way and part, of parts that the walks can tell: how many, and median, 90% and worst of the true errors.

    ratios: least, median and most of the stated error over the true one, of those whose true one is above half of the
    walks' noise.
    """
    found: dict[str, Any] = {}
    for way in WAYS:
        found[way] = {}
        for part in PARTS:
            told = [row for row in rows if row["noise"][part] < TOLD]
            true = [row["true"][way][part] for row in told]
            ratios = [
                row["stated"][way][part] / row["true"][way][part]
                for row in told
                if way in row["stated"] and row["true"][way][part] > row["noise"][part] / 2
            ]
            found[way][part] = {"cases": len(true), "errors": _at(true, 0.5, 0.9, 1), "ratios": _at(ratios, 0, 0.5, 1)}
    return found


def _at(values: list[float], *shares: float) -> list[float]:
    return np.quantile(values, shares).tolist() if values else []


def tables(record: dict[str, Any]) -> list[Table]:
    """Each body's errors, and all together."""
    columns = ("seed", "light", "material", "rest", "motion", "uncorrected", "noise", "stated")
    cases = Table(*columns, title="radiance, RMS of blocks: whole / dimmest third, %")
    for row in record["rows"]:
        material = f"{row['kind']}, eta {row['eta']:.2f}, {row['size']:.0f} mfp, {row['albedo']:.3f}"
        shown = [row["true"][way] for way in WAYS] + [row["noise"], row["stated"]["rest"]]
        cases.add_row(str(row["seed"]), row["light"], material, *map(_text, shown))
    together = Table("", "whole", "dimmest third", title="median / 90% / worst, %, where the walks can tell")
    ratios = Table("", "whole", "dimmest third", title="stated over true: least / median / most")
    for way, found in record["summary"].items():
        parts = [found[part] for part in PARTS]
        together.add_row(way, *(f"{_row_of(of['errors'], 100)} of {of['cases']}" for of in parts))
        if parts[0]["ratios"]:
            ratios.add_row(way, *(_row_of(of["ratios"]) for of in parts))
    return [cases, together, ratios]


def _row_of(values: list[float], times: float = 1) -> str:
    return " / ".join(f"{times * value:.1f}" for value in values)


def _text(of: dict[str, float]) -> str:
    return " / ".join(f"{100 * of[part]:.1f}" if part in of else "-" for part in PARTS)
