"""What glTF's extensions say of the inside of a body, against their own formulae."""

from __future__ import annotations

import numpy as np
import pytest

from coloured_files import coloured_glb
from quadgraph.base.errors import InputError
from quadgraph.mesh.looks.gltf_media import medium_of, single_scatter_albedo
from quadgraph.mesh.looks.read_looks import read_looks
from shapes import icosphere

VOLUME = {"thicknessFactor": 1.0, "attenuationDistance": 0.02, "attenuationColor": [0.9, 0.5, 0.1]}
ENTERS = {"KHR_materials_transmission": {"transmissionFactor": 1.0}}


def medium(**extensions):
    found, note = medium_of("a.glb, material 'm'", extensions)
    assert (found is None) or note == ""
    return found


def test_attenuation_is_what_is_left_after_its_distance():
    """exp(-sigma_t d) is the attenuation's colour, all of it absorbed."""
    found = medium(KHR_materials_volume=VOLUME, **ENTERS)
    assert found.sigma_s_prime == (0, 0, 0)
    assert np.exp(-np.array(found.sigma_a) * 0.02) == pytest.approx([0.9, 0.5, 0.1])


@pytest.mark.parametrize("g", [0.0, 0.4, -0.3])
def test_scattering_parts_the_attenuation(g):
    """The draft's formula: 1 - s^2 of sigma_t scatters, whatever g is."""
    many = np.array([0.8, 0.3, 0.0])
    scatter = {"multiscatterColor": many.tolist(), "scatterAnisotropy": g}
    found = medium(KHR_materials_volume=VOLUME, KHR_materials_volume_scatter=scatter)
    sigma_t = -np.log([0.9, 0.5, 0.1]) / 0.02
    s = 4.09712 + 4.20863 * many - np.sqrt(9.59217 + 41.6808 * many + 17.7126 * many**2)
    scattered = np.array(found.sigma_s_prime) / (1 - g)
    assert scattered == pytest.approx(np.maximum(sigma_t * (1 - s**2), 0))
    assert scattered + found.sigma_a == pytest.approx(sigma_t)


def test_its_successor_keeps_the_reduced_albedo():
    """(1 - g) rho / (1 - g rho) is that of isotropic scattering, by the formula with g."""
    many = [0.8, 0.3, 0.5]
    found = [
        medium(
            KHR_materials_volume=VOLUME,
            KHR_materials_scatter={"multiscatterColorFactor": many, "scatterAnisotropy": g, "scatterStrengthFactor": 1},
            **ENTERS,
        )
        for g in (0.0, 0.7)
    ]
    albedos = [np.array(each.sigma_s_prime) / np.add(each.sigma_s_prime, each.sigma_a) for each in found]
    assert albedos[1] == pytest.approx(albedos[0], rel=1e-6)


def test_a_scatter_without_strength_absorbs_alone():
    found = medium(KHR_materials_volume=VOLUME, KHR_materials_scatter={}, **ENTERS)
    assert np.array(found.sigma_s_prime) == pytest.approx(0, abs=0.01 * max(found.sigma_a))


def test_the_albedo_of_many_events_rises_from_0_to_1():
    albedo = single_scatter_albedo(np.linspace(0, 1, 50), 0.0)
    assert (np.diff(albedo) > 0).all()
    assert albedo[[0, -1]] == pytest.approx([0, 1], abs=0.01)


@pytest.mark.parametrize(
    "extensions",
    [
        {},
        ENTERS,
        {"KHR_materials_volume": VOLUME},
        {"KHR_materials_volume": VOLUME | {"thicknessFactor": 0}, **ENTERS},
        {"KHR_materials_volume": {"thicknessFactor": 1}, **ENTERS},
    ],
)
def test_without_depth_or_entry_there_is_no_medium(extensions):
    assert medium(**extensions) is None


def test_index_and_roughness_come_along(tmp_path):
    material = {"pbrMetallicRoughness": {"roughnessFactor": 0.4}, "extensions": {"KHR_materials_ior": {"ior": 1.33}}}
    look = read_looks(coloured_glb(tmp_path / "a.glb", icosphere(1), material)).parts[0].look
    assert (look.eta, look.roughness) == (1.33, pytest.approx(0.16))


@pytest.mark.parametrize(
    ("extensions", "words"),
    [
        ({"KHR_materials_volume": VOLUME | {"attenuationColor": [1, 2, 0]}, **ENTERS}, "attenuationColor: [1, 2, 0]"),
        ({"KHR_materials_volume": VOLUME | {"attenuationDistance": -1}, **ENTERS}, "attenuationDistance: -1 found"),
        ({"KHR_materials_volume": VOLUME | {"attenuationColor": [1, 1]}, **ENTERS}, "3 numbers from 0 to 1"),
        (
            {"KHR_materials_volume": VOLUME, "KHR_materials_volume_scatter": {"scatterAnisotropy": "g"}},
            "scatterAnisotropy: g found, allowed is a number from -1 to 1",
        ),
    ],
)
def test_numbers_that_are_wrong_are_named(extensions, words):
    with pytest.raises(InputError) as error:
        medium_of("a.glb, material 'm'", extensions)
    assert str(error.value).startswith("a.glb, material 'm', KHR_materials_volume")
    assert words in str(error.value)
