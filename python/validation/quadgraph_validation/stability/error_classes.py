"""What a solve is called when its true error is known: accurate, degraded but honest, refused, or wrong silently."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

ACCURATE, HONEST, REFUSED, SILENT = "accurate", "degraded but honest", "refused", "wrong silently"
CLASSES = (ACCURATE, HONEST, REFUSED, SILENT)

SMALL = 0.01  # a true error that needs no excuse
FACTOR = 2.0  # by which a true error may exceed its estimate
USABLE = 0.1  # a larger error is not called accurate, even where the estimate says it
USELESS = 0.25  # an estimate from here on says that the answer is none, however far off that is


@dataclass(frozen=True)
class Errors:
    """Relative RMS error of the exitance over the whole surface, and over its unlit part; None if there is none."""

    whole: float
    unlit: float | None = None

    @property
    def parts(self) -> list[float]:
        """Those that there are."""
        return [self.whole] if self.unlit is None else [self.whole, self.unlit]


def classify(true: Errors, estimate: Errors | None, said: Sequence[str] = (), small: float = SMALL) -> str:
    """Class of a solve that was not refused.

    estimate: the solve's own, None where it says that it has none; said: its words of warning; small: an error that
    needs no excuse. What is not finite is never honest.
    """
    if not all(math.isfinite(part) for part in true.parts):
        return SILENT
    expected = [math.inf if estimate is None else _of(estimate, index) for index in range(len(true.parts))]
    pairs = list(zip(true.parts, expected, strict=True))
    told = estimate is not None
    if all(error <= small or (told and error <= min(FACTOR * wanted, USABLE)) for error, wanted in pairs):
        return ACCURATE
    if said or all(error <= max(small, FACTOR * wanted) or wanted >= USELESS for error, wanted in pairs):
        return HONEST
    return SILENT


def _of(estimate: Errors, index: int) -> float:
    """The estimate of a part: of the whole where the solve knows of no unlit part."""
    part = estimate.parts[min(index, len(estimate.parts) - 1)]
    return part if math.isfinite(part) else math.inf
