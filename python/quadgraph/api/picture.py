"""A rendered picture: its layers, and what becomes of them in a file."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from quadgraph import core
from quadgraph.api.colour_config import ColourConfig
from quadgraph.api.reprs import share
from quadgraph.api.solution import ErrorEstimate
from quadgraph.api.values import Floats, plain
from quadgraph.base import image_file
from quadgraph.base.errors import InputError


@dataclass(frozen=True)
class ConvergenceStep:
    """What a picture was after one more solve. solves: whose mean it is; sweeps: of the transport equation in each;
    points: at which the last of them evaluated it; samples: of a pixel; seconds: since the first step, which is the
    picture without convergence; error: that is stated of it, model and noise included; noise: of it, the standard error
    as a relative RMS over the pixels that the body covers, 0 where it is not known.
    """

    solves: int
    sweeps: int
    points: float
    samples: int
    seconds: float
    error: ErrorEstimate
    noise: float


@dataclass(frozen=True)
class Convergence:
    """How a picture came to the error that was asked for. wanted: that; reached: whether it did; out_of_time: whether a
    limit of time came first; least: what more solves and samples would leave of the error, 0 where it is not known;
    limit: why it was not reached and what helps, in words, or ""; steps: in their order.
    """

    wanted: float
    reached: bool
    out_of_time: bool
    least: float
    limit: str
    steps: tuple[ConvergenceStep, ...]

    @classmethod
    def from_report(cls, report: Mapping[str, Any]) -> Self:
        """Return it from the compiled engine's report."""
        steps = (ConvergenceStep(**(step | {"error": ErrorEstimate(**step["error"])})) for step in report["steps"])
        told = {each.name: report[each.name] for each in fields(cls)}
        return cls(**(told | {"steps": tuple(steps)}))


_TONE = {"background", "exposure", "tone", "white_balance"}


class Picture:
    """Linear radiance in W/(mm^2 sr), premultiplied by alpha, top row first; made by `Engine.render`.

    The layers scattered, specular and unscattered add up to what is seen. Arrays are read-only float32.
    """

    def __init__(self, layers: core.Picture, metadata: Sequence[tuple[str, str]], options: Mapping[str, Any]) -> None:
        """Keep the compiled engine's picture, what it was made with, and the picture options of a scene."""
        self._layers = layers
        self._metadata = list(metadata)
        self._options = dict(options)

    def __repr__(self) -> str:
        """Return its size, and what of it the body covers."""
        height, width = self.alpha.shape
        return f"Picture({width} x {height} pixels, {share(float(self.alpha.mean()))} of them the body)"

    @property
    def scattered(self) -> Floats:
        """(h, w, 3): light that was scattered in the body."""
        return self._layers.scattered

    @property
    def specular(self) -> Floats:
        """(h, w, 3): light that the surface reflected."""
        return self._layers.specular

    @property
    def unscattered(self) -> Floats:
        """(h, w, 3): light that crossed the body without being scattered."""
        return self._layers.unscattered

    @property
    def transmittance(self) -> Floats:
        """(h, w, 3): share of what is behind the body that is seen through it."""
        return self._layers.transmittance

    @property
    def alpha(self) -> Floats:
        """(h, w): share of the pixel that the body covers."""
        return self._layers.alpha

    @property
    def surroundings(self) -> Floats | None:
        """(h, w, 3): what is behind the body where environment lights are seen, else None."""
        return self._layers.surroundings

    @property
    def error(self) -> ErrorEstimate | None:
        """Relative RMS error of scattered light over pixels, channels together: of the whole picture, of what shows the
        unlit part of the surface, and of the third that is dimmest. None without a correction, and where radiance is
        not gathered along view rays. Estimated of the error of the solve, by the surface that each pixel shows, and of
        how much the radiance depends on the angle (docs/accuracy.md, "Pictures of unseen bodies").
        """
        error = self._layers.error
        return ErrorEstimate(**error) if error else None

    @property
    def standard_error(self) -> Floats | None:
        """(h, w, 3): of the sum of the layers, where the picture is the mean of several solves, else None."""
        return self._layers.standard_error

    @property
    def convergence(self) -> Convergence | None:
        """How the picture came to the error that `converge` asked for; None where it did not."""
        found = self._layers.convergence
        return Convergence.from_report(found) if found else None

    @property
    def metadata(self) -> dict[str, str]:
        """What the picture was made with, and how good its solve is."""
        return dict(self._metadata)

    def srgb(self, config: ColourConfig | None = None, **tone: Any) -> npt.NDArray[np.uint8]:
        """(h, w, 3) uint8 sRGB, tone mapped; with a config what its display is sent by its view. Raises InputError.

        `exposure`, `background`, `tone` and `white_balance` are as in `PictureOptions`.

        With the background "transparent" it is black where there is nothing, and (h, w, 4) with a config.
        """
        how = self._tone(tone)
        return config.shown(self._layers, how) if config else self._layers.srgb(how)

    def auto_exposure(self, **tone: Any) -> float:
        """Return the stops that the exposure "auto" comes to. tone: as in `srgb`. Raises InputError."""
        return self._layers.auto_exposure(self._tone(tone))

    def save(self, path: str | Path, config: ColourConfig | None = None, **tone: Any) -> None:
        """Write .png or .jpg (8 bits, as `srgb`) or .exr (float32, linear and not exposed, with layers) at once.

        With the background "transparent" a .png has an alpha channel, and a .jpg is refused. Raises InputError for
        that, for another ending, or if it cannot be written.
        """
        by_config = config is not None and Path(path).suffix.lower() != ".exr"
        if by_config or image_file.is_jpeg(Path(path)):
            options = json.loads(self._tone(tone))["picture"]
            if options.get("background") == "transparent":
                image_file.check_transparent(Path(path))
            image_file.write(Path(path), self.srgb(config, **tone), self._metadata)
            return
        writers = {".png": self._layers.write_png, ".exr": self._layers.write_exr}
        write = writers.get(Path(path).suffix.lower())
        if write is None:
            raise InputError(f"{path}: a picture must end in {', '.join(image_file.SUFFIXES)} or .exr")
        write(Path(path), self._metadata, self._tone(tone))

    def _tone(self, changes: Mapping[str, Any]) -> str:
        for name in changes.keys() - _TONE:
            raise InputError(f"{name}: not known; {', '.join(sorted(_TONE))} are")
        return json.dumps({"picture": self._options | {name: plain(value) for name, value in changes.items()}})

    def _repr_png_(self) -> bytes:
        """Show it in a notebook."""
        with tempfile.TemporaryDirectory() as folder:
            self.save(Path(folder) / "picture.png")
            return (Path(folder) / "picture.png").read_bytes()
