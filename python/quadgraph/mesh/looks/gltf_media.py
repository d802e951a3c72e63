"""What glTF's extensions say of the inside of a material, as coefficients: the one place that knows them.

KHR_materials_volume (ratified) gives the attenuation, -ln(attenuationColor) / attenuationDistance, in the scene's
unit. Without scattering that is absorption. KHR_materials_volume_scatter (a draft, Khronos' glTF pull request 2453) and
its successor KHR_materials_scatter (a draft, pull request 2579) part it by the albedo of many scattering events,
inverted as [Kulla and Conty 2017] do, the second alone with regard to the anisotropy g; reduced scattering is
(1 - g) sigma_s.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.looks.parts import StatedMedium

DARKEST = 1e-3  # an attenuation colour below it is taken as it, or nothing would ever pass
SHARPEST = 0.999  # anisotropy: Khronos's own ScatterAnisotropy goes to the ends, which no phase function reaches
_DEFAULT_ETA = 1.5  # of a dielectric in glTF
CLEAR_COAT = "KHR_materials_clearcoat"  # ratified: of index 1.5


def numbers_of(
    where: str, holder: dict, name: str, usual: tuple[float, ...], least: float, most: float
) -> tuple[float, ...]:
    """As many numbers as `usual` has, which are left away or within bounds. Raises InputError."""
    found = holder.get(name)
    if found is None:
        return usual
    values = found if isinstance(found, list) else [found]
    plain = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
    if not plain or len(values) != len(usual) or not all(least <= value <= most for value in values):
        count = "a number" if len(usual) == 1 else f"{len(usual)} numbers"
        raise InputError(f"{where}, {name}: {str(found)[:80]} found, allowed is {count} from {least:g} to {most:g}")
    return tuple(float(value) for value in values)


def number_of(where: str, holder: dict, name: str, usual: float, least: float, most: float) -> float:
    """A number that is left away or within bounds. Raises InputError."""
    return numbers_of(where, holder, name, (usual,), least, most)[0]


def single_scatter_albedo(many: np.ndarray, g: float) -> np.ndarray:
    """Albedo of one event from that of many, both 0 to 1, for an anisotropy [Kulla and Conty 2017]."""
    s = 4.09712 + 4.20863 * many - np.sqrt(9.59217 + 41.6808 * many + 17.7126 * many**2)
    return np.clip((1 - s**2) / (1 - g * s**2), 0, 1)


def many_scatter_albedo(single: np.ndarray) -> np.ndarray:
    """Albedo of many events from that of one, without anisotropy: `single_scatter_albedo` inverted by halving."""
    low, high = np.zeros_like(single), np.ones_like(single)
    for _ in range(50):
        middle = (low + high) / 2
        less = single_scatter_albedo(middle, 0.0) < single
        low, high = np.where(less, middle, low), np.where(less, high, middle)
    return (low + high) / 2


def clear_coat_of(share: float, eta: float, alpha: float) -> dict[str, float]:
    """A coat as glTF has it: as much of one of index 1.5 as mirrors the same along the normal; alpha: GGX."""
    mirrored = share * ((eta - 1) / (eta + 1)) ** 2 / ((_DEFAULT_ETA - 1) / (_DEFAULT_ETA + 1)) ** 2
    return {"clearcoatFactor": min(mirrored, 1.0), "clearcoatRoughnessFactor": math.sqrt(alpha)}


def coat_note(where: str, extensions: dict) -> list[str]:
    """What to say of a coat that a file states. Raises InputError."""
    stated = extensions.get(CLEAR_COAT, {})
    share = number_of(where, stated, "clearcoatFactor", 0.0, 0, 1)
    if share == 0:
        return []
    alpha = max(number_of(where, stated, "clearcoatRoughnessFactor", 0.0, 0, 1) ** 2, 0.02)
    text = f",coat={share:.2g},coat_roughness={alpha:.2g}"
    return [f"{where}: a clear coat, which no volume has: {text} behind the name of a material"]


def extensions_of(sigma_s_prime: np.ndarray, sigma_a: np.ndarray, eta: float, thickness: float) -> dict[str, Any]:
    """The extensions that `eta_of` and `medium_of` read as these coefficients, (3,), per unit of the file's lengths.

    thickness: of the body, in that unit, for renderers that cast no rays through it. Light that scatters forwards is
    written as the similar one that does not.
    """
    sigma_t = sigma_s_prime + sigma_a
    found: dict[str, Any] = {"KHR_materials_ior": {"ior": eta}}
    found["KHR_materials_transmission"] = {"transmissionFactor": 1.0}
    volume: dict[str, Any] = {"thicknessFactor": thickness}
    if sigma_t.max() > 0:
        distance = 1 / sigma_t.max()  # so that no colour is below 1/e
        volume |= {"attenuationDistance": float(distance), "attenuationColor": np.exp(-sigma_t * distance).tolist()}
    found["KHR_materials_volume"] = volume
    if sigma_s_prime.max() > 0:
        many = many_scatter_albedo(sigma_s_prime / np.maximum(sigma_t, 1e-30))
        found["KHR_materials_volume_scatter"] = {"multiscatterColor": many.tolist(), "scatterAnisotropy": 0.0}
    return found


def eta_of(where: str, extensions: dict[str, Any]) -> float | None:
    """Index of refraction by KHR_materials_ior; None where it says nothing, or 0, which is glTF's word for mirrors."""
    if "KHR_materials_ior" not in extensions:
        return None
    eta = number_of(f"{where}, KHR_materials_ior", extensions["KHR_materials_ior"], "ior", _DEFAULT_ETA, 0, 1e6)
    if eta == 0:
        return None
    return number_of(f"{where}, KHR_materials_ior", {"ior": eta}, "ior", _DEFAULT_ETA, 1, 3)


