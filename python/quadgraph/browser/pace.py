"""How good a frame in motion can be: it must not take longer than a budget (engine/app/pace.h, of the window)."""

from __future__ import annotations

_BUDGET_S = 0.09
_LEAST_DRAWING = 0.35  # of the budget, or of the solve where that takes longer
_CORRECTED_OVER_PLAIN = 4.0  # time of a solve with the correction over that of one without
_SHARES = (1.0, 0.75, 0.5, 0.375)


class Pace:
    """What was measured, and what follows for the next frame. Times are seconds."""

    def __init__(self) -> None:
        """Know nothing yet."""
        self._solve: dict[bool, float] = {}  # by whether it was corrected
        self._draw: dict[bool, float] = {}  # of a pixel, by whether radiance was gathered
        self._last_solve = 0.0

    def solved(self, seconds: float, corrected: bool) -> None:
        """Take note of a solve in motion."""
        self._last_solve = _mixed(self._last_solve, seconds)
        self._solve[corrected] = _mixed(self._solve.get(corrected, 0.0), seconds)

    def drawn(self, seconds: float, pixels: int, gathered: bool) -> None:
        """Take note of a picture in motion."""
        self._draw[gathered] = _mixed(self._draw.get(gathered, 0.0), seconds / pixels)

    @property
    def corrects(self) -> bool:
        """Whether there is time for the correction, as measured, or as far as a solve without lets expect."""
        if True in self._solve:
            return self._solve[True] < _BUDGET_S
        return False in self._solve and _CORRECTED_OVER_PLAIN * self._solve[False] < _BUDGET_S

    def gathers(self, solving: bool) -> bool:
        """Whether there is time to gather radiance along view rays; `solving`: a solve comes before the drawing."""
        return not solving or self._last_solve < _BUDGET_S

    def share(self, pixels: int, solving: bool) -> float:
        """Side of a picture in motion, as a share of the whole one's."""
        solve = self._last_solve if solving else 0.0
        left = max(_BUDGET_S - solve, _LEAST_DRAWING * max(_BUDGET_S, solve))
        each = self._draw.get(self.gathers(solving))
        if each is None:
            return _SHARES[-1]
        return next((share for share in _SHARES if each * pixels * share**2 <= left), _SHARES[-1])


def _mixed(before: float, now: float) -> float:
    """What was measured last counts as much as all before it: a first picture compiles what others find compiled."""
    return 0.5 * (before + now) if before > 0 else now
