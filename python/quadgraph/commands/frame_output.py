"""Frames as numbered pictures and as films, by the names of outputs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from quadgraph.base.errors import InputError
from quadgraph.commands import picture_output
from quadgraph.file import film

if TYPE_CHECKING:
    import numpy as np

    from quadgraph.core import Picture


def check(path: Path, with_numbers: bool) -> None:
    """Raise InputError unless frames can be written to `path`."""
    numbered = "%" in path.name
    if numbered and not re.fullmatch(r"[^%]*%(0?[1-9])?d[^%]*", path.name):
        raise InputError(f"{path}: one number like %04d is allowed in a name, of at most 9 digits")
    if film.is_film(path):
        if not with_numbers:
            raise InputError(f"{path}: a film needs --frames")
        film.check(path)
    elif path.suffix.lower() not in picture_output.SUFFIXES:
        allowed = (*picture_output.SUFFIXES, *film.SUFFIXES)
        raise InputError(f"{path}: output must end in {', '.join(allowed[:-1])} or {allowed[-1]}")
    elif numbered != with_numbers:
        wanted = "a number, e.g. %04d, in the name of every frame" if with_numbers else "no number without --frames"
        raise InputError(f"{path}: {wanted} is wanted")


class Frames:
    """The outputs of a run, in a `with` block: films that are not finished in it leave nothing."""

    def __init__(self, outputs: Sequence[Path], size: tuple[int, int], rate: float) -> None:
        """size: width and height, pixels; rate: frames a second. Raises InputError where a film cannot be written."""
        self._outputs = outputs
        self._films: dict[Path, Any] = {}
        try:
            for path in filter(film.is_film, outputs):
                self._films[path] = film.open_film(path, size, rate)
        except BaseException:
            self._discard()
            raise

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Remove what is left of films that were not finished."""
        self._discard()

    def add(self, picture: Picture, frame: float, shown: picture_output.Shown) -> None:
        """Write one frame to all outputs. Raises InputError if it cannot be written."""
        for path in self._outputs:
            if path in self._films:
                self._films[path].add(shown.srgb(picture))
            else:
                _write(picture, path.with_name(path.name % int(frame)) if "%" in path.name else path, shown)

    def add_shown(self, srgb: np.ndarray) -> None:
        """Add one frame, (h, w, 3) as it is shown, to all films. Raises InputError if it cannot be written."""
        for each in self._films.values():
            each.add(srgb)

    def finish(self) -> None:
        """End the films and give them their names. Raises InputError if one cannot be written."""
        for each in self._films.values():
            each.finish()

    def _discard(self) -> None:
        for each in self._films.values():
            each.discard()


def _write(picture: Picture, path: Path, shown: picture_output.Shown) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path.parent}: cannot be made ({error.strerror})") from error
    picture_output.write(picture, path, shown)
