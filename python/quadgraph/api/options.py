"""Options by name, as scene files have them (docs/scene.md): what is left out is the engine's default.

Plain dicts at run time. Names and values are checked by the engine, which raises InputError with what is allowed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypedDict

from quadgraph.api.choices import Filter, Method, Model, PathCost, PathSolver, Radiance, Solver, Source, Tone
from quadgraph.api.values import RGB, Vector


class PathOptions(TypedDict, total=False):
    """Options of the method shortest-path (docs/shortest-path.md).

    cost: of a mm of path; solver: any path, or steps between the 26 neighbours of a voxel; cells: voxels along the
    longest side, 8 to 150.
    """

    cost: PathCost
    solver: PathSolver
    cells: int


class SolveOptions(TypedDict, total=False):
    """What a solve is asked (engine/base/solve_options.h; docs/engine.md, "Solvers").

    tolerance: stop when the exitance is estimated to be solved to this relative RMS error; error: stop when that and
    the mesh's together are below it, 0 for no target; cycles: exactly so many iterations on the finest level, 0 for as
    many as it takes; max_iterations: per level; inter_reflection: whether it is computed; bounces: of that, 0 until
    nothing changes; correction: by sweeps of the transport equation; sweeps: how many, 0 until another one would change
    little; sweep_points: where one evaluates it at a time; sweep_seed: what these are drawn by; certify: seconds in
    which random walks measure the error, 0 for none; guided_walks: whether these are led by importance;
    active_layers: of a polygrid, 0 for all; path: of the method shortest-path.
    """

    method: Method
    solver: Solver
    source: Source
    model: Model
    tolerance: float
    error: float
    cycles: int
    max_iterations: int
    inter_reflection: bool
    bounces: int
    correction: bool
    sweeps: int
    sweep_points: int
    sweep_seed: int
    certify: float
    guided_walks: bool
    active_layers: int
    path: PathOptions


class MotionOptions(SolveOptions, total=False):
    """What `Engine.solve` takes besides, for bodies in motion; scenes have none of it.

    warm: start from the last solution of the same method and model; smoothing: steps of a cycle before and after its
    correction, 0 to 2, 0 for what is cheapest; exchange_rows: faces of a body that deforms which look anew at what they
    see, in each solve, 0 for all; mean_rays: isotropic light by one ray from an origin instead of eight, rays that end
    with 1% of their light instead of .01%, and fewer samples of shadows; carry: without correction, what the last one
    made of the exitance is carried on as a factor.
    """

    warm: bool
    smoothing: int
    exchange_rows: int
    mean_rays: bool
    carry: bool


MOTION = MotionOptions.__annotations__.keys() - SolveOptions.__annotations__.keys()


class Camera(TypedDict, total=False):
    """Where a picture is taken from, degrees and mm.

    azimuth: left out, the body's front; elevation: above the ground; distance: left out, the body fits; up: "y" or "z";
    fov: vertical; target: from the object's centre, what the middle of the picture shows; eye, look_at: places in the
    body's coordinates, together and in place of azimuth, elevation, distance and target; orthographic: parallel rays,
    with which the picture's height shows so many mm, 0 for the whole body; aperture: diameter of the lens, mm, 0 for a
    picture that is sharp everywhere; focus: how far before the eye it is sharp, mm along the view, left out for what is
    nearest in the middle of the picture; framing: what fits without a distance, "outline" of the body in this picture,
    "turned" for that in any as the body turns, "auto" for turned where tracks move the camera.
    """

    azimuth: float
    elevation: float
    distance: float
    up: Literal["y", "z"]
    fov: float
    target: Vector
    eye: Vector
    look_at: Vector
    orthographic: float
    aperture: float
    focus: float
    framing: Literal["auto", "outline", "turned"]


class PictureOptions(TypedDict, total=False):
    """What a picture shows, and how.

    width, height: pixels, 1 to 16384; samples: of a pixel, four at a time, 0 for 16, or 256 with an aperture; filter:
    how they are weighed around the middle of a pixel; converge: the error down to which corrections and samples run
    on, 0 for none; time_limit: seconds for that, 0 for no limit; roughness: of the surface, GGX alpha, left out, the
    material's; transmission_roughness: the same for light that goes in and out, left out, as rough; radiance: how
    it leaves the surface; show: "picture", or what is inside (docs/window.md, "Views of the
    inside"); ground: its shadow where the body stands, and its light; surroundings: what environment lights show,
    behind it; roughness_map, normal_map: as in scene files; exposure: "auto" or stops; tone: the curve from radiance to
    a screen; white_balance: kelvin of the light that is shown white, 6504 for none changed; background: "studio",
    "black", "white", "transparent" (PNG only), a grey, three numbers, or {"top": ..., "bottom": ...}, linear.
    """

    width: int
    height: int
    samples: int
    filter: Filter
    converge: float
    time_limit: float
    roughness: float
    transmission_roughness: float
    radiance: Radiance
    show: str
    ground: bool
    surroundings: bool
    roughness_map: Mapping[str, Any]
    normal_map: Mapping[str, Any]
    exposure: float | Literal["auto"]
    tone: Tone
    white_balance: float
    background: str | RGB | Mapping[str, RGB] | Sequence[float]
