"""Exitance that the equations of a scheme have, per outside face of a chain's finest level."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quadgraph.base import atomic_file
from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies import meshes
from quadgraph_validation.stability.scaled_chains import CHANNELS, Fine, Irradiance, Medium
from quadgraph_validation.truth.schemes import Scheme


@dataclass(frozen=True, eq=False)
class Truth:
    """exitance: (n,) W/mm^2; noise: how far it may itself be off, relative RMS."""

    exitance: np.ndarray
    noise: float = 0.0


TruthOf = Callable[[Scheme], Truth]


class FineTruths:
    """Truths of several media in one body and light, on the body's mesh with its tets cut in eight twice.

    Three media share a solve. kept: a folder for solutions, under a key of all that enters them; None: none are kept.
    """

    def __init__(
        self, mesh: Graph, media: Sequence[Medium], q: Irradiance, direction: tuple, eta: float, kept: Path | None
    ) -> None:
        self._fine, self._media = [Fine(mesh, count) for count in (2, 1)], media
        self._light = (q, direction, eta)
        self._kept = kept
        self._found: dict[tuple, np.ndarray] = {}

    def of(self, index: int) -> TruthOf:
        """The truth for media[index]."""
        return lambda scheme: self._truth(index, scheme)

    def _truth(self, index: int, scheme: Scheme) -> Truth:
        group, channel = divmod(index, CHANNELS)
        fine, less = (self._exitance(fine, group, scheme)[:, channel] for fine in self._fine)
        _, _, area = meshes.face_frames(self._fine[0].coarse)
        size = float(area @ fine**2)
        # Halfway between first and second order: the finer of two meshes keeps half of what lies between them.
        noise = 0.5 * float(np.sqrt(area @ (fine - less) ** 2 / size)) if size > 0 else 0.0
        return Truth(fine, noise)

    def _exitance(self, fine: Fine, group: int, scheme: Scheme) -> np.ndarray:
        key = fine.count, group, scheme.source, scheme.model
        if key not in self._found:
            media = self._media[CHANNELS * group : CHANNELS * (group + 1)]
            self._found[key] = self._load(fine, media, scheme)
        return self._found[key]

    def _load(self, fine: Fine, media: Sequence[Medium], scheme: Scheme) -> np.ndarray:
        q, direction, eta = self._light

        def solved() -> np.ndarray:
            return fine.exitance(media, q, direction, eta, scheme.source, scheme.model)

        if self._kept is None:
            return solved()
        path = self._kept / f"stability-{self._key(fine, media, scheme)}.npy"
        if not path.is_file():
            self._kept.mkdir(parents=True, exist_ok=True)
            values = solved()
            with atomic_file.replacing(path) as stream:
                np.save(stream, values)
        return np.load(path)

    def _key(self, fine: Fine, media: Sequence[Medium], scheme: Scheme) -> str:
        """Media and light by what they are on the coarse mesh, whose nodes lie among the fine one's regions."""
        q, direction, eta = self._light
        centre, normal, _ = meshes.face_frames(fine.coarse)
        digest = hashlib.sha256(f"{fine.key} {direction} {eta} {scheme.source} {scheme.model}".encode())
        digest.update(np.ascontiguousarray(q(centre, normal)).tobytes())
        for medium in media:
            for values in medium(fine.coarse.nodes):
                digest.update(np.ascontiguousarray(values).tobytes())
        return digest.hexdigest()[:40]
