"""Where the fit of a volume stands between two of its outer steps, kept in a folder from which another run goes on."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quadgraph.acquisition.capture.capture import Capture
from quadgraph.base import atomic_file, regular_file
from quadgraph.base.errors import InputError
from quadgraph.base.version import __version__
from quadgraph.file import npz

_FILE = "acquire-state.npz"
_SHAPES: dict[str, tuple[int | str, ...]] = {
    "start": (2, 3),
    "gains": ("photographs", 3),
    "logs": (2, "points", 3),
    "told": (2, "points", 3),
    "smoothing": (),
    "enough": (),
    "outer": (),
    "smoothings": ("steps",),
    "chi_squared": ("steps", 3),
    "in_tiles": (3,),
    "local": (3,),
    "factors": ("squares", 3),
    "draw": (),
}


@dataclass(frozen=True, eq=False)
class FitState:
    """What a fit goes on from. start (2, 3): homogeneous coefficients, 1/mm; gains (p, 3) of the photographs; logs and
    told (2, n, 3): logarithms of the coefficients at the grid's points, and how much the photographs tell of each;
    smoothing: the last step's; enough (): 1 where less would explain little more; outer (): how many outer steps were
    made; smoothings (k,) and chi_squared (k, 3): of the steps so far; in_tiles and local (3,): sizes of the engine's
    error, as the weights have them; factors (m, 3) and draw (): what the engine's pictures are over the model, by
    square, and the last draw that is in them.
    """

    start: np.ndarray
    gains: np.ndarray
    logs: np.ndarray
    told: np.ndarray
    smoothing: np.ndarray
    enough: np.ndarray
    outer: np.ndarray
    smoothings: np.ndarray
    chi_squared: np.ndarray
    in_tiles: np.ndarray
    local: np.ndarray
    factors: np.ndarray
    draw: np.ndarray


class StateFolder:
    """A folder in which the state of one fit is kept."""

    def __init__(self, folder: Path, capture: Capture, options: str) -> None:
        """options: of the fit, beside the capture, its photographs and its body, which have to be the same for a state
        to be gone on from. Makes the folder. Raises InputError.
        """
        self._path = folder / _FILE
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{folder}: --resume: cannot be made a folder ({error.strerror}); name another") from error
        self._photographs = len(capture.photographs)
        digest = hashlib.sha256(f"{__version__} {options}".encode())
        for path in capture.files():
            digest.update(hashlib.sha256(regular_file.read_bytes(path)).digest())
        self._key = np.frombuffer(digest.digest(), np.uint8)

    def read(self) -> FitState | None:
        """The state that was kept last, None where there is none. Raises InputError for one of another fit, and for a
        file that is damaged.
        """
        if not self._path.exists():
            return None
        found = npz.read(self._path, ("key", *_SHAPES))
        if not np.array_equal(found.get("key", ()), self._key):
            raise InputError(
                f"{self._path}: key: found that of another capture, other photographs, options or version; remove the "
                "file, or give --resume another folder"
            )
        sizes: dict[int | str, int] = {"photographs": self._photographs}
        for name, shape in _SHAPES.items():
            if name not in found:
                raise InputError(f"{self._path}: {name}: is missing; remove the file to begin anew")
            values = found[name]
            if values.ndim == len(shape):
                for count, size in zip(shape, values.shape, strict=True):
                    sizes.setdefault(count, count if isinstance(count, int) else size)
            wanted = tuple(sizes.get(count, 0) for count in shape)
            if values.shape != wanted or values.dtype.kind not in "biuf" or not np.isfinite(values).all():
                raise InputError(
                    f"{self._path}: {name}: {values.dtype} of shape {values.shape} found, finite numbers of shape "
                    f"{wanted} wanted; remove the file to begin anew"
                )
        return FitState(**{name: found[name] for name in _SHAPES})

    def write(self, state: FitState) -> None:
        """Keep a state in the place of the last. Raises InputError if it cannot be written."""
        arrays = {name: getattr(state, name) for name in _SHAPES}
        with atomic_file.replacing(self._path) as stream:
            np.savez(stream, allow_pickle=False, key=self._key, **arrays)
