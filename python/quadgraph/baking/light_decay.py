"""How fast light falls inside materials that a bake is told of."""

from __future__ import annotations

import json
import math

from quadgraph.base.errors import InputError
from quadgraph.core import load_core

_OWN = ("sigma_s_prime", "sigma_a", "eta")  # what is read without the compiled engine


def decay_rates(material: str) -> tuple[float, ...]:
    """Rates, 1/mm, at which light falls in a material, smallest first, each once; none where there is nothing.

    material: coefficients, `sigma_s_prime=2.0,sigma_a=0.01/0.02/0.05`, or whatever the engine knows, if it is
    compiled. Raises InputError.
    """
    members = _coefficients(material)
    rates = set()
    for prefix in ("", "second_"):
        scattering, absorption = (_three(members.get(prefix + name)) for name in ("sigma_s_prime", "sigma_a"))
        for s, a in zip(scattering, absorption, strict=True):
            # No faster than what is not scattered: diffusion alone would say more where much is absorbed.
            if s + a > 0:
                rates.add(min(math.sqrt(3 * a * (s + a)), s + a))
    return tuple(sorted(rates))


def _three(value: float | list[float] | None) -> list[float]:
    if value is None:
        return []
    return list(value) if isinstance(value, list | tuple) else [value] * 3


def _coefficients(material: str) -> dict:
    parts = dict(part.partition("=")[::2] for part in material.split(","))
    if {"sigma_s_prime", "sigma_a"} <= parts.keys() <= set(_OWN):
        return {name: _numbers(name, parts[name]) for name in ("sigma_s_prime", "sigma_a")}
    try:
        core = load_core()
    except InputError as missing:
        raise InputError(
            f"for-material: '{material}' found; without the compiled engine allowed are coefficients, "
            f"like sigma_s_prime=2.0,sigma_a=0.01/0.02/0.05 ({missing})"
        ) from missing
    return json.loads(core.material_json(material))


def _numbers(name: str, text: str) -> list[float]:
    try:
        values = [float(number) for number in text.split("/")]
    except ValueError:
        values = []
    if len(values) not in (1, 3) or not all(math.isfinite(value) and value >= 0 for value in values):
        raise InputError(f"for-material: {name}={text} found, allowed is one number >= 0 (1/mm) or R/G/B")
    return values * (3 // len(values))
