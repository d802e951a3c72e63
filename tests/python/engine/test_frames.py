"""Frame after frame on a body from the bake: one cycle each, from the last solution."""

from __future__ import annotations

import math

import numpy as np
import pytest

SCENE = {"model": "diffusion", "inter_reflection": False}


def light(degrees: float) -> list[str]:
    """Return a light that has turned by so much about the body's upright axis."""
    angle = math.radians(degrees)
    return [f"directional:{math.sin(angle)},-0.3,{-math.cos(angle)}:1"]


def relative(field: dict, exact: dict, part: np.ndarray) -> float:
    """Return the relative RMS difference of the exitance over a part of the surface."""
    weight = exact["area"][part, None]
    difference = field["exitance"][part] - exact["exitance"][part]
    return math.sqrt(np.sum(weight * difference**2) / np.sum(weight * exact["exitance"][part] ** 2))


def errors(engine, field: dict) -> tuple[float, float]:
    """Return the errors of a field over the whole surface and over its unlit part; solves again."""
    engine.solve(**SCENE, tolerance=1e-5)
    exact = engine.surface_field()
    power = exact["q"].sum(axis=1)
    unlit = power < 0.1 * np.average(power, weights=exact["area"])
    return relative(field, exact, np.full(len(power), True)), relative(field, exact, unlit)


@pytest.fixture(scope="module")
def engine(small_bunny):
    """The small bunny of marble under one light, solved."""
    from quadgraph import _core

    engine = _core.Engine(small_bunny, validation=True)
    engine.set_material("marble")
    engine.set_lights(light(0))
    engine.solve(**SCENE)
    yield engine
    assert engine.validation_messages == []


def test_one_cycle_follows_a_turning_light(engine):
    """5 degrees a frame; the reported estimates are not far below what is true."""
    for frame in range(1, 13):
        engine.set_lights(light(5.0 * frame))
        report = engine.solve(**SCENE, cycles=1, warm=True)
        assert report["levels"][-1]["iterations"] == 1
    field = engine.surface_field()
    whole, unlit = errors(engine, field)
    print(f"turning light, one cycle a frame: {100 * whole:.2f}% whole, {100 * unlit:.2f}% unlit")
    assert whole < 0.02
    assert unlit < 0.04
    assert report["algebraic"]["whole"] > whole / 2
    assert report["algebraic"]["unlit"] > unlit / 2
    assert report["error"]["whole"] > report["algebraic"]["whole"]


def test_one_cycle_follows_an_edited_material(engine):
    """Absorption halved from one frame to the next."""
    engine.set_lights(light(0))
    engine.set_material("sigma_s_prime=2.19,sigma_a=0.0042,eta=1.5")
    engine.solve(**SCENE)
    engine.set_material("sigma_s_prime=2.19,sigma_a=0.0021,eta=1.5")
    engine.solve(**SCENE, cycles=1, warm=True)
    whole, unlit = errors(engine, engine.surface_field())
    print(f"absorption halved, one cycle: {100 * whole:.2f}% whole, {100 * unlit:.2f}% unlit")
    assert whole < 0.02
    assert unlit < 0.04


def test_frames_touch_only_what_they_must(engine):
    """Neither light nor material allocates; new light assembles nothing, and what has not changed is not walked."""
    engine.set_material("marble")
    engine.set_lights(light(0))
    engine.solve(**SCENE)
    engine.solve(**SCENE, cycles=1, warm=True)
    same = {entry["name"] for entry in engine.passes if entry["count"]}
    before = engine.device_bytes
    engine.set_lights(light(5))
    engine.solve(**SCENE, cycles=1, warm=True)
    lit = {entry["name"] for entry in engine.passes if entry["count"]}
    engine.set_material("skin1")
    engine.solve(**SCENE, cycles=1, warm=True)
    edited = {entry["name"] for entry in engine.passes if entry["count"]}
    assert engine.device_bytes == before
    assert not {"assembly", "eigenvalue bound", "source walk", "right-hand side"} & same
    assert "source walk" in lit
    assert not {"assembly", "eigenvalue bound"} & lit
    assert {"assembly", "eigenvalue bound", "source walk"} <= edited


def test_frames_in_motion_are_near_and_leave_nothing_behind(engine):
    """Uniform light by one ray from an origin; what is solved afterwards is what it would have been without them."""
    engine.set_material("marble")
    engine.set_lights([*light(0), "ambient:1"])
    engine.solve()
    alone = engine.surface_field()["exitance"]
    for frame in range(6, -1, -1):
        engine.set_lights([*light(5.0 * frame), "ambient:1"])
        report = engine.solve(motion=True)
    assert len(report["bounces"]) == 1
    moving = engine.surface_field()
    again = engine.solve()
    settled = engine.surface_field()
    whole = relative(moving, settled, np.full(len(settled["area"]), True))
    print(f"turning light and uniform light, in motion: {100 * whole:.2f}%")
    assert 0 < whole < 0.01
    assert len(again["bounces"]) > 1
    assert np.array_equal(settled["exitance"], alone)


def test_one_ray_of_even_light_does_for_eight(engine):
    """On a body alone in it, by how much the exitance differs; power is kept either way."""
    engine.set_material("marble")
    engine.set_lights(["ambient:1"])
    engine.solve(tolerance=1e-4)
    eight = engine.surface_field()
    report = engine.solve(tolerance=1e-4, mean_rays=True)
    one = engine.surface_field()
    assert np.abs(report["energy"]["balance"]).max() < 1e-4
    whole = relative(one, eight, np.full(len(eight["area"]), True))
    print(f"uniform light by one ray: {100 * whole:.2f}%")
    assert 1e-5 < whole < 0.005
