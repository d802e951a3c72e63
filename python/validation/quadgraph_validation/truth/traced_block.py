"""A homogeneous block without reflection by Mitsuba: photographs of it, and its coefficients by `prbvolpath`.

Rectangles light it, cameras are perspective ones, as captures have both; where a coefficient leads is said by Mitsuba's
own derivatives of its walks, and followed by Adam's method in logarithms.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quadgraph_validation.base import extra_module
from quadgraph_validation.truth import path_tracing

ROULETTE = 50  # events from which on paths may end by chance: from Mitsuba's 5 on they get heavy tails
_SCALE = 10.0  # 1/mm, of extinction: Mitsuba takes numbers from 0 to 1 for colours
_EXTINCTION, _ALBEDO = "body.interior_medium.sigma_t.value.value", "body.interior_medium.albedo.value.value"


@dataclass(frozen=True, eq=False)
class WantedPicture:
    """A photograph to be met: camera and light as captures state them; radiance (h, w, 3), and its variance."""

    camera: dict[str, Any]
    light: dict[str, Any]
    radiance: np.ndarray
    variance: np.ndarray


@dataclass(frozen=True)
class Descent:
    """How coefficients are followed. samples: of a pixel in each step; rate: of Adam's steps; steps: how many; start:
    sigma_a and sigma_s', (2,), 1/mm, of all channels; threads.
    """

    samples: int
    rate: float
    steps: int
    start: tuple[float, float]
    threads: int


@dataclass(frozen=True)
class DescentStep:
    """After a step: seconds by the clock and of processors since the beginning, and (2, 3) sigma_a and sigma_s'."""

    seconds: float
    processor_s: float
    coefficients: np.ndarray


class TracedBlock:
    """A block of `sides` (3,) mm around the origin, in Mitsuba. Raises InputError without it, or without its LLVM."""

    def __init__(self, sides: np.ndarray, threads: int) -> None:
        """Load Mitsuba."""
        self._mitsuba = path_tracing.load_mitsuba(path_tracing.COMPILED)
        self._drjit = extra_module.load("drjit", "truth")
        self._drjit.set_thread_count(threads)
        self._sides = sides

    def scene(
        self, camera: dict[str, Any], light: dict[str, Any], coefficients: np.ndarray, kind: str = "volpath"
    ) -> Any:
        """One photograph's. coefficients: (2, 3), sigma_a and sigma_s', 1/mm; kind: of Mitsuba's integrators."""
        transform = self._mitsuba.ScalarTransform4f
        centre, u, v = (np.array(light[name], np.float64) for name in ("centre", "u", "v"))
        normal = np.cross(u, v)
        area = np.linalg.norm(normal)
        place = np.eye(4)
        place[:3] = np.column_stack([u / 2, v / 2, normal / area, centre])
        radiance = np.broadcast_to(light["power"], 3) / (np.pi * area)
        emitter = {"type": "area", "radiance": {"type": "rgb", "value": radiance.tolist()}}
        up = [0, 1, 0] if camera["up"] == "y" else [0, 0, 1]
        film = {"type": "hdrfilm", "width": camera["width"], "height": camera["height"], "rfilter": {"type": "box"}}
        film |= {"pixel_format": "rgb", "component_format": "float32"}
        eye = {"type": "perspective", "fov": camera["fov"], "fov_axis": "y", "near_clip": 1.0, "far_clip": 1e4}
        eye |= {"to_world": transform().look_at(origin=camera["eye"], target=camera["look_at"], up=up), "film": film}
        body = {"type": "cube", "to_world": transform().scale((self._sides / 2).tolist()), "bsdf": {"type": "null"}}
        return self._mitsuba.load_dict(
            {
                "type": "scene",
                "integrator": {"type": kind, "max_depth": -1, "rr_depth": ROULETTE},
                "light": {"type": "rectangle", "to_world": transform(place), "emitter": emitter},
                "camera": eye | {"sampler": {"type": "independent"}},
                "body": body | {"interior": _medium(coefficients)},
            }
        )

    def seen(self, scene: Any, samples: int, batches: int) -> tuple[np.ndarray, np.ndarray]:
        """Radiance (h, w, 3), by `batches` times so many samples a pixel, and its standard errors."""
        pictures = [np.array(self._mitsuba.render(scene, spp=samples, seed=number)) for number in range(batches)]
        each = np.array(pictures, np.float64)
        return each.mean(axis=0), each.std(axis=0) / np.sqrt(batches - 1)

    def descend(self, shots: Sequence[WantedPicture], how: Descent, tell: Callable[[int], None]) -> list[DescentStep]:
        """Follow the coefficients to where all shots are met best. tell: is given the number of each step."""
        mitsuba, drjit = self._mitsuba, self._drjit
        begun, used = time.perf_counter(), time.process_time()
        start = np.broadcast_to(np.array(how.start)[:, None], (2, 3))
        scenes = [self.scene(shot.camera, shot.light, start, "prbvolpath") for shot in shots]
        parameters = [mitsuba.traverse(scene) for scene in scenes]
        wanted = [mitsuba.TensorXf(shot.radiance.astype(np.float32)) for shot in shots]
        weights = [mitsuba.TensorXf((1 / shot.variance).astype(np.float32)) for shot in shots]
        optimiser = mitsuba.ad.Adam(lr=how.rate)
        for name, value in zip(("absorption", "scattering"), np.log(start), strict=True):
            optimiser[name] = mitsuba.Color3f(*value.tolist())
        steps = []
        for number in range(how.steps):
            tell(number)
            for k, (scene, members) in enumerate(zip(scenes, parameters, strict=True)):
                absorption, scattering = drjit.exp(optimiser["absorption"]), drjit.exp(optimiser["scattering"])
                members[_EXTINCTION] = (absorption + scattering) / _SCALE
                members[_ALBEDO] = scattering / (absorption + scattering)
                members.update()
                seed = 2 * (number * len(scenes) + k)
                seen = mitsuba.render(scene, members, spp=how.samples, seed=seed, seed_grad=seed + 1)
                drjit.backward(drjit.mean((seen - wanted[k]) ** 2 * weights[k], axis=None))
            optimiser.step()
            found = np.exp([np.array(optimiser[name]).ravel() for name in ("absorption", "scattering")])
            steps.append(DescentStep(time.perf_counter() - begun, time.process_time() - used, found))
        return steps


def _medium(coefficients: np.ndarray) -> dict[str, Any]:
    absorption, scattering = coefficients
    extinction = absorption + scattering
    return {
        "type": "homogeneous",
        "albedo": {"type": "rgb", "value": (scattering / extinction).tolist()},
        "sigma_t": {"type": "rgb", "value": (extinction / _SCALE).tolist()},
        "scale": _SCALE,
        "phase": {"type": "isotropic"},
    }
