"""Real bodies against path tracing: pictures of the published model and of the engine's, block by block."""

from __future__ import annotations

import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.table import Table

from quadgraph import bake
from quadgraph.commands.scene import load_core
from quadgraph.errors import InputError
from quadgraph.reference import blocks, truth, truth_run
from quadgraph.reference.path_tracing import BATCH
from quadgraph.reference.scenes import FOV, HEIGHT_MM, PIXELS, SCENES, Scene
from quadgraph.reference.truth import Truth
from quadgraph.reference.truth_run import Subject

if TYPE_CHECKING:
    from quadgraph._core import Engine

PARTS = ("all", "bright", "dark")
_FEW = 10  # blocks: a part with fewer is not printed


@dataclass(frozen=True)
class Setting:
    """How the engine solves, always with `fem`, and shows a scene, by the names it uses; its default tolerance."""

    name: str
    source: str
    model: str
    radiance: str
    inter_reflection: bool
    tolerance: float = 1e-3


PUBLISHED = Setting("published, solved exactly", "diffuse", "diffusion", "lambertian", False, 1e-5)
OURS = Setting("SP3, gathered, inter-reflection", "buried", "sp3", "gathered", True)
SETTINGS = (
    PUBLISHED,
    Setting("diffusion, Lambertian", "buried", "diffusion", "lambertian", False),
    Setting("SP3, gathered", "buried", "sp3", "gathered", False),
    OURS,
)


@dataclass(frozen=True)
class Comparison:
    """One view: the truth, the coverage (h, w) of the engine's pixels, and its pictures (h, w) by setting's name."""

    image: Truth
    alpha: np.ndarray
    pictures: dict[str, np.ndarray]


def run(
    device: str,
    meshes: Path,
    truths: Path,
    names: list[str],
    samples: int | None = None,
    images: Path | None = None,
) -> dict[str, Any]:
    """Compare the scenes of the given names, all if there are none.

    meshes: folder of the mesh files; truths: folder of the path-traced pictures, brought to `samples` samples a pixel
    first if given; images: folder for figures, none without it. Raises InputError.
    """
    unknown = [name for name in names if name not in SCENES]
    if unknown:
        raise InputError(f"scene '{unknown[0]}': allowed are {', '.join(SCENES)}")
    subjects = [truth_run.subject(SCENES[name], meshes / SCENES[name].mesh) for name in names or SCENES]
    if samples:
        truth_run.render(subjects, truths, samples, Console(stderr=True))
    record = {}
    for found in subjects:
        stored = {view: _stored(found, truths, view) for view in found.scene.views}
        with Console(stderr=True).status(f"scene: {found.scene.name}"):
            compared = compare(found, meshes, stored, device)
        record[found.scene.name] = {view: measured(one) for view, one in compared.items()}
        if images:
            from quadgraph.reference import figures

            figures.write(images / f"scenes-{found.scene.name}.png", found.scene, compared, PUBLISHED.name, OURS.name)
    return {"block": blocks.BLOCK, "bright": blocks.BRIGHT, "scenes": record}


def compare(found: Subject, meshes: Path, stored: dict[str, Truth], device: str = "") -> dict[str, Comparison]:
    """Bake a scene's mesh, and solve and render it in every setting; by view."""
    with tempfile.TemporaryDirectory(prefix="quadgraph-study-") as folder:
        file = Path(folder) / "scene.qgraph"
        bake.bake(meshes / found.scene.mesh, file, bake.BakeOptions(height_mm=HEIGHT_MM))
        engine = load_core().Engine(file, device=device)
    set_scene(engine, found.scene)
    shown = {}
    for setting in SETTINGS:
        solve(engine, setting)
        shown[setting.name] = {name: picture(engine, found.scene, name, setting) for name in stored}
    return {
        name: Comparison(image, shown[OURS.name][name][1], {key: value[name][0] for key, value in shown.items()})
        for name, image in stored.items()
    }


def set_scene(engine: Engine, scene: Scene) -> None:
    """Give the engine the coefficients, in the middle of every node, and the light."""
    for index, level in enumerate(engine.graph.levels):
        values = scene.coefficients(np.asarray(level.nodes, np.float64))
        grey = (np.repeat(value[:, None], 3, axis=1).astype(np.float32) for value in values)
        engine.set_optical(index, *grey, scene.eta)
    engine.set_lights([scene.light])


def solve(engine: Engine, setting: Setting) -> dict[str, Any]:
    """Solve; the engine's report. Raises SolverError."""
    return engine.solve(
        source=setting.source,
        model=setting.model,
        inter_reflection=setting.inter_reflection,
        tolerance=setting.tolerance,
        max_iterations=100_000,
    )


def picture(engine: Engine, scene: Scene, view: str, setting: Setting) -> tuple[np.ndarray, np.ndarray]:
    """Radiance of light that was in the body, W/(mm^2 sr), and coverage, both (h, w), after a solve.

    Parallel light that crosses the body unscattered stays parallel: no camera sees it.
    """
    found = engine.render(
        view=scene.views[view].text, vertical_fov=FOV, width=PIXELS, height=PIXELS, radiance=setting.radiance
    )
    shown = np.asarray(found.scattered, np.float64)[..., 0]
    if scene.direction is None:
        shown = shown + np.asarray(found.unscattered, np.float64)[..., 0]
    return shown, np.array(found.alpha, np.float64)


def measured(compared: Comparison) -> dict[str, Any]:
    """What the record holds of a view: deviations by setting and part of the picture."""
    image = compared.image
    chosen = blocks.parts(image.mean, compared.alpha)
    deviations = {
        name: {part: asdict(blocks.deviation(shown, image.mean, image.error, chosen[part])) for part in PARTS}
        for name, shown in compared.pictures.items()
    }
    return {"samples": image.batches * BATCH, "truth": truth.digest(image.key), "settings": deviations}


def tables(record: dict[str, Any]) -> list[Table]:
    """One table per scene."""
    return [_table(name, views) for name, views in record["scenes"].items()]


def _stored(found: Subject, folder: Path, view: str) -> Truth:
    image = truth_run.stored(found, folder, view)
    if image.batches < 2:
        raise InputError(f"{found.path(folder, view)}: not there; --samples N makes it with Mitsuba")
    return image


def _table(name: str, views: dict[str, Any]) -> Table:
    table = Table("view", "setting", *PARTS, "mean", title=f"{name}: RMS of {blocks.BLOCK} x {blocks.BLOCK} blocks")
    for view, found in views.items():
        for setting, deviations in found["settings"].items():
            means = " / ".join(f"{deviations[p]['mean']:.3f}" for p in PARTS if deviations[p]["blocks"] >= _FEW)
            table.add_row(view, setting, *(_percent(deviations[part], "rms") for part in PARTS), means)
        noise = found["settings"][OURS.name]
        counts = " / ".join(str(noise[part]["blocks"]) for part in PARTS)
        row = [view, f"path tracing's noise, {found['samples']:,} samples"]
        table.add_row(*row, *(_percent(noise[part], "noise") for part in PARTS), f"{counts} blocks", end_section=True)
    return table


def _percent(deviation: dict[str, Any], field: str) -> str:
    return f"{100 * deviation[field]:.1f}%" if deviation["blocks"] >= _FEW else ""
