"""Masks of bodies in photographs of the tests' camera: exact ones, and ones as made by hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import ndimage

import board_photographs
from quadgraph.acquisition.cameras.lens import Pose
from quadgraph.acquisition.cameras.placed_body import PlacedBody

LENS = board_photographs.LENS


def masks_of(body: PlacedBody, poses: Sequence[Pose]) -> list[np.ndarray]:
    """(h, w) each, whether the ray through a pixel's middle meets the body."""
    masks = []
    for pose in poses:
        ways = (board_photographs.middles(LENS) @ pose.rotation).reshape(-1, 3)
        met = body.hit(np.broadcast_to(pose.eye, ways.shape), ways)[0] >= 0
        masks.append(met.reshape(LENS.height, LENS.width))
    return masks


def roughened(mask: np.ndarray, pixels: float, generator: np.random.Generator) -> np.ndarray:
    """A mask whose edge is that many pixels off, RMS, in waves of some twenty pixels."""
    if not pixels:
        return mask
    beside = ndimage.distance_transform_edt(~mask) - ndimage.distance_transform_edt(mask)
    waves = ndimage.gaussian_filter(generator.normal(size=mask.shape), 10)
    return np.asarray(beside + pixels * waves / waves.std() < 0)
