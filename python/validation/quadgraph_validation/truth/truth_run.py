"""Making truth images: round after round over all of them, so that each is usable early and Ctrl-C loses nothing."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import Progress, TaskID

from quadgraph.base.relative_error import relative_rms
from quadgraph.mesh import mesh_io
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies import scenes
from quadgraph_validation.bodies.scenes import PIXELS, Grid, StudyScene
from quadgraph_validation.truth import blocks, path_tracing, stored_truth
from quadgraph_validation.truth.path_tracing import BATCH, Tracer
from quadgraph_validation.truth.stored_truth import StoredTruth


@dataclass(frozen=True)
class TracedSubject:
    """A scene with its mesh read: what both path tracing and the engine start from.

    mesh: its file; grids: the coefficients by channel, one of a grey scene and three of a coloured one.
    """

    scene: StudyScene
    mesh: Path
    surface: Surface
    grids: tuple[Grid, ...]
    mesh_sha256: str

    def key(self, image: str) -> dict:
        """What one of the scene's images is cached under."""
        grid = self.grids[self.scene.images[image].channel]
        described = scenes.description(self.scene, image, self.mesh_sha256, grid)
        # Through JSON's types, so that a key that was written and read again is equal.
        return described | {"path_tracing": path_tracing.settings()}

    def path(self, folder: Path, image: str) -> Path:
        """Where one of the scene's images lies."""
        return folder / f"{self.scene.name}-{image}.npz"


def subject(scene: StudyScene, mesh: Path) -> TracedSubject:
    """Read the scene's mesh file and sample its coefficients. Raises InputError."""
    source = mesh_io.read_surface(mesh, height_mm=scene.height)
    surface = source.surface.rounded()
    channels = range(3 if scene.coloured else 1)
    return TracedSubject(
        scene, mesh, surface, tuple(scenes.grid_of(scene, surface, c) for c in channels), source.sha256
    )


def stored(found: TracedSubject, folder: Path, image: str) -> StoredTruth:
    """One of the scene's images (Scene.images) as far as it has come. Raises InputError if it is stale."""
    path, key = found.path(folder, image), found.key(image)
    return stored_truth.load(path, key) if path.exists() else StoredTruth.empty(key, PIXELS, PIXELS)


def noise(image: StoredTruth) -> tuple[float, float]:
    """Standard error of the means of blocks over their size: where the picture is bright, and wherever it is not black.

    Both root mean squares; bright as in `blocks`, without the engine's coverage.
    """
    values, errors = blocks.means(image.mean), blocks.errors(image.error)
    some = values > 0
    bright = values >= blocks.BRIGHT * np.quantile(values[some], 0.95)
    where_bright, over_all = (
        relative_rms(at.ravel(), errors.reshape(-1, 1), values.reshape(-1, 1)) for at in (bright, some)
    )
    return where_bright, over_all


def render(
    subjects: list[TracedSubject], folder: Path, samples: int, console: Console, images: Sequence[str] = ()
) -> None:
    """Bring every image to `samples` samples a pixel, those of views of more effort to as many times more.

    images: names of those that are wanted, none: all.

    Saved after every round of an image; KeyboardInterrupt passes through with every finished batch kept. Raises
    InputError if a stored image is stale or Mitsuba is absent.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rounds = -(-samples // BATCH)
    with ExitStack() as stack:
        stack.enter_context(_interruptible())
        progress = stack.enter_context(Progress(console=console))
        wanted = [(found, name) for found in subjects for name in found.scene.images if not images or name in images]
        jobs = [_job(stack, progress, found, folder, name, rounds) for found, name in wanted]
        for number in range(2, rounds + 1):
            for job in jobs:
                job.advance(number)


@dataclass(frozen=True)
class _Job:
    """One image at work."""

    image: StoredTruth
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
                stored_truth.save(self.path, self.image)


def _job(stack: ExitStack, progress: Progress, found: TracedSubject, folder: Path, name: str, rounds: int) -> _Job:
    image = found.scene.images[name]
    begun, effort = stored(found, folder, name), found.scene.views[image.view].effort
    tracer = stack.enter_context(
        path_tracing.tracer(found.scene, found.surface, found.grids[image.channel], image.view)
    )
    bar = progress.add_task(f"{found.scene.name} {name}", total=rounds * effort, completed=begun.batches)
    return _Job(begun, found.path(folder, name), tracer, effort, progress, bar)


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
