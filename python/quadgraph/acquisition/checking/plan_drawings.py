"""Drawings of a check's page: cameras and lights by plan and by direction, and how the board's corners lie."""

from __future__ import annotations

import html
from collections.abc import Iterator

import numpy as np

from quadgraph.acquisition.checking.capture_check import Checked
from quadgraph.acquisition.checking.import_record import Imported

_SIZE, _EDGE = 310, 24  # pixels
_FARTHEST = 3.0  # times the distance of the farthest camera: lights beyond are drawn at the edge
_HULL = 400  # vertices of the body that are drawn
_TIMES = 100  # of what corners are off
_WIDE = 150  # pixels, of the drawing of corners


def plans(checked: Checked) -> Iterator[str]:
    """From above, from the side, and the directions from which the body is seen and lit."""
    yield _plan(checked, 0, 1, "from above")
    yield _plan(checked, 0, 2, "from the side")
    yield _directions(checked)


def _card(drawing: str, caption: str, width: int, height: int) -> str:
    whole = f'<svg viewBox="0 0 {width} {height}" width="{width}" role="img">{drawing}</svg>'
    return f'<div class="card"><figure>{whole}<figcaption>{html.escape(caption)}</figcaption></figure></div>'


def _eyes(checked: Checked) -> list[tuple[str, np.ndarray, bool]]:
    views = [(each.measured.stated, each.view, bool(each.wrong)) for each in checked.judged]
    return [(stated.path, view.eye, wrong) for stated, view, wrong in views if view is not None]


def _lights(checked: Checked) -> list[tuple[str, np.ndarray]]:
    found = [(name, checked.body.light_place(light)) for name, light in checked.capture.lights.items()]
    return [(name, place) for name, place in found if place is not None]


def _plan(checked: Checked, across: int, upward: int, what: str) -> str:
    """Two coordinates of everything, to scale, the body in the middle."""
    body, eyes = checked.body, _eyes(checked)
    farthest = max([float(np.linalg.norm(eye - body.middle)) for _, eye, _ in eyes] + [2 * body.radius])
    lamps = []
    for name, place in _lights(checked):
        off = place - body.middle
        distance = float(np.linalg.norm(off))
        reach = min(distance, _FARTHEST * farthest) if distance < 50 * farthest else 1.1 * farthest
        lamps.append((name, body.middle + off * reach / distance))
    places = np.array([body.middle, *(eye for _, eye, _ in eyes), *(place for _, place in lamps)])
    half = max(float(np.abs(places - body.middle).max()), 1.5 * body.radius)
    scale = (_SIZE / 2 - _EDGE) / half

    def at(place: np.ndarray) -> tuple[float, float]:
        off = (place - body.middle) * scale
        return _SIZE / 2 + float(off[across]), _SIZE / 2 - float(off[upward])

    parts = [_body(checked, across, upward, scale)]
    for path, eye, wrong in eyes:
        (x, y), (x0, y0) = at(eye), at(body.middle)
        colour = "var(--wrong)" if wrong else "var(--eye)"
        parts.append(f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{x0:.1f}" y2="{y0:.1f}" stroke="{colour}" opacity=".25"/>')
        parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{colour}"><title>{html.escape(path)}</title></circle>'
        )
    for name, place in lamps:
        x, y = at(place)
        parts.append(_star(x, y, name))
    mm = 10 ** int(np.floor(np.log10(half)))
    parts.append(
        f'<line x1="12" y1="{_SIZE - 12}" x2="{12 + mm * scale:.1f}" y2="{_SIZE - 12}" stroke="currentColor"/>'
    )
    parts.append(f'<text x="12" y="{_SIZE - 17}">{mm} mm</text>')
    parts.append(f'<text x="{_SIZE - 20}" y="{_SIZE - 8}">{"xyz"[across]} →</text>')
    parts.append(f'<text x="4" y="14">{"xyz"[upward]} ↑</text>')
    return _card("".join(parts), f"{what}: cameras blue, lights yellow", _SIZE, _SIZE)


