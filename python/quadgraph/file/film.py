"""Films of rendered frames, encoded by PyAV (H.264 in .mp4, VP9 in .webm) or Pillow (.gif)."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError
from quadgraph.file.gif_film import GIF, GifFilm

if TYPE_CHECKING:
    from av.video.stream import VideoStream

_CODECS = {".mp4": "libx264", ".webm": "libvpx-vp9"}
SUFFIXES = (*_CODECS, GIF)


def is_film(path: Path) -> bool:
    """Whether a file is to be a film, by its name."""
    return path.suffix.lower() in SUFFIXES


def check(path: Path) -> None:
    """Raise InputError if a film of that name cannot be encoded here."""
    if path.suffix.lower() in _CODECS and importlib.util.find_spec("av") is None:
        raise InputError(
            f"{path}: needs PyAV: pip install 'quadgraph[film]', or write {path.stem}.gif or frames/%04d.png"
        )


def open_film(path: Path, size: tuple[int, int], frames_per_second: float) -> Film | GifFilm:
    """A film of the kind that its name says; size: width and height, pixels. Raises InputError as both kinds do."""
    return (GifFilm if path.suffix.lower() == GIF else Film)(path, size, frames_per_second)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Let what cannot be written, or encoded, be an InputError."""
    import av

    try:
        yield
    except (OSError, av.FFmpegError) as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error


class Film:
    """A film under a temporary name beside `path`, which it becomes when it is finished."""

    def __init__(self, path: Path, size: tuple[int, int], frames_per_second: float) -> None:
        """size: width and height, pixels, both even. Raises InputError if there is no room or right to write."""
        import av

        if size[0] % 2 or size[1] % 2:
            raise InputError(f"{path}: a film needs an even width and height, found {size[0]}x{size[1]}")
        self.path = path
        with _writing(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, self._temporary = atomic_file.new_file(path, path.suffix.lower())
            os.close(handle)
            self._container = av.open(self._temporary, "w")
        rate = Fraction(frames_per_second).limit_denominator(1001)
        stream = self._container.add_stream(_CODECS[path.suffix.lower()], rate=rate, options={"crf": "18"})
        self._stream = cast("VideoStream", stream)
        self._stream.width, self._stream.height = size
        self._stream.pix_fmt = "yuv420p"

    def add(self, srgb: np.ndarray) -> None:
        """Add a frame, (height, width, 3) uint8. Raises InputError if it cannot be written."""
        import av

        with _writing(self.path):
            for packet in self._stream.encode(av.VideoFrame.from_ndarray(srgb, format="rgb24")):
                self._container.mux(packet)

    def finish(self) -> None:
        """End the film and give it its name. Raises InputError if it cannot be written."""
        with _writing(self.path):
            for packet in self._stream.encode():
                self._container.mux(packet)
            self._container.close()
            self._temporary.replace(self.path)
        atomic_file.discard(self._temporary)

    def discard(self) -> None:
        """Remove what is left of a film that was not finished."""
        with suppress(InputError), _writing(self.path):
            self._container.close()
        atomic_file.discard(self._temporary)
