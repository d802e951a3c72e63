"""What a solve did, for people: in one line, and as a small table of a notebook."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from typing import TYPE_CHECKING

from quadgraph.api.reprs import channels, farthest, share

if TYPE_CHECKING:
    from quadgraph.api.solution import ErrorEstimate, Solution

_POWERS = {
    "entered": "entered",
    "re_entered": "entered again",
    "scattered_out": "scattered out",
    "absorbed": "absorbed",
    "unscattered_out": "unscattered out",
}
_WARNINGS = (
    "replaced",
    "advice",
    "mesh_warning",
    "model_warning",
    "size_warning",
    "phase_warning",
    "index_warning",
    "light_warning",
    "deformed",
    "missed",
    "stopped",
)


def summary(solution: Solution) -> str:
    """Method, powers and error in one line."""
    if solution.path is not None:
        return f"{solution.method}: {_path(solution)}"
    energy = solution.energy
    powers = ", ".join(f"{channels(getattr(energy, name), 'W')} {words}" for name, words in _powers(solution))
    met = "" if solution.converged else ", not converged"
    return f"{_how(solution)}: {powers}, balance {share(farthest(energy.balance))}, {_error(solution.error)}{met}"


def table(solution: Solution) -> str:
    """HTML: power and balance per channel, the estimate of the error, and what is to be said against the answer."""
    rows = [] if solution.path is not None else list(_rows(solution))
    against = [getattr(solution, name) for name in _WARNINGS if getattr(solution, name)]
    caption = _path(solution) if solution.path is not None else _error(solution.error)
    lines = [f"<b>{escape(_how(solution))}</b>: {escape(caption)}"]
    if rows:
        lines.append(f"<table><tr><th></th><th>red</th><th>green</th><th>blue</th></tr>{''.join(rows)}</table>")
    return "".join(f"<div>{line}</div>" for line in (*lines, *map(escape, against)))


def _rows(solution: Solution) -> Iterator[str]:
    for name, words in _powers(solution):
        yield _row(f"{words}, W", [f"{power:.4g}" for power in getattr(solution.energy, name)])
    yield _row("balance", [share(each) for each in solution.energy.balance])


def _powers(solution: Solution) -> list[tuple[str, str]]:
    """Members of `Energy` that are to be shown, and what they are called."""
    return [(name, words) for name, words in _POWERS.items() if name != "re_entered" or solution.inter_reflection]


def _row(name: str, cells: Sequence[str]) -> str:
    shown = "".join(f"<td>{escape(each)}</td>" for each in cells)
    return f"<tr><td style='text-align: left'>{name}</td>{shown}</tr>"


def _how(solution: Solution) -> str:
    if solution.path is not None:
        return f"{solution.method} / {solution.path.solver}"
    return f"{solution.method} / {solution.model} / {solution.source} / {solution.solver}"


def _error(error: ErrorEstimate | None) -> str:
    if error is None:
        return "error not known"
    unlit = f" ({share(error.unlit)} where it is unlit)" if error.unlit > 0 else ""
    return f"error {share(error.whole)}{unlit}, estimated"


def _path(solution: Solution) -> str:
    path = solution.path
    assert path is not None
    return f"{path.solid:,} voxels of {path.cell:.3g} mm in the body, {path.lit:,} of them lit; error not known"
