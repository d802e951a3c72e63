"""Path-traced pictures on disk: mean and standard error of a pixel, under a key of everything that enters them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph_validation.base import store


@dataclass
class StoredTruth:
    """Batches of equal size added up: `total` and `squares` (h, w) float64 are the sums of their means and of the
    squares of these, W/(mm^2 sr).
    """

    key: dict[str, Any]
    batches: int
    total: np.ndarray
    squares: np.ndarray

    @classmethod
    def empty(cls, key: dict[str, Any], height: int, width: int) -> StoredTruth:
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


def save(path: Path, truth: StoredTruth) -> None:
    """Write at least two batches, whole or not at all. Raises InputError if `path` cannot be written."""
    arrays = {"mean": truth.mean.astype(np.float32), "error": truth.error.astype(np.float32)}
    store.save(path, truth.key, arrays | {"batches": np.array(truth.batches)})


def load(path: Path, key: dict[str, Any]) -> StoredTruth:
    """Read what `save` wrote for this very key.

    Raises InputError if the file cannot be read or was made for anything else, naming what differs.
    """
    arrays = store.load(path, key, ("mean", "error", "batches"), "a truth image")
    mean, error = arrays["mean"].astype(np.float64), arrays["error"].astype(np.float64)
    batches = int(arrays["batches"])
    spread = error**2 * (batches - 1)
    return StoredTruth(key, batches, mean * batches, (spread + mean**2) * batches)
