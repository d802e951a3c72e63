"""By which roughness light goes in and out in solves."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph import cli, core
from quadgraph.base.errors import InputError
from shapes import icosphere

MATERIAL = "sigma_s_prime=1,sigma_a=.1,eta=1.5"


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("roughness") / "ball.qgraph", [icosphere(2, 6.0)], rays=32)


def solved(ball, alpha: float | None, material: str = MATERIAL, **options) -> tuple[float, float]:
    """Power that enters and that leaves after it was scattered, W, in even light."""
    with quadgraph.Engine(ball, device="cpu") as engine:
        engine.material, engine.lights = material, ["ambient:1"]
        engine.set_light_roughness(alpha)
        engine.solve(**options)
        found = engine.surface()
        return tuple(float((np.asarray(found.area) * np.asarray(of)[:, 1]).sum()) for of in (found.q, found.exitance))


def of_scene(ball, picture: dict) -> float:
    """What leaves, W, by a scene of that picture."""
    with quadgraph.Stage(device="cpu") as stage:
        members = {"material": MATERIAL, "lights": [{"type": "ambient", "irradiance": 1.0}], "picture": picture}
        stage.show(quadgraph.Scene.from_dict({"body": str(ball), **members}))
        stage.solve()
        found = stage.engine.surface()
        return float((np.asarray(found.area) * np.asarray(found.exitance)[:, 1]).sum())


@pytest.mark.parametrize("correction", [False, True])
def test_a_rough_surface_lets_in_more_and_out_more(ball, correction):
    found = [solved(ball, alpha, correction=correction) for alpha in (0, 0.1, 0.3, 0.6)]
    for (entered, left), (more, leaves) in pairwise(found):
        assert more > entered
        assert leaves / more > 1.002 * left / entered


def test_what_enters_is_what_the_moments_say(ball):
    wanted = 1.5**2 * (1 - 2 * core.fresnel_moment(1, 1.5, 0.3))
    with quadgraph.Engine(ball, device="cpu") as engine:
        engine.material, engine.lights = MATERIAL, ["ambient:1"]
        engine.set_light_roughness(0.3)
        engine.solve()
        assert np.allclose(engine.surface().q, wanted, rtol=1e-3)


def test_light_that_nothing_absorbs_comes_out_again(ball):
    for correction in (False, True):
        entered, left = solved(ball, 0.4, "sigma_s_prime=2,sigma_a=0,eta=1.4", correction=correction)
        assert left == pytest.approx(entered, rel=0.005)


def test_scenes_go_by_their_picture_and_engines_are_smooth_until_told(ball):
    smooth, said = of_scene(ball, {"transmission_roughness": 0}), of_scene(ball, {"roughness": 0.6})
    assert solved(ball, 0)[1] == pytest.approx(smooth, rel=1e-6)
    assert said > 1.03 * smooth
    assert of_scene(ball, {"roughness": 0.1, "transmission_roughness": 0.6}) == said
    assert solved(ball, None)[1] == pytest.approx(of_scene(ball, {}), rel=1e-6)
    assert of_scene(ball, {}) == of_scene(ball, {"roughness": 0.3})
    with quadgraph.Engine(ball, device="cpu") as engine:
        engine.material, engine.lights = MATERIAL, ["ambient:1"]
        engine.solve()
        found = engine.surface()
        assert float((found.area * found.exitance[:, 1]).sum()) == pytest.approx(smooth, rel=1e-6)


def test_commands_go_by_the_material(ball, tmp_path):
    def field(roughness: float) -> np.ndarray:
        base = ["solve", str(ball), "--light", "ambient:1", "--device", "cpu", "--no-correction"]
        material = ["--material", f"{MATERIAL},roughness={roughness}"]
        assert cli.main([*base, *material, "--field", str(tmp_path / "field.npz")]) == 0
        return np.load(tmp_path / "field.npz")["exitance"]

    assert (field(0.6) > 1.03 * field(0.02)).all()


def test_what_is_out_of_range_is_refused(ball):
    with quadgraph.Engine(ball, device="cpu") as engine:
        for alpha in (-0.1, 1.5, float("nan")):
            with pytest.raises(InputError, match="transmission_roughness"):
                engine.set_light_roughness(alpha)


def test_derivatives_refuse_a_rough_surface(ball):
    with quadgraph.Engine(ball, device="cpu") as engine:
        engine.material, engine.lights = MATERIAL, ["ambient:1"]
        engine.set_light_roughness(0.2)
        engine.solve()
        with pytest.raises(InputError, match="a smooth one"):
            engine.forward_model()
