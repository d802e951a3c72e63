"""What was recovered as one HTML file that needs nothing else: photographs, predictions, residuals, convergence."""

from __future__ import annotations

import html
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition.homogeneous.fitting import Fit
from quadgraph.acquisition.model.prediction import CHANNELS, NAMES
from quadgraph.acquisition.page_parts import figure, srgb, table
from quadgraph.acquisition.recovery import Recovered
from quadgraph.acquisition.volume.volume_fit import VolumeFit
from quadgraph.base.atomic_file import replacing

_WHITE = 0.995  # quantile of a photograph that is shown as white
_MOST = 4.0  # standard deviations, at which residuals have their full colour
_LEFT_OUT = (128, 128, 128)
_SLICES = 4
_SIZE, _EDGE = (480, 200), 40  # of the drawing of the convergence
_COLOURS = ("#c0392b", "#1e8449", "#2471a3")
_STYLE = """
:root { color-scheme: light dark; --line: #8886; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; margin: 1rem 0; }
td, th { padding: .3rem .8rem .3rem 0; text-align: left; border-bottom: 1px solid var(--line); vertical-align: top; }
td.number { font-variant-numeric: tabular-nums; white-space: nowrap; }
figure { display: inline-block; margin: 0 1rem 1rem 0; }
figcaption { font-size: 13px; }
img { width: 220px; image-rendering: pixelated; display: block; background: #000; }
.said { border-left: 4px solid #d68910; padding-left: .8rem; }
svg text { fill: currentColor; font: 12px system-ui, sans-serif; }
"""


def write(path: Path, found: Recovered) -> None:
    """Write the page. Raises InputError if it cannot be written."""
    with replacing(path) as stream:
        stream.write(page(found).encode())


def page(found: Recovered) -> str:
    """The whole document; the same result makes the same page."""
    name = html.escape(found.capture.path.name)
    body = [f"<h1>What {name} says of {html.escape(found.capture.body.name)}</h1>"]
    fit = found.fit
    body += [_volume(found, fit) if isinstance(fit, VolumeFit) else _coefficients(found, fit), _said(found)]
    body += [f"<h2>Photographs</h2>{_scale()}", *_photographs(found)]
    body += ["<h2>Convergence</h2>", _convergence(found)]
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{name}</title>'
    head = f"<head>{head}<style>{_STYLE}</style></head>"
    return f'<!doctype html>\n<html lang="en">{head}\n<body>{"".join(body)}</body></html>\n'


def _coefficients(found: Recovered, fit: Fit) -> str:
    """Coefficients and their standard deviations, a row a coefficient."""
    rows = [["", *CHANNELS]]
    for row, name in enumerate(NAMES):
        values = zip(fit.coefficients[row], fit.deviations[row], strict=True)
        rows.append([f"{name}, 1/mm", *(f"{value:.4g} ± {value * deviation:.2g}" for value, deviation in values)])
    rows.append(["correlation of the two", *(f"{value:+.2f}" for value in fit.correlations)])
    rows.append(["χ² per degree of freedom", *(f"{value:.3g}" for value in fit.chi_squared)])
    rows.append(["index of refraction", f"{found.capture.eta:g} (stated)", "", ""])
    return table(rows)


def _volume(found: Recovered, volume: VolumeFit) -> str:
    """Coefficients and their deviations in slices of the body, from one end of its shortest side to the other."""
    grid = volume.grid
    axis = int(np.argmin(grid.size))
    places = np.unique(np.linspace(0, grid.size[axis] - 1, _SLICES + 2).round().astype(int)[1:-1])
    parts = []
    for row, name in enumerate(NAMES):
        most = float(np.quantile(volume.coefficients[row][volume.inside], 0.99))
        shown = [
            (name, volume.coefficients[row] / most, f"black 0, white {most:.3g} 1/mm and more in all three channels")
        ]
        if volume.deviations is not None and volume.resolution is not None:
            widest = float(np.max(grid.size)) * grid.spacing / 2
            length = f"over which it is one number; black 0, white {widest:.2g} mm and more"
            shown += [
                (f"Deviation of {name}", volume.deviations[row], "relative; black 0, white 100% and more: not known"),
                (f"Resolution length of {name}", volume.resolution[row] / widest, length),
            ]
        for what, values, note in shown:
            cells = np.where(volume.inside[:, None], srgb(values), np.uint8(_LEFT_OUT[0])).astype(np.uint8)
            cells = cells.reshape(*grid.size[::-1], 3)
            parts.append(f"<h3>{html.escape(what)}</h3><p>{note}; grey is outside.</p>")
            for place in places:
                at = grid.low[axis] + grid.spacing * place
                pixels = np.take(cells, place, axis=2 - axis)[::-1]
                parts.append(figure(np.ascontiguousarray(pixels), f"{'xyz'[axis]} = {at:.3g} mm", what))
    rows = [["", *CHANNELS], ["χ² per square", *(f"{value:.3g}" for value in volume.chi_squared)]]
    rows.append(["index of refraction", f"{found.capture.eta:g} (stated)", "", ""])
    return table(rows) + "".join(parts)


