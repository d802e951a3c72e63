"""The typed classes have what the engine's own tables have."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path
from typing import get_args, get_type_hints

import numpy as np
import pytest

import quadgraph
from quadgraph import core
from quadgraph.api.deformers import DEFORMERS
from quadgraph.api.lights import LIGHTS
from quadgraph.api.options import MOTION
from quadgraph.base.units import DEFAULT_ETA

SCHEMA = json.loads((Path(__file__).resolve().parents[3] / "docs/scene.schema.json").read_text())

TEXTS = [
    "directional:0,0,1:2.5",
    "point:1,2,-20:30/20/10",
    "ambient:0.5",
    "spot:0,0,-20:0,0,1:20,0.3:40",
    "rectangle:0,0,-20:4,0,0:0,4,0:5",
    "projector:0,0,30:0,0,-1:20,0,1,0:picture.png:1/2/3",
    "environment:around.hdr:30,z:0.1/0.2/0.3",
]


def keys_of(group: str, folder: str) -> set[str]:
    """Members of a scene file, directly in `folder`, that the options of a group stand for."""
    members = {option.member for option in core.scene_options() if option.group == group and option.member}
    return {member.removeprefix(folder) for member in members if member.startswith(folder)}


def test_kinds_of_light_are_the_engines():
    kinds = {kind.name: {field.name for field in kind.fields} for kind in core.light_kinds()}
    assert kinds == {name: {each.name for each in dataclasses.fields(kind)} for name, kind in LIGHTS.items()}


def in_schema(name: str) -> set[str]:
    """What scene files may have in one of their objects."""
    return set(SCHEMA["properties"][name]["properties"])


def test_options_of_a_solve_are_the_engines():
    assert set(quadgraph.SolveOptions.__annotations__) == keys_of("Solver", "/solver/") | {"path"}
    assert set(quadgraph.PathOptions.__annotations__) == keys_of("Method shortest-path", "/solver/path/")


def test_options_of_motion_are_those_that_scenes_lack():
    lacking = {option.keyword for option in core.scene_options() if option.group == "Solver" and not option.member}
    assert lacking == MOTION
    assert lacking.isdisjoint(quadgraph.SolveOptions.__annotations__)


@pytest.mark.parametrize(
    ("kind", "name", "own"),
    [(quadgraph.Camera, "camera", {"target"}), (quadgraph.PictureOptions, "picture", {"roughness_map"})],
)
def test_options_of_a_picture_are_the_engines(kind, name, own):
    """own: what is in no table of options, and which the schema of scene files has."""
    assert set(kind.__annotations__) == in_schema(name) == keys_of(name.capitalize(), f"/{name}/") | own


def test_deformers_are_the_engines():
    found = {}
    for each in SCHEMA["$defs"]["deformer"]["oneOf"]:
        said = each["properties"]["type"]
        for name in said.get("enum", [said.get("const")]):
            # A step of one type may stand in two forms.
            found.setdefault(name, set()).update(each["properties"].keys() - {"type"})
    assert found == {name: {each.name for each in dataclasses.fields(kind)} for name, kind in DEFORMERS.items()}


def test_allowed_names_are_the_engines():
    types = get_type_hints(quadgraph.SolveOptions) | {"radiance": get_type_hints(quadgraph.PictureOptions)["radiance"]}
    types |= {f"path-{name}": kind for name, kind in get_type_hints(quadgraph.PathOptions).items()}
    choices = {option.name: tuple(option.choices) for option in core.scene_options() if option.choices}
    assert {name: get_args(types[name]) for name in choices.keys() & types} == {
        name: allowed for name, allowed in choices.items() if name in types
    }
    assert {"method", "solver", "source", "model", "radiance", "path-cost", "path-solver"} <= choices.keys() & types


def test_the_usual_index_of_refraction_is_the_engines(tmp_path):
    assert quadgraph.Material.parse("sigma_s_prime=1,sigma_a=0.1").eta == DEFAULT_ETA
    one = np.ones((1, 1, 1))
    np.savez(tmp_path / "grid.npz", sigma_s_prime=one, sigma_a=one, spacing=1.0)
    assert core.Volume(tmp_path / "grid.npz").eta == np.float32(DEFAULT_ETA)
    assert quadgraph.Material(1, 0.1).eta == quadgraph.VolumeMaterial(one, one, 1).eta == DEFAULT_ETA


def test_the_reference_takes_the_engines_usual_method_and_source():
    """What it has of its own, a tolerance and a named model, is stated in engine/reference/reference.h alone."""
    usual = {option.name: option.default for option in core.scene_options()}
    said = dict(re.findall(r"(\w+): str = '([\w-]+)'", core.solve_reference.__doc__))
    assert (said["method"], said["source"]) == (usual["method"], usual["source"])


@pytest.mark.parametrize("text", TEXTS)
def test_lights_survive_their_texts(text):
    light = quadgraph.Light.parse(text)
    assert light == quadgraph.Light.parse(light.text)
    assert light.to_dict()["type"] == text.partition(":")[0]


def test_every_kind_of_light_has_a_text_that_is_tried():
    assert {text.partition(":")[0] for text in TEXTS} == {kind.name for kind in core.light_kinds()}


@pytest.mark.parametrize("name", quadgraph.material_names())
def test_materials_survive_their_texts(name):
    material = quadgraph.Material.parse(name)
    assert material == quadgraph.Material.parse(material.text)
