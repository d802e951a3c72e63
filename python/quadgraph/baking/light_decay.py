"""How fast light falls inside materials that a bake is told of."""

from __future__ import annotations

import json
import math

from quadgraph import core


def decay_rates(material: str) -> tuple[float, ...]:
    """Rates, 1/mm, at which light falls in a material, smallest first, each once; none where there is nothing.

    material: as of --material, `skin1` or `sigma_s_prime=2.0,sigma_a=0.01/0.02/0.05`. Raises InputError.
    """
    members = json.loads(core.material_json(material))
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
