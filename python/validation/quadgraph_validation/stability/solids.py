"""Maps over bodies without a closed form: truth is the same equations on the body's mesh cut finer."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies import meshes
from quadgraph_validation.stability import deformed_shapes
from quadgraph_validation.stability.fine_truths import FineTruths
from quadgraph_validation.stability.judged_points import StabilityCase
from quadgraph_validation.stability.scaled_chains import Medium, ScaledChain, Shape, even
from quadgraph_validation.stability.stability_maps import Axis, CaseOf, Map, StabilitySetting

ETA = 1.0  # there the published boundary condition is the same as ours
SLANTED = (0.48, 0.0, -0.8772684879784524)  # the way light travels
JUMPS = (1.0, 10.0, 100.0, 1e4)
RADIUS = 5.0  # mm
PILLAR = (1.5, 1.5)  # mm: its axis, parallel to z, is at this x; its radius


def slanted_light(centre: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Parallel light of 1 W/mm^2 that nothing shadows."""
    return np.clip(-(normal @ np.array(SLANTED)), 0, None)


class _Scenes:
    """Cases of several media in one body, whose truths share solves."""

    def __init__(self, setting: StabilitySetting, chain: ScaledChain, media: Sequence[Medium]) -> None:
        self.chain, self.media = chain, media
        self.truths = FineTruths(chain.rest[0], media, slanted_light, SLANTED, ETA, setting.kept)

    def case(self, index: int) -> StabilityCase:
        return StabilityCase(self.chain, self.media[index], slanted_light, SLANTED, ETA, self.truths.of(index))


def ball(device: str) -> ScaledChain:
    """A sphere of 5 mm radius, on elements of about 1 mm and coarser ones."""
    return ScaledChain(lambda: [meshes.ball(RADIUS, 0, subdivisions) for subdivisions in (3, 2, 1)], device)


def pillar(kappa_jump: float, absorption_jump: float) -> Medium:
    """Mean free path 1 mm and sigma_a 1e-4/mm, but for a pillar along z with kappa over the one and sigma_a times the
    other.
    """

    def medium(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        inside = np.hypot(points[:, 0] - PILLAR[0], points[:, 1]) < PILLAR[1]
        sigma_t, sigma_a = np.where(inside, kappa_jump, 1.0), 1e-4 * np.where(inside, absorption_jump, 1.0)
        return sigma_t - sigma_a, sigma_a

    return medium


def _by_jumps(setting: StabilitySetting, kappa_jumps: Sequence[float], absorption_jumps: Sequence[float]) -> CaseOf:
    pairs = [(x, y) for y in absorption_jumps for x in kappa_jumps]
    scenes = _Scenes(setting, ball(setting.device), [pillar(*pair) for pair in pairs])
    return lambda x, y: scenes.case(pairs.index((x, y)))


def _by_needles(setting: StabilitySetting, aspects: Sequence[float], paths: Sequence[float]) -> CaseOf:
    media = [even(0.95 / path, 0.05 / path) for path in paths]

    @cache
    def scenes(aspect: float) -> _Scenes:
        return _Scenes(setting, ScaledChain(lambda: deformed_shapes.rod(aspect), setting.device), media)

    return lambda x, y: scenes(x).case(paths.index(y))


def _by_genus(setting: StabilitySetting, genera: Sequence[float], paths: Sequence[float]) -> CaseOf:
    media = [even(0.95 / path, 0.05 / path) for path in paths]

    @cache
    def scenes(genus: float) -> _Scenes:
        return _Scenes(setting, ScaledChain(lambda: deformed_shapes.lattice(int(genus)), setting.device), media)

    return lambda x, y: scenes(x).case(paths.index(y))


def _by_quality(setting: StabilitySetting, angles: Sequence[float], volumes: Sequence[float]) -> CaseOf:
    medium = even(0.475, 0.025)

    @cache
    def chain(angle: float) -> ScaledChain:
        return ScaledChain(lambda: deformed_shapes.with_slivers(deformed_shapes.block(), angle), setting.device)

    @cache
    def shape(volume: float) -> Shape:
        return deformed_shapes.squeezed(volume)

    @cache
    def truths(volume: float) -> FineTruths:
        """Truth from the mesh whose inside has not been spoilt: the body is the same."""
        mesh: Graph = meshes.moved(deformed_shapes.block()[0], shape(volume))
        return FineTruths(mesh, [medium], slanted_light, SLANTED, ETA, setting.kept)

    def case(angle: float, volume: float) -> StabilityCase:
        of_chain = chain(angle), medium, slanted_light, SLANTED, ETA
        return StabilityCase(*of_chain, lambda scheme: truths(volume).of(0)(scheme), shape(volume))

    return case


_FINER = "the same equations on a mesh cut finer twice"
MAPS = (
    Map(
        "jumps",
        "sphere with a pillar of another medium, mean free path about an element around it, eta 1, parallel light",
        _FINER,
        Axis("kappa-jump", "kappa around the pillar / kappa in it", JUMPS),
        Axis("sigma-a-jump", "sigma_a in the pillar / sigma_a around it", JUMPS),
        _by_jumps,
    ),
    Map(
        "quality",
        "cube with slivers inside, squeezed across its middle, mean free path two elements, eta 1, parallel light",
        _FINER,
        Axis("dihedral", "smallest dihedral angle at rest, degrees", (18, 10, 1, 0.1, 0.01)),
        Axis("deformation", "smallest volume of a tet / at rest", (1, 0.3, 0.1, 0.01, 0.001, -0.1)),
        _by_quality,
    ),
    Map(
        "needles",
        "rod of needles, albedo .95, eta 1, parallel light",
        _FINER,
        Axis("dihedral", "length / width of an element", (1, 10, 100, 1000)),
        Axis("mean-free-path", "mean free path / width of an element", (0.1, 1, 10)),
        _by_needles,
    ),
    Map(
        "genus",
        "lattice of struts, albedo .95, eta 1, parallel light that the struts do not shadow",
        _FINER,
        Axis("genus", "genus", (0, 1, 5, 28)),
        Axis("thickness", "mean free path / thickness of a strut", (0.1, 1, 10)),
        _by_genus,
    ),
)