def medium_of(where: str, extensions: dict[str, Any]) -> tuple[StatedMedium | None, str]:
    """The medium that a material states, and a sentence on what of it could not be taken, else "".

    where: file and material, for errors. None where light does not enter, or is not attenuated. Raises InputError.
    """
    volume, scatter = extensions.get("KHR_materials_volume"), _scattering(where, extensions)
    if volume is None:
        return None, ""
    here = f"{where}, KHR_materials_volume"
    thickness = number_of(here, volume, "thicknessFactor", 0.0, 0, math.inf)
    enters = scatter is not None or _enters(where, extensions)
    if not enters or (thickness == 0 and "KHR_materials_volume_scatter" not in extensions):
        return None, f"{where}: a volume that no light enters, or without thickness: its base colour is taken"
    distance = number_of(here, volume, "attenuationDistance", math.inf, 1e-12, math.inf)
    colour = np.maximum(numbers_of(here, volume, "attenuationColor", (1.0, 1.0, 1.0), 0, 1), DARKEST)
    if not math.isfinite(distance) or (colour == 1).all():
        return None, f"{where}: a volume without attenuation, as clear as glass: its base colour is taken"
    sigma_t = -np.log(colour) / distance
    albedo, g = scatter or (np.zeros(3), 0.0)
    sigma_s = sigma_t * albedo
    return StatedMedium(_three((1 - g) * sigma_s), _three(sigma_t - sigma_s)), ""


def _scattering(where: str, extensions: dict[str, Any]) -> tuple[np.ndarray, float] | None:
    """Albedo of one event, (3,), and anisotropy; None where nothing is said to scatter."""
    for name, white, strength in (("KHR_materials_scatter", 1.0, 0.0), ("KHR_materials_volume_scatter", 0.0, 1.0)):
        if name not in extensions:
            continue
        here, said = f"{where}, {name}", extensions[name]
        key = "multiscatterColor" if "multiscatterColor" in said else "multiscatterColorFactor"
        many = np.array(numbers_of(here, said, key, (white,) * 3, 0, 1))
        many *= number_of(here, said, "scatterStrengthFactor", strength, 0, 1)
        g = max(-SHARPEST, min(SHARPEST, number_of(here, said, "scatterAnisotropy", 0.0, -1, 1)))
        return single_scatter_albedo(many, g if name == "KHR_materials_scatter" else 0.0), g
    return None


def _enters(where: str, extensions: dict[str, Any]) -> bool:
    for name, factor in (
        ("KHR_materials_transmission", "transmissionFactor"),
        ("KHR_materials_diffuse_transmission", "diffuseTransmissionFactor"),
    ):
        if number_of(f"{where}, {name}", extensions.get(name, {}), factor, 0.0, 0, 1) > 0:
            return True
    return False


def _three(values: np.ndarray) -> tuple[float, float, float]:
    red, green, blue = (float(value) for value in values)
    return red, green, blue
