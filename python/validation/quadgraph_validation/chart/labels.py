"""Labels of points that cover neither each other nor points nor steps."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

_DISTANCES = (7, 16, 28, 44, 64, 90)  # points
_DIRECTIONS = tuple(np.radians([180, 190, 200, 212, 225, 250, 270, 168, 45, 0, 90, 135, 315, 20, 340]))
_FONT = 8.5


def place(axis: Any, named: Sequence[tuple[float, float, str, str]]) -> None:
    """Write the texts of (x, y, text, colour) beside their points, each at the first place around it that is free.

    All scattered points and lines in steps of the panel are kept free; a text for which there is no free place is left
    out. Below and left of a front nothing is: places there come first.
    """
    renderer = axis.figure.canvas.get_renderer()
    inside = axis.get_window_extent(renderer).padded(-4)
    taken = [box for path in axis.collections for box in _marker_boxes(axis, path)]
    taken += [box for line in axis.lines if line.get_drawstyle() == "steps-post" for box in _step_boxes(axis, line)]
    for x, y, text, colour in named:
        for distance, angle in product(_DISTANCES, _DIRECTIONS):
            label = _label(axis, (x, y), text, colour, distance, angle)
            box = label.get_window_extent(renderer).padded(1.5)
            if _outside(box, inside) + sum(_shared(box, other) for other in taken) == 0:
                taken.append(box)
                break
            label.remove()


def _label(axis: Any, at: tuple[float, float], text: str, colour: str, distance: float, angle: float) -> Any:
    across, along = np.cos(angle), np.sin(angle)
    far = distance > _DISTANCES[0]
    return axis.annotate(
        text,
        at,
        (distance * across, distance * along),
        textcoords="offset points",
        fontsize=_FONT,
        color=colour,
        ha="left" if across > 0.3 else "right" if across < -0.3 else "center",
        va="bottom" if along > 0.3 else "top" if along < -0.3 else "center",
        zorder=4,
        arrowprops={"arrowstyle": "-", "linewidth": 0.6, "color": "#666666", "shrinkA": 0} if far else None,
    )


def _marker_boxes(axis: Any, path: Any) -> list[Any]:
    """Boxes in pixels of the markers of a scatter."""
    from matplotlib.transforms import Bbox

    sizes = path.get_sizes()
    if not len(sizes) or not len(path.get_offsets()):
        return []
    half = np.sqrt(sizes[0]) / 2 * axis.figure.dpi / 72
    places = axis.transData.transform(path.get_offsets())
    return [Bbox.from_extents(x - half, y - half, x + half, y + half) for x, y in places]


def _step_boxes(axis: Any, line: Any) -> list[Any]:
    """Boxes in pixels of the pieces of a line in steps."""
    from matplotlib.transforms import Bbox

    x, y = np.repeat(axis.transData.transform(line.get_xydata()), 2, axis=0).T
    corners = np.column_stack([x[1:], y[:-1]])
    low, high = (choose(corners[:-1], corners[1:]) for choose in (np.minimum, np.maximum))
    return [Bbox.from_extents(*a - 1, *b + 1) for a, b in zip(low, high, strict=True)]


def _shared(box: Any, other: Any) -> float:
    width = min(box.x1, other.x1) - max(box.x0, other.x0)
    height = min(box.y1, other.y1) - max(box.y0, other.y0)
    return width * height if width > 0 and height > 0 else 0.0


def _outside(box: Any, inside: Any) -> float:
    return box.width * box.height - _shared(box, inside)
