"""What a body answers to light as a function of tensors of PyTorch, which finds its way through it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from quadgraph.api.derivatives import ForwardModel, Views
from quadgraph.api.values import Doubles
from quadgraph.base.optional_package import optional_package

if TYPE_CHECKING:
    import torch

    from quadgraph.api.engine import Engine


class OutgoingTensors(NamedTuple):
    """Light that leaves a body, as tensors; shapes and units are those of `Outgoing`."""

    exitance: torch.Tensor
    unscattered: torch.Tensor
    radiance: torch.Tensor


def outgoing_tensors(
    engine: Engine,
    sigma_s_prime: torch.Tensor | None = None,
    sigma_a: torch.Tensor | None = None,
    power: torch.Tensor | None = None,
    *,
    level: int = 0,
    views: Views | None = None,
    model: Literal["sp3", "diffusion"] = "sp3",
    bounces: bool | None = None,
    tolerance: float = 1e-10,
) -> OutgoingTensors:
    """Return the light that leaves as a differentiable function of tensors, for use within PyTorch (extra `torch`).

    sigma_s_prime, sigma_a: (n_t, 3) 1/mm; power: (beams, 3); what is None is as in the last solve. They are on the
    processor, float64 or float32 all alike, which is what comes back; in between everything is float64. This function,
    its options and what it raises are those of `Engine.forward_model`, its derivatives those of `ForwardModel`:
    `backward` is one `vjp`, a forward-mode tangent one `jvp`, and neither is done for what nothing asks for. There are
    no second derivatives, and there is no `torch.vmap` of it. Raises InputError without PyTorch, too, and for a tensor
    of another kind.
    """
    optional_package("torch", "torch")
    from quadgraph.api.torch_function import light_out

    def solve(scattering: Doubles | None, absorption: Doubles | None, factors: Doubles | None) -> ForwardModel:
        return engine.forward_model(
            level=level, sigma_s_prime=scattering, sigma_a=absorption, power=factors,
            views=views, model=model, bounces=bounces, tolerance=tolerance,
        )  # fmt: skip

    return OutgoingTensors(*light_out(solve, (sigma_s_prime, sigma_a, power)))
