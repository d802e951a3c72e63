"""The points that no other beats in both time and error."""

from __future__ import annotations

from collections.abc import Sequence


def front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of those points (ms, error) than which none is both faster and closer, fastest first.

    Of equal points the first counts.
    """
    chosen: list[int] = []
    for index in sorted(range(len(points)), key=lambda i: points[i]):
        if not chosen or points[index][1] < points[chosen[-1]][1]:
            chosen.append(index)
    return chosen
