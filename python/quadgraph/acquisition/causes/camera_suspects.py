"""What may be wrong with cameras: photographs of which all is elsewhere in the picture, or of another size."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy import ndimage

from quadgraph.acquisition.causes.bank import Bank, Gathered, Otherwise
from quadgraph.acquisition.causes.outlines import displaced, grey, lit
from quadgraph.acquisition.causes.suspects import Scope, Suspect, scopes

_LEAST = 0.03  # of a size, or pixels over the size, from which on a difference is worth a word


def of_cameras(bank: Bank) -> Iterator[Suspect]:
    """Pictures moved, or larger and smaller, as what is lit in them says."""
    measures = [_measure(bank, number) for number in range(len(bank.seen))]
    for scope in scopes(bank):
        cameras = dict.fromkeys(bank.problem.measured[number].stated.camera for number in scope)
        found = [measures[number] for number in scope]
        scale = float(np.exp(np.mean([np.log(size) for size, _ in found])))
        shift = np.mean([where for _, where in found], axis=0)
        if not np.isfinite(scale):
            continue
        names = ", ".join(f"cameras.{name}" for name in cameras)
        if abs(scale - 1) > _LEAST:
            text = (
                f"{names}.fov: what is seen is {scale:.2f} times as large as predicted, and fits much better made as "
                "small; correct the field of view, the distance, or the size of the body (unit, height)"
            )
            yield _seen(bank, scope, "size", scale, np.zeros(2), text)
        if len(cameras) == 1:
            down, right = shift * bank.side
            text = (
                f"{names}.look_at: what is seen lies {right:+.0f} pixels to the right and {down:+.0f} down of its "
                "prediction, and fits much better moved back; correct look_at, or the body's place"
            )
            yield _seen(bank, scope, "moved", 1.0, shift, text)


def _seen(bank: Bank, scope: Scope, kind: str, scale: float, shift: np.ndarray, text: str) -> Suspect:
    otherwise = {number: Otherwise(seen=_resampled(bank.seen[number], scale, shift)) for number in scope}
    return Suspect(kind, otherwise, 1.1, text)


def _measure(bank: Bank, number: int) -> tuple[float, np.ndarray]:
    """How many times as large as predicted what is lit is, and by how many squares it lies elsewhere, down, right."""
    seen = bank.seen[number]
    usable = seen.usable.all(axis=2)
    photographed, predicted = lit(grey(seen.values)) & usable, lit(grey(bank.picture(number))) & usable
    size, shift = displaced(photographed, predicted)
    return size or np.nan, shift


def _resampled(seen: Gathered, scale: float, shift: np.ndarray) -> Gathered:
    """A photograph as if it were made `scale` times as small about its middle, after having been moved back."""
    centre = (np.array(seen.beside.shape) - 1) / 2
    matrix = np.array([scale, scale, 1.0])
    offset = np.append(centre - scale * centre + shift, 0.0)

    def at(values: np.ndarray, outside: float) -> np.ndarray:
        return ndimage.affine_transform(values, matrix, offset, order=1, mode="constant", cval=outside)

    usable = at(seen.usable.astype(float), 0.0) > 0.99
    return replace(seen, values=at(seen.values, 0.0), noise=at(seen.noise, 1.0), usable=usable)