def _body(checked: Checked, across: int, upward: int, scale: float) -> str:
    """The outline of the body, as the convex hull of what is seen of it."""
    from scipy.spatial import ConvexHull

    flat = (checked.body.vertices - checked.body.middle)[:, [across, upward]] * [scale, -scale] + _SIZE / 2
    hull = flat[ConvexHull(flat[:: max(len(flat) // _HULL, 1)]).vertices * max(len(flat) // _HULL, 1)]
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in hull)
    return f'<polygon points="{points}" fill="currentColor" opacity=".28"/>'


def _star(x: float, y: float, name: str) -> str:
    rays = "".join(
        f'<line x1="{x + 4 * np.cos(a):.1f}" y1="{y + 4 * np.sin(a):.1f}" x2="{x + 9 * np.cos(a):.1f}" '
        f'y2="{y + 9 * np.sin(a):.1f}" stroke="var(--lamp)" stroke-width="2"/>'
        for a in np.arange(8) * np.pi / 4
    )
    return (
        f'{rays}<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="var(--lamp)"/>'
        f'<text x="{x + 11:.1f}" y="{y + 4:.1f}">{html.escape(name[:24])}</text>'
    )


def _directions(checked: Checked) -> str:
    """Directions from the body, the upper half as a disc (equal areas), z in its middle; those from below as rings."""
    middle, reach = _SIZE / 2, _SIZE / 2 - _EDGE
    rings = [reach * np.sqrt(1 - np.cos(np.radians(angle))) for angle in (30, 60, 90)]
    parts = [f'<circle cx="{middle}" cy="{middle}" r="{r:.1f}" fill="none" stroke="var(--line)"/>' for r in rings]

    def at(place: np.ndarray) -> tuple[float, float, bool]:
        way = (place - checked.body.middle) / np.linalg.norm(place - checked.body.middle)
        level = np.hypot(way[0], way[1])
        radius = reach * np.sqrt(max(1 - abs(way[2]), 0))
        across, upward = (way[:2] / level if level > 1e-9 else np.zeros(2)) * radius
        return middle + float(across), middle - float(upward), bool(way[2] < 0)

    for path, eye, wrong in _eyes(checked):
        x, y, below = at(eye)
        fill = "none" if below else "var(--wrong)" if wrong else "var(--eye)"
        title = f"<title>{html.escape(path)}</title>"
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{fill}" stroke="var(--eye)">{title}</circle>')
    for name, place in _lights(checked):
        x, y, _ = at(place)
        parts.append(_star(x, y, name))
    parts += [f'<text x="{_SIZE - 20}" y="{middle + 4}">x</text>', f'<text x="{middle - 3}" y="14">y</text>']
    return _card("".join(parts), "directions: z in the middle; 30, 60, 90 degrees", _SIZE, _SIZE)


def corners(imported: Imported) -> str:
    """The photograph's frame with the board's corners and how they lie off; nothing without a board."""
    if not len(imported.corners):
        return ""
    width, height = imported.size
    scale = _WIDE / width
    parts = [f'<rect width="{_WIDE}" height="{height * scale:.1f}" fill="none" stroke="var(--line)"/>']
    for x, y, right, down in imported.corners * scale:
        parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.6" fill="var(--eye)"/><line x1="{x:.1f}" y1="{y:.1f}" '
            f'x2="{x + _TIMES * right:.1f}" y2="{y + _TIMES * down:.1f}" stroke="var(--wrong)" stroke-width="1.2"/>'
        )
    drawing = f'<svg viewBox="0 0 {_WIDE} {height * scale:.1f}" width="{_WIDE}" role="img">{"".join(parts)}</svg>'
    return f"<figure>{drawing}<figcaption>corners of the board, off by {_TIMES} times</figcaption></figure>"
