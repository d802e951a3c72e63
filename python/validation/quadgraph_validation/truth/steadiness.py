"""How steady pictures are while something moves: flicker and lag of frames against converged ones, by blocks.

Frames are those of a program that runs; beside each stands the converged frame: what the same program shows once
nothing changes any more. What is wrong with that one is no matter here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class ConvergedFrames:
    """Two estimates (t, n) of the same converged frames, whose noise has nothing in common; twice the same where they
    have none. Products of one with the other are without the mean square of that noise.
    """

    first: np.ndarray
    second: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        """(t, n)."""
        return (self.first + self.second) / 2

    @property
    def square(self) -> float:
        """Mean square of the frames."""
        return float(np.mean(self.first * self.second))


@dataclass(frozen=True, eq=False)
class Lag:
    """By how many frames pictures are behind in each of several movements, (k,), and the standard errors."""

    frames: np.ndarray
    error: np.ndarray


def flicker(frames: np.ndarray, converged: ConvergedFrames) -> float:
    """RMS of what changes from frame to frame beyond what converged frames change, over the RMS of these.

    frames: (t, n), t at least 2, values of n blocks. Independent noise of a share s of each frame gives s sqrt(2); a
    frame that is off in the same way as the next, or late by as much, gives 0.
    """
    changes = np.diff(frames, axis=0)
    beyond = [changes - np.diff(of, axis=0) for of in (converged.first, converged.second)]
    return float(np.sqrt(max(np.mean(beyond[0] * beyond[1]), 0) / converged.square))


def lag(frames: np.ndarray, converged: ConvergedFrames, earlier: Sequence[np.ndarray]) -> Lag:
    """Least squares of the frames' error along what converged frames differ by from earlier ones.

    frames: (t, n), t at least 2; earlier: for each movement, converged frames (t, n) with that alone one frame behind,
    less those of now, without noise. 1: the frame shows what it should have shown one frame ago; below 0: it is ahead.
    Standard errors are from leaving out each frame in turn.
    """
    wrong, ways = frames - converged.mean, np.stack(earlier)
    kept = [np.arange(len(frames)) != left_out for left_out in range(len(frames))]
    without = np.array([_fit(wrong[chosen], ways[:, chosen]) for chosen in kept])
    spread = np.sqrt((len(frames) - 1) * np.mean((without - without.mean(axis=0)) ** 2, axis=0))
    return Lag(_fit(wrong, ways), spread)


def _fit(wrong: np.ndarray, ways: np.ndarray) -> np.ndarray:
    return np.linalg.lstsq(ways.reshape(len(ways), -1).T, wrong.ravel(), rcond=None)[0]
