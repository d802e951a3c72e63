"""Path-traced pictures on disk: mean and standard error of a pixel, under a key of everything that enters them."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from quadgraph import atomic_file
from quadgraph.errors import InputError


@dataclass
class Truth:
    """Batches of equal size added up: `total` and `squares` (h, w) float64 are the sums of their means and of the
    squares of these, W/(mm^2 sr).
    """

    key: dict[str, Any]
    batches: int
    total: np.ndarray
    squares: np.ndarray

    @classmethod
    def empty(cls, key: dict[str, Any], height: int, width: int) -> Truth:
        """Nothing yet."""
        return cls(key, 0, np.zeros((height, width)), np.zeros((height, width)))

    @property
    def mean(self) -> np.ndarray:
        """(h, w) radiance, W/(mm^2 sr)."""
        return self.total / self.batches

    @property
    def error(self) -> np.ndarray:
        """(h, w) standard error of the mean, W/(mm^2 sr), from the scatter of the batches; wants two of them."""
        spread = np.maximum(self.squares / self.batches - self.mean**2, 0)
        return np.sqrt(spread / (self.batches - 1))

    def add(self, batch: np.ndarray) -> None:
        """Take in one more batch (h, w)."""
        self.batches += 1
        self.total += batch
        self.squares += batch**2


def digest(key: dict[str, Any]) -> str:
    """SHA-256 of a key."""
    return hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()


def save(path: Path, truth: Truth) -> None:
    """Write at least two batches, whole or not at all. Raises InputError if `path` cannot be written."""
    arrays = {"mean": truth.mean.astype(np.float32), "error": truth.error.astype(np.float32)}
    record = json.dumps({"key": truth.key, "sha256": digest(truth.key)}, sort_keys=True)
    with atomic_file.replacing(path) as stream:
        np.savez_compressed(stream, **arrays, batches=np.int64(truth.batches), record=np.array(record))


def load(path: Path, key: dict[str, Any]) -> Truth:
    """Read what `save` wrote for this very key.

    Raises InputError if the file cannot be read or was made for anything else, naming what differs.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            record = json.loads(str(file["record"]))
            mean, error = file["mean"].astype(np.float64), file["error"].astype(np.float64)
            batches = int(file["batches"])
        found, stated = record["key"], record["sha256"]
    except (OSError, KeyError, ValueError, BadZipFile) as problem:
        raise InputError(f"{path}: cannot be read as a truth image: {problem}") from problem
    if stated != digest(found):
        raise InputError(f"{path}: sha256 of the key: {stated} found, its key has {digest(found)}")
    wrong = _differences(found, key)
    if wrong:
        raise InputError(f"{path}: made for another scene: {'; '.join(wrong)}; remove it to have it made again")
    spread = error**2 * (batches - 1)
    return Truth(key, batches, mean * batches, (spread + mean**2) * batches)


def _differences(found: Any, wanted: Any, where: str = "") -> list[str]:
    if isinstance(found, dict) and isinstance(wanted, dict):
        names = sorted(found.keys() | wanted.keys())
        below = [_differences(found.get(n), wanted.get(n), f"{where}.{n}" if where else n) for n in names]
        return [text for texts in below for text in texts]
    return [] if found == wanted else [f"{where}: {found!r} found, {wanted!r} wanted"]
