"""Pictures beside path tracing: at one exposure, signed differences, scan lines (as [QG Fig. 11]).

Differences are grey where the path-traced picture is too noisy to tell.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.base import atomic_file
from quadgraph_validation.base.pyplot import load_pyplot
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.truth import blocks

if TYPE_CHECKING:
    from quadgraph_validation.accuracy.scenes_study import ScenesCompared

_RANGE = 40.0  # %, both ends of the difference's scale
_NOISY = 0.15  # standard error of a block of the truth, relative, above which no difference is drawn
_DEPTH = 3e-4  # of a scan line's brightest pixel: what is darker is not drawn
_TRUTH = "#222222"
_COLOURS = ("#c44e52", "#1f77b4", "#8a8a8a", "#e6953a")  # of scan lines, in the order of what is shown


def write(path: Path, scene: StudyScene, compared: Mapping[str, ScenesCompared], shown: Mapping[str, str]) -> None:
    """Draw images of a scene by their names: a row of pictures and a row of scan lines for each.

    shown: titles to the names of those pictures of each comparison that stand beside path tracing, up to four. Raises
    InputError.
    """
    pyplot = load_pyplot()
    figure = pyplot.figure(figsize=(2.6 * (1 + 2 * len(shown)), 4.9 * len(compared)), layout="constrained")
    parts = figure.subfigures(len(compared), 1, squeeze=False)[:, 0]
    for part, (name, one) in zip(parts, compared.items(), strict=True):
        upper, lower = part.subfigures(2, 1, height_ratios=[1, 0.85])
        rows = scene.views[scene.images[name].view].scan
        pictures = {title: one.pictures[picture] for title, picture in shown.items()}
        _pictures(upper, name, one, pictures, rows)
        _scan_lines(lower, one, pictures, rows)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file.replacing(path) as stream:
        figure.savefig(stream, format="png", dpi=80)
    pyplot.close(figure)


def _pictures(
    part: Any, name: str, one: ScenesCompared, pictures: dict[str, np.ndarray], rows: tuple[int, ...]
) -> None:
    axes = part.subplots(1, 1 + 2 * len(pictures), gridspec_kw={"wspace": 0.02})
    white = 1.1 * np.quantile(one.image.mean[one.alpha > 0], 0.98)
    images = {f"{name}: path tracing": one.image.mean} | pictures
    for axis, (title, image) in zip(axes, images.items(), strict=False):
        axis.imshow(_display(image / white), cmap="gray", vmin=0, vmax=1)
        axis.set_title(title, fontsize=10)
    for row in rows:
        axes[0].axhline(row, color="#ffb000", linewidth=0.8)
    differences = axes[len(images) :]
    for axis, (title, image) in zip(differences, pictures.items(), strict=True):
        axis.imshow(np.where(blocks.covered(one.alpha), 0.8, np.nan), cmap="gray", vmin=0, vmax=1)
        drawn = axis.imshow(_difference(image, one), cmap="RdBu_r", vmin=-_RANGE, vmax=_RANGE)
        axis.set_title(f"{title}, error", fontsize=10)
    for axis in axes:
        axis.set_axis_off()
    part.colorbar(drawn, ax=differences, shrink=0.85, label="% of path tracing", pad=0.02)


def _scan_lines(part: Any, one: ScenesCompared, pictures: dict[str, np.ndarray], rows: tuple[int, ...]) -> None:
    axes = part.subplots(1, len(rows), squeeze=False)[0]
    for axis, row in zip(axes, rows, strict=True):
        top = row // blocks.BLOCK * blocks.BLOCK
        _scan_line(axis, one, pictures, slice(top, top + blocks.BLOCK))
        axis.set_title(f"rows {top} to {top + blocks.BLOCK - 1}", fontsize=10)
        axis.set_xlabel("pixel")
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("radiance, W/(mm² sr)")
    lines = axes[0].get_legend_handles_labels()
    part.legend(*lines, loc="outside upper center", ncols=len(lines[1]), fontsize=9, frameon=False)


def _scan_line(axis: Any, one: ScenesCompared, pictures: dict[str, np.ndarray], band: slice) -> None:
    """Means over the rows of a band, where it lies within the body."""
    inside = (one.alpha[band] > 1 - 1e-3).all(axis=0)
    mean, *lines = (
        np.where(inside, image[band].mean(axis=0), np.nan) for image in (one.image.mean, *pictures.values())
    )
    error = np.sqrt((one.image.error[band] ** 2).mean(axis=0) / blocks.BLOCK)
    x = np.arange(len(mean))
    axis.fill_between(x, mean - 2 * error, mean + 2 * error, color=_TRUTH, alpha=0.25, linewidth=0)
    axis.plot(x, mean, color=_TRUTH, linewidth=1, label="path tracing, ± 2 standard errors")
    for title, line, colour in zip(pictures, lines, _COLOURS, strict=False):
        axis.plot(x, line, color=colour, linewidth=1.2, label=title)
    lowest, highest = np.nanmin(mean), np.nanmax(mean)
    if lowest > 0.1 * highest:
        axis.set_ylim(0, 1.3 * highest)
    else:
        axis.set_yscale("log")
        axis.set_ylim(max(0.5 * lowest, _DEPTH * highest), 2 * highest)


def _display(radiance: np.ndarray) -> np.ndarray:
    """SRGB's curve of values where 1 is white."""
    x = np.clip(radiance, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def _difference(image: np.ndarray, one: ScenesCompared) -> np.ndarray:
    """Difference of block means, in % of the truth's; NaN outside the body and where the truth is too noisy to tell."""
    true = blocks.means(one.image.mean)
    known = blocks.covered(one.alpha) & (blocks.errors(one.image.error) < _NOISY * true)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(known, 100 * (blocks.means(image) / true - 1), np.nan)
