"""What a mesh file says at the corners of its triangles, found again on the surface that was made of them."""

from __future__ import annotations

import numpy as np

from quadgraph.mesh.surface import Surface

_NEAR_SHARE = 2e-6  # of the diagonal: what a repair may move a vertex by when it joins near ones


def carried(corners: np.ndarray, values: np.ndarray, surface: Surface) -> np.ndarray:
    """(m, 3, c) what values (k, 3, c) at corners (k, 3, 3), mm, are at the corners of `surface`.

    0 where no triangle lies over the same places, whichever way it looks, and where a value is not finite.
    """
    from scipy.spatial import cKDTree  # here, as programs that only read bodies would take twice as long to start

    places, place_of = np.unique(surface.vertices, axis=0, return_inverse=True)
    finite = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
    rounded = corners[finite].astype(np.float32).astype(np.float64).reshape(-1, 3)  # as the surface's are
    near = _NEAR_SHARE * surface.diagonal
    place = cKDTree(places).query(rounded, distance_upper_bound=near)[1].reshape(-1, 3)
    whole = (place < len(places)).all(axis=1)
    theirs, rows = place[whole], finite[whole]
    ours = place_of.reshape(-1)[surface.triangles]
    low, middle, high = np.sort(np.concatenate([theirs, ours]), axis=1).T
    pair = np.unique(low * len(places) + middle, return_inverse=True)[1].reshape(-1)
    both, group = np.unique(pair * len(places) + high, return_inverse=True)
    group = group.reshape(-1)
    first = np.full(len(both), -1)
    first[group[: len(theirs)][::-1]] = np.arange(len(theirs))[::-1]
    source = first[group[len(theirs) :]]
    known = np.flatnonzero(source >= 0)
    match = source[known]
    at = (ours[known][:, :, None] == theirs[match][:, None, :]).argmax(axis=2)
    taken = np.take_along_axis(values[rows[match]], at[:, :, None], axis=1)
    found = np.zeros((*surface.triangles.shape, values.shape[2]))
    found[known] = np.where(np.isfinite(taken).all(axis=2, keepdims=True), taken, 0)
    return found
