"""Maps over slabs and half-spaces, whose solution is known in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from quadgraph.base.errors import QuadGraphError
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.stability.error_classes import Errors, classify
from quadgraph_validation.stability.fine_truths import FineTruth, TruthOf
from quadgraph_validation.stability.judged_points import StabilityCase, errors, point, refusal, solve
from quadgraph_validation.stability.scaled_chains import ScaledChain, even
from quadgraph_validation.stability.stability_maps import Axis, CaseOf, Map, StabilitySetting
from quadgraph_validation.stability.stability_methods import StabilityMethod
from quadgraph_validation.truth import closed_forms
from quadgraph_validation.truth.schemes import Scheme
from quadgraph_validation.truth.slab_transport import discrete_ordinates, entry

ETA = 1.3
ELEMENT = 1.0  # mm
LAYERS = 16
LEVELS = 3
SMALL_OF_MODEL = 0.04  # what SP3 is off by at most where it is meant (docs/physics.md, "Limits")
PATTERN_MEDIUM = (0.8, 1.0)  # albedo, mean free path in mm
INWARD = (0.0, 0.0, 1.0)

ALBEDOS = (1.0, 0.99, 0.9, 0.7, 0.5, 0.2, 0.02)
PATHS = (0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100)


def medium(albedo: float, mean_free_path: float) -> Medium:
    """The medium of an albedo and a mean free path in mm."""
    return Medium(albedo / mean_free_path, (1 - albedo) / mean_free_path)


def _slab(layers: int, device: str) -> ScaledChain:
    """A column of `layers` elements of 1 mm, and coarser levels; at least one element is left."""
    thickness, width = layers * ELEMENT, 4 * ELEMENT

    def graphs() -> list:
        counts = [(max(layers >> level, 1), max(4 >> level, 1)) for level in range(LEVELS)]
        return [meshes.column(np.full(n, thickness / n), width, across) for n, across in counts]

    return ScaledChain(graphs, device)


def _lit_below(centre: np.ndarray, normal: np.ndarray) -> np.ndarray:
    return (normal[:, 2] < -0.5).astype(np.float64)


def _both_sides(chain: ScaledChain, reflectance: float, transmittance: float) -> FineTruth:
    normal = meshes.face_frames(chain.graphs[0])[1][:, 2]
    return FineTruth(np.where(normal < -0.5, reflectance, np.where(normal > 0.5, transmittance, 0.0)))


def _closed_truth(chain: ScaledChain, inside: Medium, layers: int) -> TruthOf:
    def truth(scheme: Scheme) -> FineTruth:
        light = entry(False, ETA) if scheme.source == "buried" else None
        parts = (inside, layers * ELEMENT, scheme.model_of, scheme.boundary(ETA), ETA, light)
        found = closed_forms.slab(*parts)
        return _both_sides(chain, found.reflectance, found.transmittance)

    return truth


def _sides(chain: ScaledChain) -> np.ndarray:
    """Its walls cut the column's surface otherwise than a slab's: what a side lets out is compared as a whole."""
    return np.sign(np.round(meshes.face_frames(chain.graphs[0])[1][:, 2]))


def _slab_case(chain: ScaledChain, inside: Medium, truth: TruthOf) -> StabilityCase:
    medium_of = even(inside.sigma_s_prime, inside.sigma_a)
    return StabilityCase(chain, medium_of, _lit_below, INWARD, ETA, truth, regions=_sides)


def _by_albedo(setting: StabilitySetting, albedos: Sequence[float], paths: Sequence[float]) -> CaseOf:
    chain = _slab(LAYERS, setting.device)

    def case(albedo: float, path: float) -> StabilityCase:
        inside = medium(albedo, path * ELEMENT)
        return _slab_case(chain, inside, _closed_truth(chain, inside, LAYERS))

    return case


def _by_thickness(setting: StabilitySetting, thicknesses: Sequence[float], layers: Sequence[float]) -> CaseOf:
    chains = {count: _slab(int(count), setting.device) for count in layers}

    def case(thickness: float, count: float) -> StabilityCase:
        inside = medium(0.9, count * ELEMENT / thickness)
        return _slab_case(chains[count], inside, _closed_truth(chains[count], inside, int(count)))

    return case


def _of_transport(setting: StabilitySetting, albedos: Sequence[float], thicknesses: Sequence[float]) -> CaseOf:
    """Enough elements to tell the model's error alone."""
    count = 32
    chain = _slab(count, setting.device)

    def case(albedo: float, thickness: float) -> StabilityCase:
        inside = medium(albedo, count * ELEMENT / thickness)

        def truth(scheme: Scheme) -> FineTruth:
            found = discrete_ordinates(inside, count * ELEMENT, ETA, lambertian=False)
            return _both_sides(chain, found.reflectance, found.transmittance)

        return _slab_case(chain, inside, truth)

    return case


