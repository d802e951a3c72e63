"""What commands tell of a picture that converges, and keep of it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from quadgraph.core import Picture


def tell(step: dict[str, Any]) -> None:
    """Say on standard error what a picture is after one more step."""
    from quadgraph.commands.solve_report import step_text

    print(f"converge: {step_text(step)}", file=sys.stderr, flush=True)


def report_of(picture: Picture, solved: dict[str, Any]) -> dict[str, Any]:
    """The report of the solve before the picture or, where that converged, of the last one for it, and how it did."""
    found = picture.convergence
    if not found:
        return solved | {"convergence": None}
    return found.pop("solve") | {"budget": solved["budget"], "convergence": found}
