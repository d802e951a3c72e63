"""The typed classes have what the engine's own tables have."""

from __future__ import annotations

import dataclasses

import pytest

import quadgraph
from quadgraph import core
from quadgraph.api.lights import LIGHTS

TEXTS = [
    "directional:0,0,1:2.5",
    "point:1,2,-20:30/20/10",
    "ambient:0.5",
    "spot:0,0,-20:0,0,1:20,0.3:40",
    "rectangle:0,0,-20:4,0,0:0,4,0:5",
]


def keys_of(group: str, folder: str) -> set[str]:
    """Members of a scene file, directly in `folder`, that the options of a group stand for."""
    members = {option.member for option in core.scene_options() if option.group == group and option.member}
    return {member.removeprefix(folder) for member in members if member.startswith(folder)}


def test_kinds_of_light_are_the_engines():
    kinds = {kind.name: {field.name for field in kind.fields} for kind in core.light_kinds()}
    assert kinds == {name: {each.name for each in dataclasses.fields(kind)} for name, kind in LIGHTS.items()}


def test_options_of_a_solve_are_the_engines():
    assert set(quadgraph.SolveOptions.__annotations__) == keys_of("Solver", "/solver/") | {"path"}
    assert set(quadgraph.PathOptions.__annotations__) == keys_of("Method shortest-path", "/solver/path/")


def test_the_usual_index_of_refraction_is_the_engines():
    assert quadgraph.Material(1, 0.1).eta == quadgraph.Material.parse("sigma_s_prime=1,sigma_a=0.1").eta


@pytest.mark.parametrize("text", TEXTS)
def test_lights_survive_their_texts(text):
    light = quadgraph.Light.parse(text)
    assert light == quadgraph.Light.parse(light.text)
    assert light.to_dict()["type"] == text.partition(":")[0]


@pytest.mark.parametrize("name", quadgraph.material_names())
def test_materials_survive_their_texts(name):
    material = quadgraph.Material.parse(name)
    assert material == quadgraph.Material.parse(material.text)
