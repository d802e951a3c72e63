"""Colours as coefficients: the albedo at which a thick body shows them, for a mean free path."""

from __future__ import annotations

import numpy as np

from quadgraph import core

BRIGHTEST = 0.95  # of what a body that absorbs nothing sends back: what is brighter is taken as it
_STEPS = 1023  # of the table, three at a time; between them coefficients are off by less than 5e-4 of them


def brightest(eta: float) -> float:
    """The reflectance above which colours are cut off: all light that gets in comes out, but for a share."""
    return BRIGHTEST * core.fresnel_transmittance(1.0, eta)


def coefficients(colours: np.ndarray, mean_free_path: np.ndarray, eta: float) -> tuple[np.ndarray, np.ndarray]:
    """sigma_s_prime and sigma_a, (n, 3) each, 1/mm, of linear reflectances (n, 3) as `Material.from_colour` finds them.

    mean_free_path: (3,) mm, 1 / (sigma_s_prime + sigma_a); reflectances are cut off at 0 and at `brightest`.
    """
    known = np.linspace(0, brightest(eta), _STEPS + 3)
    absorbed = np.log([_absorbed(three, eta) for three in known.reshape(-1, 3)]).ravel()
    share = np.exp(np.interp(np.clip(colours, 0, known[-1]), known, absorbed))
    return (1 - share) / mean_free_path, share / mean_free_path


def _absorbed(reflectances: np.ndarray, eta: float) -> tuple[float, ...]:
    """What of the attenuation is absorption at three reflectances: 1 less the albedo."""
    colour = "/".join(f"{each:.9g}" for each in reflectances)
    return core.Material(f"reflectance={colour},mean_free_path=1,eta={eta!r}").sigma_a