def judge_model(case: StabilityCase, method: StabilityMethod) -> dict[str, Any]:
    """The model's error, of which no estimate is made: small, or said to be large, or neither."""
    try:
        report = solve(case, method)
    except QuadGraphError as error:
        return refusal(error)
    truth = case.truth(Scheme(method.scheme.method, method.scheme.source, report["model"]))
    true, said = errors(case, case.chain.exitance, truth.exitance), [report["model_warning"]]
    name = classify(true, Errors(0.0), [text for text in said if text], small=SMALL_OF_MODEL)
    return point(name, true, None, report) | {"said": said}


def _half_space(wavelength: float, across: int, device: str) -> ScaledChain:
    """Half a period wide and `across` elements across, eight mean free paths deep or more: six diffusion lengths."""
    path = PATTERN_MEDIUM[1]

    def graphs() -> list:
        levels = []
        for level in range(LEVELS):
            cells = max(across >> level, 1)
            first = min(wavelength / 2 / cells, 4 * path)
            levels.append(meshes.half_period(wavelength, cells, meshes.graded(first, 1.3, 8 * path + 2 * first)))
        return levels

    return ScaledChain(graphs, device)


def _by_frequency(setting: StabilitySetting, wavelengths: Sequence[float], elements: Sequence[float]) -> CaseOf:
    albedo, path = PATTERN_MEDIUM
    inside = medium(albedo, path)

    @cache
    def chain_of(wavelength: float, per_period: float) -> ScaledChain:
        return _half_space(wavelength * path, int(per_period) // 2, setting.device)

    def case(wavelength: float, per_period: float) -> StabilityCase:
        chain, wave = chain_of(wavelength, per_period), 2 * np.pi / (wavelength * path)

        def q(centre: np.ndarray, normal: np.ndarray) -> np.ndarray:
            return np.where(normal[:, 2] < -0.5, 1 + np.cos(wave * centre[:, 0]), 0.0)

        def truth(scheme: Scheme) -> FineTruth:
            waves = np.array([np.inf, wavelength * path])
            parts = (scheme.model_of, scheme.boundary(ETA), scheme.source == "buried")
            flat, patterned = closed_forms.half_space_response(inside, waves, *parts)
            mesh = chain.graphs[0]
            corners = np.asarray(mesh.vertices)[mesh.faces][:, :, 0]
            lit = meshes.face_frames(mesh)[1][:, 2] < -0.5
            return FineTruth(np.where(lit, flat + patterned * _mean_cosine(wave * corners), 0.0))

        def strips(of: ScaledChain) -> np.ndarray:
            centre, normal, _ = meshes.face_frames(of.graphs[0])
            strip = np.floor(centre[:, 0] / (wavelength * path / per_period))
            return np.where(normal[:, 2] < -0.5, strip, -1)

        return StabilityCase(chain, even(inside.sigma_s_prime, inside.sigma_a), q, INWARD, ETA, truth, regions=strips)

    return case


def _mean_cosine(phases: np.ndarray, cuts: int = 8) -> np.ndarray:
    """Means (n,) of the cosine of a linear phase over triangles, from its values (n, 3) at their corners."""
    points = [((i + 1 / 3) / cuts, (j + 1 / 3) / cuts) for i in range(cuts) for j in range(cuts - i)]
    points += [((i + 2 / 3) / cuts, (j + 2 / 3) / cuts) for i in range(cuts) for j in range(cuts - 1 - i)]
    a, b = np.array(points).T
    return np.cos(phases @ np.vstack([1 - a - b, a, b])).mean(axis=1)


MAPS = (
    Map(
        "albedo",
        f"slab of {LAYERS} elements, eta {ETA:g}, light at normal incidence",
        "the model's closed form",
        Axis("albedo", "albedo", ALBEDOS),
        Axis("mean-free-path", "mean free path / element", PATHS),
        _by_albedo,
    ),
    Map(
        "thickness",
        f"slab, albedo .9, eta {ETA:g}, light at normal incidence",
        "the model's closed form",
        Axis("thickness", "thickness / mean free path", (0.01, 0.1, 0.3, 1, 3, 10, 30, 100)),
        Axis("elements", "elements through", (1, 2, 4, 8, 16, 32)),
        _by_thickness,
    ),
    Map(
        "frequency",
        f"half-space, albedo .8, eta {ETA:g}, irradiance 1 + cos(2 pi x / period) at normal incidence",
        "the model's closed form",
        Axis("frequency", "period / mean free path", (1, 3, 10, 30, 100)),
        Axis("elements", "elements per period", (4, 8, 16, 32)),
        _by_frequency,
    ),
)
TRANSPORT = Map(
    "transport",
    f"slab, eta {ETA:g}, light at normal incidence",
    "transport (discrete ordinates)",
    Axis("albedo", "albedo", ALBEDOS),
    Axis("thickness", "thickness / mean free path", (0.1, 0.3, 1, 3, 10, 30)),
    _of_transport,
    judge=judge_model,
)
