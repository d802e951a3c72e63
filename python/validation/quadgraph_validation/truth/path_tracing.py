"""Pictures of real bodies by path tracing with Mitsuba, in batches that add up: the transport truth.

Isotropic phase function; an index-matched surface (eta 1) or a smooth dielectric. Nothing of the package's own
equations enters but the place of the camera.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.base import extra_module
from quadgraph_validation.bodies.scenes import (
    FOV,
    PIXELS,
    Grid,
    StudyScene,
    View,
    bounding_sphere,
    camera_axes,
    of_medium,
)

MITSUBA = "3.9.1"
SCALAR, COMPILED = "scalar_rgb", "llvm_ad_rgb"  # variants: one path after the other; many at once, by LLVM
BATCH = 16  # samples a pixel
_BLACK = 1e3  # 1/mm, absorption of the body whose surface reflection is taken away


@dataclass(frozen=True)
class PathEnds:
    """When paths end. scatterings: the most of a path, None: any number; roulette: events from which on Russian
    roulette may end it. The truth does without: with it, thick bodies of high albedo get heavy tails.
    """

    scatterings: int | None = None
    roulette: int = 100_000

    def integrator(self, eta: float) -> dict[str, Any]:
        """Mitsuba's. It counts what a refracting surface does to a path as well: ways in and out are allowed for, and
        each reflection on the inside takes the place of a scattering.
        """
        surface = 0 if eta == 1 else 2
        depth = -1 if self.scatterings is None else self.scatterings + 1 + surface
        return {"type": "volpath", "max_depth": depth, "rr_depth": self.roulette}


def settings() -> dict[str, Any]:
    """What a picture depends on beside the scene, ready for JSON."""
    return {"mitsuba": MITSUBA, "variant": SCALAR, "integrator": PathEnds().integrator(1), "batch": BATCH}


def load_mitsuba(variant: str = SCALAR) -> Any:
    """Import Mitsuba in a variant. Raises InputError if it is absent, of another version, or has none of that name."""
    mitsuba = extra_module.load("mitsuba", "truth")
    if mitsuba.__version__ != MITSUBA:
        raise InputError(f"Mitsuba: version {mitsuba.__version__} found, the truth is made with {MITSUBA}")
    if variant != SCALAR and not _runs(variant):
        raise InputError(
            f"Mitsuba: variant {variant}: a first picture ended its process; llvm variants want a newer LLVM "
            "(19 runs), whose libLLVM.so $DRJIT_LIBLLVM_PATH can name"
        )
    mitsuba.set_variant(variant)
    return mitsuba


@cache
def _runs(variant: str) -> bool:
    """Whether a process outlives a picture by it: an LLVM that lacks an instruction aborts."""
    tried = f"from {__name__} import draw_first; draw_first({variant!r})"
    return subprocess.run([sys.executable, "-c", tried], capture_output=True, check=False).returncode == 0


def draw_first(variant: str) -> None:
    """Trace a block of a few pixels. Where the variant cannot compile it, the process may end."""
    mitsuba = extra_module.load("mitsuba", "truth")
    mitsuba.set_variant(variant)
    one = np.ones((1, 1, 1), np.float32)
    block = trimesh.creation.box()
    coefficients, views = of_medium([1.0] * 3, [1.0] * 3), {"A": View(0, 0, 3, ())}
    scene = StudyScene("block", "", 1.0, coefficients, 1.0, (0.0, 0.0, -1.0), views)
    surface = Surface(np.asarray(block.vertices, np.float64), np.asarray(block.faces, np.int64))
    with tempfile.TemporaryDirectory(prefix="quadgraph-truth-") as folder:
        grid = Grid(np.full(3, -0.5), 1.0, one, one)
        Tracer(mitsuba, scene, surface, grid, "A", Path(folder), PathEnds(), 8).whole(4, 1)


@contextmanager
def tracer(
    scene: StudyScene,
    surface: Surface,
    grid: Grid,
    view: str,
    ends: PathEnds | None = None,
    pixels: int = PIXELS,
    variant: str = SCALAR,
) -> Iterator[Tracer]:
    """Set up one view of a scene, in pictures of so many pixels an edge; its meshes live in a temporary folder.

    Raises InputError without Mitsuba.
    """
    with tempfile.TemporaryDirectory(prefix="quadgraph-truth-") as folder:
        yield Tracer(load_mitsuba(variant), scene, surface, grid, view, Path(folder), ends or PathEnds(), pixels)


class Tracer:
    """One view of a scene, ready to render batch after batch."""

    def __init__(
        self,
        mitsuba: Any,
        scene: StudyScene,
        surface: Surface,
        grid: Grid,
        view: str,
        folder: Path,
        ends: PathEnds,
        pixels: int,
    ) -> None:
        self._mitsuba, self._scene, self._pixels = mitsuba, scene, pixels
        # Mitsuba moves rays off a surface by a share of the coordinates: they are kept small.
        centre, _ = bounding_sphere(surface)
        mesh = folder / "body.ply"
        trimesh.Trimesh(surface.vertices - centre, surface.triangles, process=False).export(mesh)
        common = {"type": "scene", "integrator": ends.integrator(scene.eta)}
        common |= {"light": self._light(), "camera": self._camera(view)}
        body = {"type": "ply", "filename": str(mesh), "face_normals": True, "bsdf": self._surface()}
        self._whole = mitsuba.load_dict(common | {"body": body | {"interior": self._medium(grid, centre)}})
        self._black = None
        if scene.eta != 1:
            black = {"type": "homogeneous", "albedo": 0.0, "sigma_t": _BLACK}
            self._black = mitsuba.load_dict(common | {"body": body | {"interior": black}})

    def batch(self, number: int) -> np.ndarray:
        """Radiance (h, w) W/(mm^2 sr), float64, top row first, of light that was inside the body: a mean over BATCH
        samples a pixel, each number with samples of its own.
        """
        return self.whole(BATCH, 2 * number) - self.reflected(BATCH, 2 * number + 1)

    def whole(self, samples: int, seed: int) -> np.ndarray:
        """All that the camera sees (h, w), W/(mm^2 sr), by so many samples a pixel."""
        return self._render(self._whole, samples, seed)

    def reflected(self, samples: int, seed: int) -> np.ndarray | float:
        """Of that, what never was inside the body; 0 of an index-matched one in parallel light, which nobody sees."""
        return 0.0 if self._black is None else self._render(self._black, samples, seed)

    def _render(self, scene: Any, samples: int, seed: int) -> np.ndarray:
        return np.array(self._mitsuba.render(scene, spp=samples, seed=seed), np.float64)[..., 0]

    def _light(self) -> dict[str, Any]:
        if self._scene.direction is None:
            return {"type": "constant", "radiance": {"type": "rgb", "value": 1 / np.pi}}
        one = {"type": "rgb", "value": 1.0}
        return {"type": "directional", "direction": list(self._scene.direction), "irradiance": one}

    def _camera(self, view: str) -> dict[str, Any]:
        _, up, backward = camera_axes(self._scene.views[view])
        eye = backward * self._scene.views[view].distance
        place = self._mitsuba.ScalarTransform4f().look_at(origin=eye.tolist(), target=[0, 0, 0], up=up.tolist())
        film = {"type": "hdrfilm", "width": self._pixels, "height": self._pixels, "rfilter": {"type": "box"}}
        film |= {"pixel_format": "luminance", "component_format": "float32"}
        shape = {"type": "perspective", "fov": FOV, "fov_axis": "y", "near_clip": 1.0, "far_clip": 1e4}
        return shape | {"to_world": place, "film": film, "sampler": {"type": "independent"}}

    def _surface(self) -> dict[str, Any]:
        if self._scene.eta == 1:
            return {"type": "null"}
        return {"type": "dielectric", "int_ior": self._scene.eta, "ext_ior": 1.0}

    def _medium(self, grid: Grid, centre: np.ndarray) -> dict[str, Any]:
        sigma_t = grid.sigma_s_prime + grid.sigma_a
        albedo = grid.sigma_s_prime / sigma_t
        return {
            "type": "heterogeneous",
            "albedo": self._volume(albedo, grid, centre),
            "sigma_t": self._volume(sigma_t, grid, centre),
            "phase": {"type": "isotropic"},
        }

    def _volume(self, values: np.ndarray, grid: Grid, centre: np.ndarray) -> dict[str, Any]:
        place = self._mitsuba.ScalarTransform4f().translate((grid.low - centre).tolist()).scale(grid.extent.tolist())
        return {
            "type": "gridvolume",
            "grid": self._mitsuba.VolumeGrid(np.ascontiguousarray(values[..., None], np.float32)),
            "filter_type": "nearest",
            "raw": True,
            "to_world": place,
        }