def _said(found: Recovered) -> str:
    """What is to be said against the result."""
    sentences = [*found.findings, *found.undetermined, *found.notes]
    if not sentences:
        return "<p>Photographs and predictions agree, and the photographs determine all coefficients.</p>"
    return '<div class="said">' + "".join(f"<p>{html.escape(each)}</p>" for each in sentences) + "</div>"


def _scale() -> str:
    return (
        "<p>Each photograph beside its prediction, both shown alike, with what is left between them in standard "
        f"deviations: blue {-_MOST:g}, white 0, red +{_MOST:g} (the photograph is brighter). Grey pixels do not count."
        "</p>"
    )


def _photographs(found: Recovered) -> Iterable[str]:
    """A row of three pictures for each photograph."""
    for number, (one, picture) in enumerate(zip(found.measured, found.fit.pictures, strict=True)):
        stated = one.stated
        gain = stated.gain if isinstance(stated.gain, float) else 1.0
        expected = stated.exposure * gain * found.fit.gains[number] * picture.radiance
        deviation = np.sqrt(one.variance_of(expected) + (picture.error * expected) ** 2)
        white = float(np.quantile(one.values, _WHITE)) or 1.0
        counts = np.asarray(found.problem.counted[number])
        left = np.where(counts, (one.values - expected) / deviation, 0)
        chi = ", ".join(f"{each:.2f}" for each in (left**2).sum(axis=(0, 1)) / np.maximum(counts.sum(axis=(0, 1)), 1))
        mean = left.sum(axis=2) / np.maximum(counts.sum(axis=2), 1)
        lights = html.escape(" + ".join(stated.lights))
        yield f"<h3>{html.escape(stated.file.name)}: {html.escape(stated.camera)}, {lights}</h3>"
        yield figure(srgb(one.values / white), "photograph", stated.file.name)
        yield figure(srgb(expected / white), "prediction", stated.file.name)
        yield figure(_signed(mean, counts.any(axis=2)), f"residual; χ² a pixel {chi}", stated.file.name)


def _signed(value: np.ndarray, counted: Any) -> np.ndarray:
    """Residuals from blue over white to red; what does not count is grey."""
    share = np.clip(value / _MOST, -1, 1)[..., None]
    red, blue = np.array([178.0, 24.0, 43.0]), np.array([33.0, 102.0, 172.0])
    colour = 255 + np.where(share > 0, share * (red - 255), -share * (blue - 255))
    return np.where(counted[..., None], colour, _LEFT_OUT).astype(np.uint8)


def _convergence(found: Recovered) -> str:
    """Chi^2 of each step, by channel, on a logarithmic scale."""
    steps = np.array([each.chi_squared for each in found.fit.steps])
    logs = np.log10(np.maximum(steps, 1e-6))
    low, high = min(float(logs.min()), 0.0) - 0.1, max(float(logs.max()), 0.0) + 0.1
    width, height = _SIZE
    x = _EDGE + np.arange(len(steps)) * (width - 2 * _EDGE) / max(len(steps) - 1, 1)

    def y(value: np.ndarray | float) -> np.ndarray | float:
        return height - _EDGE / 2 - (value - low) / (high - low) * (height - _EDGE)

    parts = [f'<line x1="{_EDGE}" x2="{width - _EDGE}" y1="{y(0.0):.1f}" y2="{y(0.0):.1f}" stroke="#888"/>']
    parts.append(f'<text x="{_EDGE - 16}" y="{y(0.0) + 4:.1f}">1</text>')
    for channel, colour in enumerate(_COLOURS):
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, np.asarray(y(logs[:, channel])), strict=True))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')
    drawing = f'<svg viewBox="0 0 {width} {height}" width="{width}" role="img">{"".join(parts)}</svg>'
    per = "square" if isinstance(found.fit, VolumeFit) else "degree of freedom"
    drawing = f"<figure>{drawing}<figcaption>χ² per {per}, by step and channel</figcaption></figure>"
    if isinstance(found.fit, VolumeFit):
        return drawing
    rows = [["step", *(f"χ², {name}" for name in CHANNELS), *(f"{name}, 1/mm" for name in NAMES)]]
    for number, step in enumerate(found.fit.steps, 1):
        coefficients = (" / ".join(f"{value:.4g}" for value in row) for row in step.coefficients)
        rows.append([str(number), *(f"{value:.3g}" for value in step.chi_squared), *coefficients])
    return drawing + table(rows)
