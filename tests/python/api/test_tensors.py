"""Outgoing light within PyTorch: its own check of gradients, none where none is asked for, and refusals."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import quadgraph
from quadgraph.base.errors import InputError

torch = pytest.importorskip("torch", reason="PyTorch is not installed: pip install 'quadgraph[torch]'")
pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

TINY = Path(__file__).resolve().parents[2] / "data/tiny.qgraph"


@pytest.fixture(scope="module")
def engine():
    """A cube of 24 tets in two lights."""
    with quadgraph.Engine(TINY, device="cpu") as engine:
        engine.material = quadgraph.Material(sigma_s_prime=1, sigma_a=0.1)
        engine.lights = [
            quadgraph.DirectionalLight(direction=(0.3, -0.2, -1), irradiance=(1, 0.8, 0.6)),
            quadgraph.DirectionalLight(direction=(0.3, 0.8, 1), irradiance=0.5),
        ]
        engine.solve(correction=False)
        yield engine


@pytest.fixture(scope="module")
def views(engine) -> quadgraph.Views:
    """Straight out of every third face."""
    faces = np.arange(0, 12, 3)
    return quadgraph.Views(faces, engine.surface().normal[faces], np.full((4, 3), 1 / 3))


@pytest.fixture
def point(engine) -> dict:
    """Parameters of which a gradient is wanted, different in every tet, channel and beam."""
    rng, model = np.random.default_rng(1), engine.forward_model()
    return {
        name: torch.tensor(getattr(model, name) * rng.uniform(0.7, 1.3, getattr(model, name).shape), requires_grad=True)
        for name in quadgraph.Gradient._fields
    }


def counted(monkeypatch: pytest.MonkeyPatch, name: str) -> list[str]:
    """A list that grows by a name whenever a derivative of a model is asked for."""
    calls, own = [], getattr(quadgraph.ForwardModel, name)
    monkeypatch.setattr(quadgraph.ForwardModel, name, lambda *args, **rest: calls.append(name) or own(*args, **rest))
    return calls


def test_pytorch_finds_gradients_and_tangents_right(engine, views, point):
    def light(*parameters):
        return tuple(quadgraph.outgoing_tensors(engine, *parameters, views=views, tolerance=1e-14))

    assert torch.autograd.gradcheck(light, tuple(point.values()), check_forward_ad=True)


def test_light_is_that_of_the_forward_model(engine, views, point):
    arrays = {name: each.detach().numpy() for name, each in point.items()}
    known = engine.forward_model(**arrays, views=views).outgoing
    found = quadgraph.outgoing_tensors(engine, **point, views=views)
    for name in quadgraph.Outgoing._fields:
        assert np.array_equal(getattr(found, name).detach().numpy(), getattr(known, name)), name
    last = quadgraph.outgoing_tensors(engine).exitance
    assert not last.requires_grad
    assert np.array_equal(last.numpy(), engine.forward_model().outgoing.exitance)


def test_single_precision_comes_back_as_such(engine, point):
    absorption = point["sigma_a"].detach()
    single = absorption.float().requires_grad_()
    light = quadgraph.outgoing_tensors(engine, sigma_a=single)
    assert {each.dtype for each in light} == {torch.float32}
    light.exitance.sum().backward()
    double = absorption.requires_grad_()
    quadgraph.outgoing_tensors(engine, sigma_a=double).exitance.sum().backward()
    assert single.grad.dtype == torch.float32
    assert single.grad.numpy() == pytest.approx(double.grad.numpy(), rel=1e-5)


def test_only_what_needs_a_gradient_gets_one_and_one_solve_gives_them_all(engine, point, monkeypatch):
    calls = counted(monkeypatch, "vjp")
    scattering = point["sigma_s_prime"].detach()
    light = quadgraph.outgoing_tensors(engine, scattering, point["sigma_a"], point["power"])
    (light.exitance.sum() + light.unscattered.sum()).backward()
    assert calls == ["vjp"]
    assert scattering.grad is None
    assert (point["sigma_a"].grad < 0).all()
    assert (point["power"].grad > 0).all()


def test_nothing_is_solved_back_where_nothing_is_asked_for(engine, point, monkeypatch):
    calls = counted(monkeypatch, "vjp")
    with torch.no_grad():
        light = quadgraph.outgoing_tensors(engine, **point)
    assert not light.exitance.requires_grad
    plain = quadgraph.outgoing_tensors(engine, sigma_a=point["sigma_a"].detach())
    assert not plain.radiance.requires_grad
    assert calls == []


def test_functional_transforms_go_through_it(engine, point):
    absorption, along = point["sigma_a"], torch.ones_like(point["sigma_a"])

    def power(sigma_a):
        return quadgraph.outgoing_tensors(engine, sigma_a=sigma_a, tolerance=1e-13).exitance.sum()

    power(absorption).backward()
    plain = absorption.detach()
    assert torch.allclose(torch.func.grad(power)(plain), absorption.grad, rtol=1e-10)
    slope = torch.func.jvp(power, (plain,), (along,))[1]
    assert slope.item() == pytest.approx((absorption.grad * along).sum().item(), rel=1e-9)


def test_a_second_derivative_is_refused_and_not_left_out(engine, point):
    """Also where the first one depends on the parameters alone, and another term has a derivative."""
    absorption = point["sigma_a"]
    power = quadgraph.outgoing_tensors(engine, sigma_a=absorption).exitance.sum()
    (first,) = torch.autograd.grad(power, absorption, create_graph=True)
    with pytest.raises(InputError, match="a second derivative is asked for, there are first ones only"):
        (first.sum() + absorption.sum()).backward()


def test_a_graph_outlives_its_engine(point):
    engine = quadgraph.Engine(TINY, device="cpu")
    engine.material = quadgraph.Material(sigma_s_prime=1, sigma_a=0.1)
    engine.solve(correction=False)
    light = quadgraph.outgoing_tensors(engine, sigma_a=point["sigma_a"])
    engine.close()
    light.exitance.sum().backward()
    assert (point["sigma_a"].grad < 0).all()
    with pytest.raises(InputError, match="the engine is closed"):
        quadgraph.outgoing_tensors(engine)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"sigma_a": np.ones((24, 3))}, r"sigma_a: ndarray found, .*: torch.as_tensor"),
        ({"sigma_a": torch.ones(24, 3, dtype=torch.float16)}, r"sigma_a: torch.float16 found, .*: .to"),
        ({"sigma_a": torch.ones(24, 3, device="meta")}, r"sigma_a: on meta found, .*: .cpu\(\)"),
        ({"sigma_a": torch.ones(24, 3).to_sparse()}, r"sigma_a: torch.sparse_coo found, .*: .to_dense\(\)"),
        ({"sigma_a": torch.ones(24, 2)}, r"sigma_a: shape \(24, 2\) found, \(24, 3\) is wanted"),
        ({"sigma_a": -torch.ones(24, 3)}, r"sigma_a\[0\]: -1.0+, allowed is 0 to"),
        ({"sigma_s_prime": torch.full((24, 3), torch.nan)}, "sigma_s_prime: numbers that are not finite"),
        ({"power": torch.ones(1, 3)}, r"power: shape \(1, 3\), expected \(2, 3\)"),
        (
            {"sigma_a": torch.ones(24, 3), "power": torch.ones(2, 3, dtype=torch.float64)},
            r"sigma_a torch.float32, power torch.float64 found, one type of all is wanted",
        ),
    ],
)
def test_tensors_that_do_not_serve_are_refused(engine, parameters, message):
    with pytest.raises(InputError, match=message):
        quadgraph.outgoing_tensors(engine, **parameters)


def test_without_pytorch_the_extra_is_named(engine, monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(InputError, match=r"torch cannot be imported .* pip install 'quadgraph\[torch\]'"):
        quadgraph.outgoing_tensors(engine)
