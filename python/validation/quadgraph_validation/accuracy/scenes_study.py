"""Real bodies against path tracing: pictures of the published model and of the engine's, block by block."""

from __future__ import annotations

import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.table import Table

from quadgraph.baking import pipeline
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph_validation.base import store
from quadgraph_validation.bodies import scene_meshes, scenes
from quadgraph_validation.bodies.scenes import FOV, PIXELS, StudyScene
from quadgraph_validation.truth import blocks, truth_run
from quadgraph_validation.truth.path_tracing import BATCH
from quadgraph_validation.truth.stored_truth import StoredTruth
from quadgraph_validation.truth.truth_run import TracedSubject

if TYPE_CHECKING:
    from quadgraph.core import Engine

PARTS = ("all", "bright", "dark")
_FEW = 10  # blocks: a part with fewer is not printed


@dataclass(frozen=True)
class PictureSetting:
    """How the engine solves, always with `fem`, and shows a scene, by the names it uses; its default tolerance."""

    name: str
    source: str
    model: str
    radiance: str
    inter_reflection: bool
    tolerance: float = 1e-3
    correction: bool = False


PUBLISHED = PictureSetting("published, solved exactly", "diffuse", "diffusion", "lambertian", False, 1e-5)
OURS = PictureSetting("corrected, gathered, the default", "buried", "auto", "gathered", True, correction=True)
SETTINGS = (
    PUBLISHED,
    PictureSetting("diffusion, Lambertian", "buried", "diffusion", "lambertian", False),
    PictureSetting("SP3, gathered", "buried", "sp3", "gathered", False),
    PictureSetting("SP3, gathered, inter-reflection", "buried", "sp3", "gathered", True),
    OURS,
)
# In figures: title to setting.
SHOWN = {"published": PUBLISHED.name, "ours": OURS.name}


@dataclass(frozen=True)
class ScenesCompared:
    """One image: the truth, the coverage (h, w) of the engine's pixels, and its pictures (h, w) by setting's name."""

    image: StoredTruth
    alpha: np.ndarray
    pictures: dict[str, np.ndarray]


def run(
    device: str,
    meshes: Path,
    truths: Path,
    names: list[str],
    images: Path | None = None,
) -> dict[str, Any]:
    """Compare the scenes of the given names, all if there are none.

    meshes: folder of the mesh files; truths: folder of the path-traced pictures; images: folder for figures, none
    without it. Raises InputError.
    """
    record = {}
    for found in subjects(meshes, names):
        with Console(stderr=True).status(f"scene: {found.scene.name}"):
            compared = compare(found, stored(found, truths), device)
        record[found.scene.name] = {image: measured(one) for image, one in compared.items()}
        if images:
            from quadgraph_validation.accuracy import scene_figures

            scene_figures.write(figure_of(found.scene.name, images), found.scene, compared, SHOWN)
    return record_of(record)


def subjects(meshes: Path, names: list[str]) -> list[TracedSubject]:
    """The scenes of the given names, all if there are none. Raises InputError."""
    return [truth_run.subject(scene, scene_meshes.file(scene, meshes)) for scene in scenes.chosen(names)]


def stored(found: TracedSubject, truths: Path) -> dict[str, StoredTruth]:
    """A scene's path-traced pictures, by image. Raises InputError for one that is not there or stale."""
    return {image: _stored(found, truths, image) for image in found.scene.images}


def figure_of(name: str, images: Path) -> Path:
    """Where the figure of a scene goes."""
    return images / f"scenes-{name}.png"


def record_of(record: dict[str, Any]) -> dict[str, Any]:
    """The record of a run with what was found, by scene and image."""
    return {"block": blocks.BLOCK, "bright": blocks.BRIGHT, "scenes": record}


def compare(found: TracedSubject, stored: dict[str, StoredTruth], device: str = "") -> dict[str, ScenesCompared]:
    """Bake a scene's mesh, and solve and render it in every setting; by image."""
    with tempfile.TemporaryDirectory(prefix="quadgraph-study-") as folder:
        file = Path(folder) / "scene.qgraph"
        pipeline.bake(found.mesh, file, pipeline.BakeOptions(height_mm=found.scene.height))
        engine = load_core().Engine(file, device=device)
    set_scene(engine, found.scene)
    shown = {}
    for setting in SETTINGS:
        solve(engine, setting)
        shown[setting.name] = {name: picture(engine, found.scene, name, setting) for name in stored}
    return {
        name: ScenesCompared(image, shown[OURS.name][name][1], {key: value[name][0] for key, value in shown.items()})
        for name, image in stored.items()
    }


def set_scene(engine: Engine, scene: StudyScene) -> None:
    """Give the engine the coefficients, in the middle of every node, and the light."""
    for index, level in enumerate(engine.graph.levels):
        values = scene.in_channels(np.asarray(level.nodes, np.float64))
        scattering, absorption = (value.astype(np.float32) for value in values)
        engine.set_optical(index, scattering, absorption, scene.eta)
    engine.set_lights([scene.light])


def solve(engine: Engine, setting: PictureSetting) -> dict[str, Any]:
    """Solve; the engine's report. Raises SolverError."""
    return engine.solve(
        source=setting.source,
        model=setting.model,
        inter_reflection=setting.inter_reflection,
        tolerance=setting.tolerance,
        correction=setting.correction,
        max_iterations=100_000,
    )


def picture(engine: Engine, scene: StudyScene, image: str, setting: PictureSetting) -> tuple[np.ndarray, np.ndarray]:
    """Radiance of light that was in the body, W/(mm^2 sr), and coverage, both (h, w), after a solve; image: its name.

    Parallel light that crosses the body unscattered stays parallel: no camera sees it.
    """
    chosen = scene.images[image]
    found = engine.render(
        view=scene.views[chosen.view].text,
        vertical_fov=FOV,
        width=PIXELS,
        height=PIXELS,
        samples=4,
        radiance=setting.radiance,
        transmission_roughness=0,  # as the truth has it
    )
    shown = np.asarray(found.scattered, np.float64)[..., chosen.channel]
    if scene.direction is None:
        shown = shown + np.asarray(found.unscattered, np.float64)[..., chosen.channel]
    return shown, np.array(found.alpha, np.float64)


def measured(compared: ScenesCompared) -> dict[str, Any]:
    """What the record holds of an image: deviations by setting and part of the picture."""
    image = compared.image
    chosen = blocks.parts(image.mean, compared.alpha)
    deviations = {
        name: {part: asdict(blocks.deviation(shown, image.mean, image.error, chosen[part])) for part in PARTS}
        for name, shown in compared.pictures.items()
    }
    return {"samples": image.batches * BATCH, "truth": store.digest(image.key), "settings": deviations}


def tables(record: dict[str, Any]) -> list[Table]:
    """One table per scene."""
    return [_table(name, views) for name, views in record["scenes"].items()]


def _stored(found: TracedSubject, folder: Path, name: str) -> StoredTruth:
    image = truth_run.stored(found, folder, name)
    if image.batches < 2:
        command = f"quadgraph reference {found.scene.name} --kind transport --samples N"
        raise InputError(f"{found.path(folder, name)}: not there; '{command}' makes it with Mitsuba")
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
