"""Films as .gif, by Pillow: 256 colours a frame, for ever from the beginning."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError

if TYPE_CHECKING:
    from PIL import Image

GIF = ".gif"
_MOST_RATE = 50.0  # frames a second: programs that show GIFs take shorter delays for long ones
_MOST_BYTES = 2_000_000_000  # of all frames, which wait in memory for the last


class GifFilm:
    """A film under a temporary name beside `path`, which it becomes when it is finished."""

    def __init__(self, path: Path, size: tuple[int, int], frames_per_second: float) -> None:
        """size: width and height, pixels. Raises InputError if there is no room or right to write."""
        if frames_per_second > _MOST_RATE:
            raise InputError(f"{path}: found {frames_per_second:g} frames a second, a .gif has at most {_MOST_RATE:g}")
        self.path = path
        self._rate = frames_per_second
        self._room = _MOST_BYTES // (size[0] * size[1])
        self._frames: list[Image.Image] = []
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, self._temporary = atomic_file.new_file(path, GIF)
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror})") from error
        os.close(handle)

    def add(self, srgb: np.ndarray) -> None:
        """Add a frame, (height, width, 3) uint8. Raises InputError if there are more than memory should hold."""
        from PIL import Image

        if len(self._frames) == self._room:
            raise InputError(f"{self.path}: a .gif of this size has room for {self._room} frames; write .mp4")
        frame = Image.fromarray(np.ascontiguousarray(srgb))
        self._frames.append(frame.quantize(256, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.FLOYDSTEINBERG))

    def finish(self) -> None:
        """Write the film and give it its name. Raises InputError if it cannot be written."""
        # Delays are hundredths of a second; rounded so that the whole takes as long as it should.
        ends = [round(100 * (number + 1) / self._rate) for number in range(len(self._frames))]
        delays = [10 * (end - start) for start, end in zip([0, *ends], ends, strict=False)]
        first, *others = self._frames
        encoded = io.BytesIO()  # into a file Pillow writes by itself, and does not see that there is no room
        first.save(encoded, "GIF", save_all=True, append_images=others, duration=delays, loop=0, disposal=1)
        try:
            self._temporary.write_bytes(encoded.getbuffer())
            self._temporary.replace(self.path)
        except OSError as error:
            raise InputError(f"{self.path}: cannot be written ({error.strerror})") from error
        atomic_file.discard(self._temporary)

    def discard(self) -> None:
        """Remove what is left of a film that was not finished."""
        atomic_file.discard(self._temporary)
