"""Making truth images: round after round over all views, so that every one is usable early and Ctrl-C loses nothing."""

from __future__ import annotations

import signal
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from quadgraph import mesh_io
from quadgraph.reference import path_tracing, scenes, truth
from quadgraph.reference.path_tracing import BATCH
from quadgraph.reference.scenes import HEIGHT_MM, PIXELS, Grid, Scene
from quadgraph.reference.truth import Truth
from quadgraph.surface import Surface


@dataclass(frozen=True)
class Subject:
    """A scene with its mesh read: what both path tracing and the engine start from."""

    scene: Scene
    surface: Surface
    grid: Grid
    mesh_sha256: str

    def key(self, view: str) -> dict:
        """What the truth image of a view is cached under."""
        described = scenes.description(self.scene, view, self.mesh_sha256, self.grid)
        # Through JSON's types, so that a key that was written and read again is equal.
        return described | {"path_tracing": path_tracing.settings()}

    def path(self, folder: Path, view: str) -> Path:
        """Where the truth image of a view lies."""
        return folder / f"{self.scene.name}-{view}.npz"


def subject(scene: Scene, mesh: Path) -> Subject:
    """Read the scene's mesh and sample its coefficients. Raises InputError."""
    source = mesh_io.read_surface(mesh, height_mm=HEIGHT_MM)
    surface = source.surface.rounded()
    return Subject(scene, surface, scenes.grid_of(scene, surface), source.sha256)


def stored(found: Subject, folder: Path, view: str) -> Truth:
    """The truth image of a view as far as it has come. Raises InputError if it is stale."""
    path, key = found.path(folder, view), found.key(view)
    return truth.load(path, key) if path.exists() else Truth.empty(key, PIXELS, PIXELS)


def render(subjects: list[Subject], folder: Path, samples: int, console: Console) -> None:
    """Bring every view to `samples` samples a pixel, those of more effort to as many times more.

    Saved after every round of a view; KeyboardInterrupt passes through with every finished batch kept. Raises
    InputError if a stored image is stale or Mitsuba is absent.
    """
    # Interrupted, Mitsuba hands over half a picture, and without Python's handler (none in the background) it counts.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    folder.mkdir(parents=True, exist_ok=True)
    rounds = -(-samples // BATCH)
    todo = [(found, name, stored(found, folder, name)) for found in subjects for name in found.scene.views]
    with ExitStack() as stack, Progress(console=console) as progress:
        tracers = [
            stack.enter_context(path_tracing.tracer(found.scene, found.surface, found.grid, name))
            for found, name, _ in todo
        ]
        bars = [
            progress.add_task(
                f"{found.scene.name} {name}", total=rounds * found.scene.views[name].effort, completed=image.batches
            )
            for found, name, image in todo
        ]
        for number in range(2, rounds + 1):
            for (found, name, image), tracer, bar in zip(todo, tracers, bars, strict=True):
                goal = number * found.scene.views[name].effort
                if image.batches >= goal:
                    continue
                try:
                    while image.batches < goal:
                        image.add(tracer.batch(image.batches))
                        progress.update(bar, completed=image.batches)
                finally:
                    if image.batches > 1:
                        truth.save(found.path(folder, name), image)
