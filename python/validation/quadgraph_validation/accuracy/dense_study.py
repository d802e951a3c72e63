"""Dense materials: balls with edges of many mean free paths, against the same balls with sixteen times the faces."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from rich.table import Table
from scipy.spatial import cKDTree

from quadgraph.api.engine import Engine
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.relative_error import relative_rms
from quadgraph.mesh.patches import patches_of
from quadgraph.mesh.surface import Surface
from quadgraph_validation.accuracy.kept_rows import KeptRows, Row
from quadgraph_validation.bodies import unseen_bodies

LIGHT = "directional:0,0,-1:1"
DETAIL, FINER = 4, 6  # subdivisions of an icosahedron: 2,562 and 40,962 vertices
SHAKE = 0.11  # of an edge, by which vertices move on the sphere: no two faces are alike
BANDS = ((0, 60), (60, 75), (75, 84), (84, 90), (90, 96))  # degrees between a face's normal and the light
SWEEPS = 2  # of the finer ball
UNLIT = 0.1  # of the mean q: below it a patch is unlit, as a face is in the engine's report
TRUTH_BANDS = np.concatenate([np.arange(0, 80, 2), np.arange(80, 100, 0.5), np.arange(100, 181, 4)])


@dataclass(frozen=True)
class DenseBall:
    """radius: mm; seed: of the shake."""

    radius: float
    seed: int


CASES = (
    ("wholemilk", DenseBall(40, 3)),
    ("marble", DenseBall(40, 3)),
    ("spectralon", DenseBall(40, 3)),
    ("cream", DenseBall(30, 11)),
    ("skin1", DenseBall(60, 12)),
)


@dataclass(frozen=True)
class DenseRun:
    """device: as Engine takes it; baked: folder in which all balls are, by `bake_ball`; empty: they are to be baked."""

    device: str = ""
    baked: str = ""


def run(wanted: DenseRun, kept: KeptRows | None = None) -> dict[str, Any]:
    """What the default solve shows of each of CASES, or of what is not kept; the finer ball is smooth by angle."""
    with tempfile.TemporaryDirectory(prefix="quadgraph-dense-") as folder:

        @functools.cache
        def baked(ball: DenseBall, finer: bool) -> Path:
            return (file_of if wanted.baked else bake_ball)(ball, finer, Path(wanted.baked or folder))

        cases = [(case[0], functools.partial(_row, *case, baked, wanted.device)) for case in CASES]
        return record_of(wanted, (kept or KeptRows()).complete(cases))


def record_of(_wanted: DenseRun, rows: list[Row]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"light": LIGHT, "bands": BANDS, "rows": rows}


def surface_of(radius: float, detail: int, seed: int | None) -> Surface:
    """An icosphere, mm, shaken unless there is no seed."""
    mesh = trimesh.creation.icosphere(subdivisions=detail, radius=radius)
    vertices = np.array(mesh.vertices)
    if seed is not None:
        edge = np.linalg.norm(np.diff(vertices[mesh.edges_unique], axis=1), axis=2).mean()
        vertices += np.random.default_rng(seed).normal(0, SHAKE * edge, vertices.shape)
        vertices *= radius / np.linalg.norm(vertices, axis=1, keepdims=True)
    return Surface(vertices, np.array(mesh.faces, np.int64))


def file_of(ball: DenseBall, finer: bool, folder: Path) -> Path:
    """Where the baked ball, or the finer one, is in a folder."""
    return folder / f"{ball.radius:g}-{FINER if finer else DETAIL}.qgraph"


def bake_ball(ball: DenseBall, finer: bool, folder: Path) -> Path:
    """Bake the ball into a folder by the default bake, or the finer one without what a ball does not need; its file."""
    file = file_of(ball, finer, folder)
    if finer:
        surface, options = surface_of(ball.radius, FINER, None), BakeOptions(visibility_rays=0, interior="surface")
    else:
        surface, options = surface_of(ball.radius, DETAIL, ball.seed), BakeOptions()
    with tempfile.TemporaryDirectory(prefix="quadgraph-dense-") as place:
        mesh = Path(place) / f"{file.stem}.ply"
        unseen_bodies.write(mesh, surface)
        bake(mesh, file, replace(options, unit="mm"))
    return file


def _row(material: str, ball: DenseBall, baked: Callable[[DenseBall, bool], Path], device: str) -> Row:
    with Engine(baked(ball, True), device=device) as engine:
        engine.material, engine.lights = material, [LIGHT]
        engine.solve(sweeps=SWEEPS)
        field = engine.surface()
        angle, exitance = _angle(field.normal), np.asarray(field.exitance, np.float64)
    which = np.digitize(angle, TRUTH_BANDS)
    used = np.unique(which)
    middle = np.array([angle[which == k].mean() for k in used])
    mean = np.maximum([exitance[which == k].mean(axis=0) for k in used], 1e-12)
    with Engine(baked(ball, False), device=device) as engine:
        engine.material, engine.lights = material, [LIGHT]
        printed = engine.solve().error
        field = engine.surface()
    angle, exitance, area = _angle(field.normal), np.asarray(field.exitance, np.float64), np.asarray(field.area)
    # What light does not fall on shows how far it is from what it does fall on: a matter of place.
    place = _angle(field.position / np.linalg.norm(field.position, axis=1, keepdims=True))
    truth = np.stack([np.exp(np.interp(place, middle, np.log(column))) for column in mean.T], axis=1)
    patch = _patch_of(field.position, ball)
    whole, unlit = _by_patches(patch, area, exitance, truth, np.asarray(field.q))
    return {
        "material": material,
        "radius_mm": ball.radius,
        "scatter": [_scatter(angle, exitance, band) for band in BANDS],
        "bias": [_bias(angle, exitance, truth, band) for band in BANDS],
        "true": {"whole": whole, "unlit": unlit},
        "printed": None if printed is None else {"whole": printed.whole, "unlit": printed.unlit},
    }


def _patch_of(position: np.ndarray, ball: DenseBall) -> np.ndarray:
    """(n,) of each face, by the triangle of the mesh that is nearest: the bake puts faces in another order."""
    surface = surface_of(ball.radius, DETAIL, ball.seed)
    return patches_of(surface)[cKDTree(surface.corners.mean(axis=1)).query(position)[1]]


def _by_patches(
    patch: np.ndarray, area: np.ndarray, exitance: np.ndarray, truth: np.ndarray, q: np.ndarray
) -> tuple[float, float]:
    """Relative RMS error of means over patches, whole and unlit, as the engine states it."""
    size = np.bincount(patch, area)
    found, right, entered = (
        np.stack([np.bincount(patch, area * column) for column in of.T], axis=1) / size[:, None]
        for of in (exitance, truth, q)
    )
    unlit = size * (entered < UNLIT * (size @ entered) / size.sum()).all(axis=1)
    return relative_rms(size, found - right, right), relative_rms(unlit, found - right, right)


def _angle(normal: np.ndarray) -> np.ndarray:
    """Degrees between outward normals and the light."""
    return np.degrees(np.arccos(np.clip(np.asarray(normal)[:, 2], -1, 1)))


def _scatter(angle: np.ndarray, exitance: np.ndarray, band: tuple[float, float]) -> list[float]:
    """By channel, the RMS about a cubic of the angle, over the mean."""
    among = (angle >= band[0]) & (angle < band[1])
    powers = ((angle[among] - band[0]) / (band[1] - band[0]))[:, None] ** np.arange(4)
    values = exitance[among] / exitance[among].mean(axis=0)
    rest = values - powers @ np.linalg.lstsq(powers, values, rcond=None)[0]
    return np.sqrt((rest**2).mean(axis=0)).tolist()


def _bias(angle: np.ndarray, exitance: np.ndarray, truth: np.ndarray, band: tuple[float, float]) -> list[float]:
    """By channel, the mean over that of the truth, less 1."""
    among = (angle >= band[0]) & (angle < band[1])
    return (exitance[among].mean(axis=0) / truth[among].mean(axis=0) - 1).tolist()


def tables(record: dict[str, Any]) -> list[Table]:
    """Scatter from face to face and bias by band, R / G / B; true and printed errors."""
    bands = [f"{low} to {high}°" for low, high in record["bands"]]
    scatter = Table("ball", *bands, title="exitance of faces about a smooth curve of the angle, RMS in %")
    bias = Table(
        "ball", *bands, "whole, unlit", "printed", title="mean against that of 16 times the faces, %; error, %"
    )
    for row in record["rows"]:
        name = f"{row['material']}, {row['radius_mm']:g} mm"
        scatter.add_row(name, *(" / ".join(f"{100 * x:.1f}" for x in cell) for cell in row["scatter"]))
        errors = [
            "" if of is None else f"{100 * of['whole']:.1f}, {100 * of['unlit']:.1f}"
            for of in (row["true"], row["printed"])
        ]
        bias.add_row(name, *(" / ".join(f"{100 * x:+.1f}" for x in cell) for cell in row["bias"]), *errors)
    return [scatter, bias]
