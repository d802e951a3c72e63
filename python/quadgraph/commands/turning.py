"""What goes around a body: the camera of a turntable, or lights, by an angle about the axis that points up.

Angles are degrees, counter-clockwise seen from above; places are mm in the coordinates of the body.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.commands.scene_options import numbers_of
from quadgraph.core import load_core

if TYPE_CHECKING:
    from quadgraph.core import Engine

_ELEVATION = 10.0  # degrees, of a camera that says none
_MOVED = ("point",)  # forms of members of lights that are places
_TURNED = ("direction", "edge", "top")  # those that are directions


def middle(engine: Engine) -> np.ndarray:
    """What the middle of a picture shows that names nothing else: that of the box around the body (3,), mm."""
    vertices = np.asarray(engine.graph.display["vertices"], float)
    return (vertices.min(axis=0) + vertices.max(axis=0)) / 2


def rotation(up: str, degrees: float) -> np.ndarray:
    """The matrix (3, 3) of a turn about y or z."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    if up == "y":
        return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])


def view(args: argparse.Namespace, engine: Engine, degrees: float) -> dict[str, str]:
    """Keyword arguments of `Engine.render` for the camera of the arguments, turned."""
    if args.eye:
        target = np.array(numbers_of("look-at", args.look_at, (3,))) if args.look_at else middle(engine)
        eye = np.array(numbers_of("eye", args.eye, (3,)))
        return {"eye": _text(target + rotation(args.up, degrees) @ (eye - target))}
    front = float(engine.graph.front) if args.up == "y" else 0.0
    azimuth, *rest = numbers_of("view", args.view, (2, 3)) if args.view else [front, _ELEVATION]
    return {"view": _text([(azimuth + degrees) % 360, *rest])}


def lights(texts: Sequence[str], up: str, degrees: float, centre: np.ndarray) -> list[str]:
    """Lights, as --light takes them, turned about the axis through `centre` (3,), mm. Raises InputError."""
    core = load_core()
    stated = [json.loads(core.light_json(text)) for text in texts]
    return [core.light_text(json.dumps(light)) for light in lights_of_scene(stated, up, degrees, centre)]


def lights_of_scene(
    stated: Sequence[Mapping[str, Any]], up: str, degrees: float, centre: np.ndarray
) -> list[dict[str, Any]]:
    """Lights, as a scene file states them, turned about the axis through `centre` (3,), mm. Raises InputError."""
    core = load_core()
    forms = {kind.name: {field.name: field.form for field in kind.fields} for kind in core.light_kinds()}
    matrix = rotation(up, degrees)
    result = []
    for each in stated:
        light = dict(each)
        for name, form in forms[light["type"]].items():
            if form in _MOVED:
                light[name] = (centre + matrix @ (np.array(light[name]) - centre)).tolist()
            elif form in _TURNED:
                light[name] = (matrix @ np.array(light[name])).tolist()
            elif form == "turn":
                light[name] = (light[name] + degrees) % 360
            elif form == "axis" and light[name] != up:
                text = core.light_text(json.dumps(each))
                raise InputError(f"light '{text}': its up is {light[name]}, so that --up {light[name]} is wanted")
        result.append(light)
    return result


def kinds() -> dict[str, Callable[[float], tuple[float, float]]]:
    """What may go around, by name: how far camera and lights turn when that has gone so far."""
    return {
        "camera": lambda degrees: (degrees, 0.0),
        "body": lambda degrees: (-degrees, -degrees),
        "light": lambda degrees: (0.0, degrees),
    }


def _text(values: Any) -> str:
    return ",".join(f"{value:.9g}" for value in values)
