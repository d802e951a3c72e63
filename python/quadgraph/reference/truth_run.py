"""Making truth images: round after round over all views, so that every one is usable early and Ctrl-C loses nothing."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import Progress, TaskID

from quadgraph import mesh_io
from quadgraph.reference import path_tracing, scenes, truth
from quadgraph.reference.path_tracing import BATCH, Tracer
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
    folder.mkdir(parents=True, exist_ok=True)
    rounds = -(-samples // BATCH)
    with ExitStack() as stack:
        stack.enter_context(_interruptible())
        progress = stack.enter_context(Progress(console=console))
        jobs = [_job(stack, progress, found, folder, name, rounds) for found in subjects for name in found.scene.views]
        for number in range(2, rounds + 1):
            for job in jobs:
                job.advance(number)


@dataclass(frozen=True)
class _Job:
    """One view at work."""

    image: Truth
    path: Path
    tracer: Tracer
    effort: int
    progress: Progress
    bar: TaskID

    def advance(self, rounds: int) -> None:
        """Go on until so many rounds are done, and save."""
        goal = rounds * self.effort
        if self.image.batches >= goal:
            return
        try:
            while self.image.batches < goal:
                self.image.add(self.tracer.batch(self.image.batches))
                self.progress.update(self.bar, completed=self.image.batches)
        finally:
            if self.image.batches > 1:
                truth.save(self.path, self.image)


def _job(stack: ExitStack, progress: Progress, found: Subject, folder: Path, name: str, rounds: int) -> _Job:
    image, effort = stored(found, folder, name), found.scene.views[name].effort
    tracer = stack.enter_context(path_tracing.tracer(found.scene, found.surface, found.grid, name))
    bar = progress.add_task(f"{found.scene.name} {name}", total=rounds * effort, completed=image.batches)
    return _Job(image, found.path(folder, name), tracer, effort, progress, bar)


@contextmanager
def _interruptible() -> Iterator[None]:
    """Have Python's handler of Ctrl-C: Mitsuba hands over half a picture, and without it, as in the background, that
    would count.
    """
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
