"""What the engine says of an unseen case in motion: its light turned and its material edited from frame to frame."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from quadgraph.api.engine import Engine
from quadgraph.api.lights import DirectionalLight, Light, PointLight, RectangleLight, SpotLight
from quadgraph.api.solution import Solution
from quadgraph.base.errors import InputError
from quadgraph_validation.bodies.smooth_sky import SmoothSky
from quadgraph_validation.bodies.unseen_cases import UnseenCase, UnseenMedium

FRAMES = 30
TURN = 3.0  # degrees from one frame to the next, about the upright line through the body's middle
EDIT = 0.3  # what the coefficients are above their own at first: they fall to these over the first half of the frames
STILL = 60  # frames after that in which nothing changes: a second at 60 a second
_TIMED = 8  # frames timed without the correction, and as many with it

# Exitance of the present solution by patch, (n,) W/mm^2.
Seen = Callable[[], np.ndarray]
Setter = Callable[[UnseenMedium, Light], None]


@dataclass(frozen=True, eq=False)
class UnseenMotion:
    """Of frames that end with the case's own light and material. Exitance (n,) W/mm^2 by patch: moving, in the last
    frame; still, after STILL more; flicker, what the last frame changed beyond what converged solves do. printed: the
    error that the last frame states, by part; segments: of its rays, a frame; seconds: a frame, and plain without the
    correction.
    """

    moving: np.ndarray
    still: np.ndarray
    flicker: np.ndarray
    printed: dict[str, float]
    segments: float
    seconds: float
    plain: float


def moved(
    engine: Engine, case: UnseenCase, show: Setter, seen: Seen, options: dict[str, Any], carry: int
) -> UnseenMotion:
    """Run the frames. show: sets material and light; options: of every solve; carry: frames from one with sweeps to the
    next. Raises what solves raise, and InputError for a case with a sky.
    """

    def quick(number: int) -> dict[str, Any]:
        swept = (number + 1) % carry == 0
        return options if swept else options | {"correction": False, "carry": True}

    show(*at_frame(case, -1))
    engine.solve(**options)
    times, segments = [], []
    before = now = np.empty(0)
    for frame in range(FRAMES):
        show(*at_frame(case, frame))
        seconds, solution = _timed(engine, quick(frame))
        times.append(seconds)
        segments.append(0.0 if solution.correction is None else solution.correction.segments)
        before, now = now, seen()
    printed = stated(solution)
    for number in range(FRAMES, FRAMES + STILL):
        engine.solve(motion=True, **quick(number))
    still = seen()
    exact = []
    for frame in (FRAMES - 2, FRAMES - 1):
        show(*at_frame(case, frame))
        engine.solve(**options)
        exact.append(seen())
    plain = []
    for frame in range(FRAMES, FRAMES + _TIMED):
        show(*at_frame(case, frame))
        plain.append(_timed(engine, options | {"correction": False})[0])
    usual = (float(np.mean(values[-_TIMED:])) for values in (segments, times, plain))
    return UnseenMotion(now, still, (now - before) - (exact[1] - exact[0]), printed, *usual)


def stated(solution: Solution) -> dict[str, float]:
    """Return the error that a solve states, by part; empty if none."""
    return {} if solution.error is None else asdict(solution.error)


def _timed(engine: Engine, options: dict[str, Any]) -> tuple[float, Solution]:
    start = time.perf_counter()
    solution = engine.solve(motion=True, **options)
    return time.perf_counter() - start, solution


def at_frame(case: UnseenCase, frame: int) -> tuple[UnseenMedium, Light]:
    """Material and light of a frame; those of FRAMES - 1 are the case's own. Raises InputError for a sky."""
    if isinstance(case.light, SmoothSky):
        raise InputError("a sky does not turn in this study; take --lights beams with --motion")
    low, high = case.surface.vertices.min(axis=0), case.surface.vertices.max(axis=0)
    light = turned(case.light, TURN * (frame - (FRAMES - 1)), (low + high) / 2)
    return edited(case.medium, 1 + EDIT * max(1 - max(frame, 0) / (FRAMES // 2), 0)), light


def edited(medium: UnseenMedium, factor: float) -> UnseenMedium:
    """The medium with its coefficients times a factor."""
    if factor == 1:
        return medium
    scattering, absorption = (np.float32(factor) * c for c in (medium.sigma_s_prime, medium.sigma_a))
    return replace(medium, sigma_s_prime=scattering, sigma_a=absorption)


def turned(light: Light, degrees: float, centre: np.ndarray) -> Light:
    """The light turned about the upright line through `centre`, mm."""
    if degrees == 0:
        return light
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])

    def way(vector: Any) -> tuple[float, float, float]:
        x, y, z = (float(f"{value:.9g}") for value in turn @ vector)
        return x, y, z

    def place(point: Any) -> tuple[float, float, float]:
        x, y, z = (float(f"{value:.9g}") for value in turn @ (point - centre) + centre)
        return x, y, z

    match light:
        case DirectionalLight():
            return replace(light, direction=way(light.direction))
        case PointLight():
            return replace(light, position=place(light.position))
        case SpotLight():
            return replace(light, position=place(light.position), direction=way(light.direction))
        case RectangleLight():
            return replace(light, centre=place(light.centre), u=way(light.u), v=way(light.v))
        case _:
            raise InputError(f"a light of kind {light.type} is not turned in this study")
