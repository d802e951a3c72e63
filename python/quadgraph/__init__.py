"""Real-time rendering of heterogeneous translucent objects, with an error that is known.

Lengths are millimetres, coefficients 1/mm, fluence and exitance W/mm^2, radiance W/(mm^2 sr), angles degrees. Arrays of
channels end in three columns: red, green, blue.
"""

import importlib
from typing import TYPE_CHECKING

from quadgraph.base.version import __version__

if TYPE_CHECKING:
    from quadgraph.api.browser_view import BrowserView
    from quadgraph.api.colour_config import ColourConfig
    from quadgraph.api.deformers import (
        Bend,
        Cage,
        Deformer,
        Displaced,
        Lattice,
        Shapes,
        Stretch,
        Taper,
        Transform,
        Twist,
    )
    from quadgraph.api.derivatives import ForwardModel, Gradient, Outgoing, Views
    from quadgraph.api.engine import Engine
    from quadgraph.api.fields import Fluence, SurfaceField, WalkedExitance
    from quadgraph.api.lights import (
        AmbientLight,
        DirectionalLight,
        EnvironmentLight,
        Light,
        PointLight,
        ProjectorLight,
        RectangleLight,
        SpotLight,
        default_lights,
    )
    from quadgraph.api.materials import Material, VolumeMaterial, material_names
    from quadgraph.api.options import Camera, MotionOptions, PathOptions, PictureOptions, SolveOptions
    from quadgraph.api.picture import Convergence, ConvergenceStep, Picture
    from quadgraph.api.scene import Scene, SceneFile
    from quadgraph.api.solution import (
        Certificate,
        CertifiedPart,
        CorrectedSweep,
        Correction,
        Energy,
        ErrorEstimate,
        LevelReport,
        PathReport,
        Solution,
    )
    from quadgraph.api.stage import Stage
    from quadgraph.api.tensors import OutgoingTensors, outgoing_tensors
    from quadgraph.api.volume_map import MapReport, VolumeMap
    from quadgraph.baking.bodies import BodyMesh, bake_bodies
    from quadgraph.baking.colours.colour_options import ColourOptions
    from quadgraph.baking.colours.colour_report import ColourReport
    from quadgraph.baking.colours.colour_volume import mesh_colours
    from quadgraph.baking.pipeline import BakeOptions, bake
    from quadgraph.baking.placing import BodyPlacement
    from quadgraph.baking.report import BakeReport
    from quadgraph.base.errors import (
        DeviceError,
        FormatError,
        InputError,
        QuadGraphError,
        SolverError,
        ToolError,
    )

__all__ = [
    "AmbientLight",
    "BakeOptions",
    "BakeReport",
    "Bend",
    "BodyMesh",
    "BodyPlacement",
    "BrowserView",
    "Cage",
    "Camera",
    "Certificate",
    "CertifiedPart",
    "ColourConfig",
    "ColourOptions",
    "ColourReport",
    "Convergence",
    "ConvergenceStep",
    "CorrectedSweep",
    "Correction",
    "Deformer",
    "DeviceError",
    "DirectionalLight",
    "Displaced",
    "Energy",
    "Engine",
    "EnvironmentLight",
    "ErrorEstimate",
    "Fluence",
    "FormatError",
    "ForwardModel",
    "Gradient",
    "InputError",
    "Lattice",
    "LevelReport",
    "Light",
    "MapReport",
    "Material",
    "MotionOptions",
    "Outgoing",
    "OutgoingTensors",
    "PathOptions",
    "PathReport",
    "Picture",
    "PictureOptions",
    "PointLight",
    "ProjectorLight",
    "QuadGraphError",
    "RectangleLight",
    "Scene",
    "SceneFile",
    "Shapes",
    "Solution",
    "SolveOptions",
    "SolverError",
    "SpotLight",
    "Stage",
    "Stretch",
    "SurfaceField",
    "Taper",
    "ToolError",
    "Transform",
    "Twist",
    "Views",
    "VolumeMap",
    "VolumeMaterial",
    "WalkedExitance",
    "__version__",
    "bake",
    "bake_bodies",
    "default_lights",
    "material_names",
    "mesh_colours",
    "outgoing_tensors",
]

# Where the public names live: found when they are first asked for, so that the command line starts without them.
_PLACES = {
    "quadgraph.api.browser_view": "BrowserView",
    "quadgraph.api.colour_config": "ColourConfig",
    "quadgraph.api.deformers": "Bend Cage Deformer Displaced Lattice Shapes Stretch Taper Transform Twist",
    "quadgraph.api.derivatives": "ForwardModel Gradient Outgoing Views",
    "quadgraph.api.engine": "Engine",
    "quadgraph.api.fields": "Fluence SurfaceField WalkedExitance",
    "quadgraph.api.lights": "AmbientLight DirectionalLight EnvironmentLight Light PointLight ProjectorLight "
    "RectangleLight SpotLight default_lights",
    "quadgraph.api.materials": "Material VolumeMaterial material_names",
    "quadgraph.api.options": "Camera MotionOptions PathOptions PictureOptions SolveOptions",
    "quadgraph.api.picture": "Convergence ConvergenceStep Picture",
    "quadgraph.api.scene": "Scene SceneFile",
    "quadgraph.api.solution": "Certificate CertifiedPart CorrectedSweep Correction Energy ErrorEstimate LevelReport "
    "PathReport Solution",
    "quadgraph.api.stage": "Stage",
    "quadgraph.api.tensors": "OutgoingTensors outgoing_tensors",
    "quadgraph.api.volume_map": "MapReport VolumeMap",
    "quadgraph.baking.bodies": "BodyMesh bake_bodies",
    "quadgraph.baking.placing": "BodyPlacement",
    "quadgraph.baking.colours.colour_options": "ColourOptions",
    "quadgraph.baking.colours.colour_report": "ColourReport",
    "quadgraph.baking.colours.colour_volume": "mesh_colours",
    "quadgraph.baking.pipeline": "BakeOptions bake",
    "quadgraph.baking.report": "BakeReport",
    "quadgraph.base.errors": "FormatError InputError QuadGraphError SolverError ToolError DeviceError",
}


def __getattr__(name: str) -> object:
    for place, names in _PLACES.items():
        if name in names.split():
            globals()[name] = found = getattr(importlib.import_module(place), name)
            return found
    raise AttributeError(f"module 'quadgraph' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
