"""Errors of a method's answer against both truths, over everything and over the unlit part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from quadgraph.baking.budget import surface_errors
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_method import ChartMethod, pde_of, walks_judge
from quadgraph_validation.truth import blocks
from quadgraph_validation.truth.pde_truth import PdeTruth
from quadgraph_validation.truth.scene_walks import SceneWalks
from quadgraph_validation.truth.stored_truth import StoredTruth

_FEW = 10  # blocks: fewer are no part

# Model and source to the truth of that PDE.
PdeTruths = Mapping[tuple[str, str], PdeTruth]


@dataclass
class ChartJudge:
    """One scene's truths: of each PDE, path-traced by name of Scene.images, and random walks through the surface of the
    default bake, None without.

    What no PDE truth can judge is judged by transport alone.
    """

    body: ChartBody
    pde: PdeTruths
    images: Mapping[str, StoredTruth]
    walks: SceneWalks | None = None

    def errors(self, method: ChartMethod, pictures: Mapping[str, np.ndarray]) -> dict[str, dict[str, float] | None]:
        """Relative RMS errors by truth and part, those of too small a part left out; None where a truth cannot tell.

        pictures: the method's by view, (PIXELS, PIXELS, 3).
        """
        equations = pde_of(method.settings)
        truth = self.pde.get(equations) if equations else None
        return {
            "pde": truth.error(method.settings["level"], method.exitance()) if truth else None,
            "transport": self._of_pictures(pictures),
            "walks": self._by_walks(method),
        }

    def of_picture(self, name: str, pictures: Mapping[str, np.ndarray]) -> np.ndarray:
        """What the truth of that name shows, from pictures by view; (PIXELS, PIXELS)."""
        image = self.body.scene.images[name]
        return pictures[image.view][..., image.channel]

    def noise(self) -> dict[str, dict[str, Any]]:
        """Noise of the truths: by PDE and part, of path tracing by part with the number of blocks, and of walks."""
        found = {part: self._deviation(self._true, chosen) for part, chosen in self._parts.items()}
        return {
            "pde": {", ".join(equations): truth.noise for equations, truth in self.pde.items()},
            "transport": {part: deviation.noise for part, deviation in found.items()},
            "walks": self.walks.noise if self.walks else {},
            "blocks": {part: deviation.blocks for part, deviation in found.items()},
        }

    def _of_pictures(self, pictures: Mapping[str, np.ndarray]) -> dict[str, float] | None:
        if not (self.images and pictures):
            return None
        found = np.vstack([self.of_picture(name, pictures) for name in self.images])
        return {part: self._deviation(found, chosen).rms for part, chosen in self._parts.items()}

    def _by_walks(self, method: ChartMethod) -> dict[str, float] | None:
        if self.walks is None or not walks_judge(method.settings):
            return None
        return self.walks.errors(method.exitance())

    def _deviation(self, found: np.ndarray, chosen: np.ndarray) -> blocks.Deviation:
        return blocks.deviation(found, self._true, self._error, chosen)

    @cached_property
    def _true(self) -> np.ndarray:
        return np.vstack([image.mean for image in self.images.values()])

    @cached_property
    def _error(self) -> np.ndarray:
        return np.vstack([image.error for image in self.images.values()])

    @cached_property
    def _parts(self) -> dict[str, np.ndarray]:
        """Blocks, bool, of all images below each other: those that the body covers, and of them the unlit ones."""
        if not self.images:
            return {}
        lit = self.body.lit()
        both = [self._of_view(lit, self.body.scene.images[name].view) for name in self.images]
        whole, unlit = (np.vstack(masks) for masks in zip(*both, strict=True))
        enough = unlit.sum() >= max(_FEW, surface_errors.LEAST_SHARE * whole.sum())
        return {"whole": whole} | ({"unlit": unlit} if enough else {})

    def _of_view(self, lit: np.ndarray, view: str) -> tuple[np.ndarray, np.ndarray]:
        light = self.body.hits(view).shown(self.body.display.triangles, lit[:, None].astype(float))[..., 0]
        covered = blocks.covered(self.body.coverage(view))
        return covered, covered & (blocks.means(light) == 0)
