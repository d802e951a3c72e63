"""The function of PyTorch behind `outgoing_tensors`; importing this module needs PyTorch."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import torch

from quadgraph.api.derivatives import ForwardModel, Gradient, Outgoing
from quadgraph.api.values import Doubles
from quadgraph.base.errors import InputError

Parts: TypeAlias = tuple[torch.Tensor | None, ...]
Solve: TypeAlias = Callable[[Doubles | None, Doubles | None, Doubles | None], ForwardModel]
Derivative: TypeAlias = Callable[[Doubles | None, Doubles | None, Doubles | None], Gradient | Outgoing]


def light_out(solve: Solve, parameters: Parts) -> tuple[torch.Tensor, ...]:
    """Exitance, unscattered light and radiance of sigma_s_prime, sigma_a and power, or None. Raises InputError."""
    given = {name: each for name, each in zip(Gradient._fields, parameters, strict=True) if each is not None}
    for name, each in given.items():
        _check(name, each)
    types = {name: each.dtype for name, each in given.items()}
    if len(set(types.values())) > 1:
        found = ", ".join(f"{name} {kind}" for name, kind in types.items())
        raise InputError(f"{found} found, one type of all is wanted: .to(torch.float64)")
    *light, _ = _LightOut.apply(solve, next(iter(types.values()), torch.float64), *parameters)
    return tuple(light)


def _check(name: str, value: object) -> None:
    wanted = "a tensor on the processor, float64 or float32, is wanted"
    if not isinstance(value, torch.Tensor):
        raise InputError(f"{name}: {type(value).__name__} found, {wanted}: torch.as_tensor")
    if value.dtype not in (torch.float64, torch.float32):
        raise InputError(f"{name}: {value.dtype} found, {wanted}: .to(torch.float64)")
    if value.device.type != "cpu":
        raise InputError(f"{name}: on {value.device} found, {wanted}: .cpu()")
    if value.layout != torch.strided:
        raise InputError(f"{name}: {value.layout} found, {wanted}: .to_dense()")


class _LightOut(torch.autograd.Function):
    """What `light_out` gives, and last the `ForwardModel`; before the parameters stands the type of what comes out."""

    @staticmethod
    def forward(solve: Solve, kind: torch.dtype, *parameters: torch.Tensor | None) -> tuple[Any, ...]:
        """Solve."""
        model = solve(*map(_array, parameters))
        return (*_tensors(model.outgoing, kind), model)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: tuple[Any, ...]) -> None:
        """Keep what derivatives need; a weight or a tangent that there is not stays None."""
        (_, ctx.kind, *parameters), ctx.model = inputs, output[-1]
        ctx.save_for_backward(*parameters)
        ctx.save_for_forward(*parameters)
        ctx.set_materialize_grads(False)

    @staticmethod
    def backward(ctx: Any, *weights: torch.Tensor | None) -> Parts:
        """Solve the adjoint once, for all parameters that a gradient is asked of."""
        of_light, wanted = weights[:-1], ctx.needs_input_grad
        if all(each is None for each in of_light):
            return (None,) * len(wanted)
        gradient = _Derivative.apply(ctx.model.vjp, ctx.kind, *of_light, *ctx.saved_tensors)
        return tuple(each if asked else None for each, asked in zip((None, None, *gradient), wanted, strict=True))

    @staticmethod
    def jvp(ctx: Any, *tangents: torch.Tensor | None) -> Parts:
        """Solve along the tangents of the parameters."""
        return (*_Derivative.apply(ctx.model.jvp, ctx.kind, *tangents[2:], *ctx.saved_tensors), None)


class _Derivative(torch.autograd.Function):
    """`vjp` or `jvp` of a model along three tensors, at three parameters that are not looked at.

    They stand here, so that PyTorch knows that there is something to differentiate again, and is refused.
    """

    @staticmethod
    def forward(derivative: Derivative, kind: torch.dtype, *tensors: torch.Tensor | None) -> tuple[Any, ...]:
        """Solve."""
        return _tensors(derivative(*map(_array, tensors[:3])), kind)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: tuple[Any, ...]) -> None:
        """Keep nothing."""

    @staticmethod
    def backward(ctx: Any, *weights: torch.Tensor | None) -> Parts:
        """Raise InputError."""
        raise InputError("outgoing_tensors: a second derivative is asked for, there are first ones only")

    @staticmethod
    def jvp(ctx: Any, *tangents: torch.Tensor | None) -> Parts:
        """Raise InputError."""
        raise InputError("outgoing_tensors: a second derivative is asked for, there are first ones only")


def _array(tensor: torch.Tensor | None) -> Doubles | None:
    return None if tensor is None else tensor.detach().numpy().astype(np.float64)


def _tensors(values: Gradient | Outgoing, kind: torch.dtype) -> tuple[torch.Tensor, ...]:
    return tuple(torch.from_numpy(each).to(kind) for each in values)
