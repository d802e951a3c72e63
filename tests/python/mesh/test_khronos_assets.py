"""Materials of Khronos's glTF sample assets, read as they mean it.

The numbers are those of https://github.com/KhronosGroup/glTF-Sample-Assets as of 2026; the bodies are balls and cubes.
AttenuationTest is described by its README, whose rows say what must come out the same.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from coloured_files import coloured_glb
from quadgraph.baking.surface_changes import brightness
from quadgraph.mesh.looks.parts import ColouredMesh, Part
from quadgraph.mesh.looks.read_looks import read_looks
from quadgraph.mesh.surface import Surface
from shapes import icosphere

PASSES = {"KHR_materials_transmission": {"transmissionFactor": 1}}


def material(name: str, base: list[float] | None = None, roughness: float = 0.0, **extensions: Any) -> dict[str, Any]:
    plain: dict[str, Any] = {"metallicFactor": 0, "roughnessFactor": roughness}
    if base:
        plain["baseColorFactor"] = [*base, 1]
    return {"name": name, "pbrMetallicRoughness": plain, "extensions": extensions}


def volume(colour: list[float], distance: float, thickness: float) -> dict[str, Any]:
    stated = {"attenuationColor": colour, "attenuationDistance": distance, "thicknessFactor": thickness}
    return {"KHR_materials_volume": stated | {"thicknessTexture": {"index": 1, "texCoord": 0}}}


def anisotropy(g: float) -> dict[str, Any]:
    """A ball of ScatterAnisotropy."""
    scatter = {"scatterStrengthFactor": 1, "multiscatterColorFactor": [1, 0.7, 0.01], "scatterAnisotropy": g}
    inside = volume([0.8, 0.2, 0.001], 0.001, 8.9)
    return material(f"Anisotropy {g:+}", None, 0.3, **PASSES, **inside, KHR_materials_scatter=scatter)


DRAGON = material("Dragon with Attenuation", [1, 1, 1], **PASSES, **volume([0.921, 0.640, 0.064], 0.155, 2.27))
DRAGON_SURFACE = material(
    "Dragon with Surface Coloring Only",
    [0.921, 0.640, 0.064],
    **PASSES,
    KHR_materials_volume={"thicknessFactor": 2.27, "thicknessTexture": {"index": 1, "texCoord": 0}},
)
COMPARE_VOLUME = material("glTF Volume", **PASSES, **volume([0.15, 1, 0.5], 0.25, 0.75))
MULTISCATTER = [0.16827136278152467, 0.5271198749542236, 0.5906253457069397]
SKULL = material(
    "subsurface_material",
    None,
    0.53,
    **PASSES,
    **volume([0.3678794503211975, 0.4857314527034759, 0.3964099884033203], 0.016891848295927049, 1),
    KHR_materials_dispersion={"dispersion": 0.57},
    KHR_materials_volume_scatter={"multiscatterColor": MULTISCATTER},
    KHR_materials_ior={"ior": 1.38},
)
STRENGTH = material(
    "trans0.5-stength1",
    [0.81960784, 0.34117647, 0.34117647],
    0.3,
    KHR_materials_transmission={"transmissionFactor": 0.5},
    KHR_materials_volume={"thicknessFactor": 1, "thicknessTexture": {"index": 4}},
    KHR_materials_scatter={"scatterStrengthFactor": 1, "multiscatterColorFactor": [0.8, 0.8, 0.1]},
)
YELLOW = material("YellowTrans", [0.8468738, 0.8713663, 0.0930590], **PASSES)
LEAVES = material(
    "potted_plant_02_leaves",
    KHR_materials_diffuse_transmission={
        "diffuseTransmissionFactor": 0.4,
        "diffuseTransmissionColorFactor": [1, 0, 0],
    },
)
COATED = material(
    "Simple_Coated",
    [0.5, 0.02, 0.01],
    0.44,
    KHR_materials_clearcoat={"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.03},
)


def looks(path: Path, stated: dict[str, Any], surface: Surface | None = None, **node: Any) -> ColouredMesh:
    return read_looks(coloured_glb(path, surface or icosphere(1), stated, nodes=[{"mesh": 0} | node]))


def part(path: Path, stated: dict[str, Any], surface: Surface | None = None, **node: Any) -> Part:
    return looks(path / "a.glb", stated, surface, **node).parts[0]


def attenuation(read: Part) -> np.ndarray:
    """sigma_t of what does not scatter forwards, per unit of the file's lengths."""
    assert read.look.medium
    return np.add(read.look.medium.sigma_s_prime, read.look.medium.sigma_a)


@pytest.mark.parametrize("stated", [DRAGON, COMPARE_VOLUME, SKULL], ids=lambda stated: stated["name"])
def test_what_is_left_after_the_distance_is_the_colour(tmp_path, stated):
    """DragonAttenuation, CompareVolume (whose green is not attenuated at all) and ScatteringSkull."""
    said = stated["extensions"]["KHR_materials_volume"]
    left = np.exp(-attenuation(part(tmp_path, stated)) * said["attenuationDistance"])
    assert left == pytest.approx(said["attenuationColor"], rel=1e-6)


def test_the_skull_sends_back_its_colour(tmp_path):
    """ScatteringSkull: a half-space of its albedo without an interface sends back the multi-scatter colour, by
    van de Hulst's formula [Hulst 1980] for even light; index and roughness come along.
    """
    read = part(tmp_path, SKULL)
    assert read.look.medium
    back = brightness(np.array(read.look.medium.sigma_s_prime), np.array(read.look.medium.sigma_a))
    assert back == pytest.approx(MULTISCATTER, abs=2e-3)
    assert (read.look.eta, read.look.roughness) == (1.38, pytest.approx(0.53**2))


def test_a_node_scales_the_dragon_and_not_its_distance(tmp_path):
    """DragonAttenuation's node is scaled by .25, those of AttenuationTest by many: distances are the world's."""
    whole, small = part(tmp_path, DRAGON), part(tmp_path, DRAGON, scale=[0.25, 0.25, 0.25])
    assert np.ptp(small.vertices, axis=0) == pytest.approx(0.25 * np.ptp(whole.vertices, axis=0))
    assert small.look.medium == whole.look.medium


@pytest.mark.parametrize("edge", [0.25, 0.5, 1.0, 2.0])
def test_columns_of_the_attenuation_test_are_of_one_shade(tmp_path, edge):
    """AttenuationTest: a cube of an edge, one of edge 1 whose node is scaled, and one of edge 1 in a medium as much
    denser let the same light through, which is what the row of sample colours is painted with.
    """
    blue, distance = [0.25, 0.45, 0.95], 0.8
    rows = []
    for size, scale, stretched in ((edge, 1.0, 1.0), (1.0, edge, 1.0), (1.0, 1.0, edge)):
        cube = trimesh.creation.box([size] * 3)
        stated = material("blue glass", **PASSES, **volume(blue, distance / stretched, size))
        read = part(tmp_path, stated, Surface(cube.vertices, cube.faces), scale=[scale] * 3)
        rows.append(np.exp(-attenuation(read) * np.ptp(read.vertices[:, 2])))
    assert rows == pytest.approx(np.array([np.power(blue, edge / distance)] * 3), rel=1e-5)


def test_anisotropy_changes_the_scattering_and_not_its_colour(tmp_path):
    """ScatterAnisotropy: balls from -1 to 1, both ends among them. The reduced albedo is the same in all, as far as the
    phase function has two sides; what is said to go on straight hardly scatters.
    """
    many = {g: part(tmp_path, anisotropy(g)).look.medium for g in (-1, -0.5, 0.0, 0.5, 1)}
    scattered = {g: np.array(medium.sigma_s_prime) for g, medium in many.items() if medium}
    albedo = {g: s / (s + np.array(many[g].sigma_a)) for g, s in scattered.items()}
    for g in (-1, -0.5, 0.5):
        assert albedo[g] == pytest.approx(albedo[0.0], rel=1e-6)
    falling = [scattered[g] for g in sorted(scattered)]
    assert (np.diff(falling, axis=0) < 0).all()
    assert (falling[-1] < 0.03 * falling[2]).all()


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        (DRAGON_SURFACE, "without attenuation, as clear as glass"),
        (STRENGTH, "without attenuation, as clear as glass"),
        (YELLOW, ""),
        (LEAVES, ""),
    ],
    ids=lambda given: given["name"] if isinstance(given, dict) else "",
)
def test_what_has_no_depth_keeps_the_colour_of_its_surface(tmp_path, stated, words):
    """DragonAttenuation's other variant, ScatterStrength, whose volume attenuates nothing, TransmissionTest and
    DiffuseTransmissionPlant, which are thin: no medium, and the report says why where there is a volume.
    """
    read = looks(tmp_path / "a.glb", stated)
    look = read.parts[0].look
    assert look.medium is None
    assert look.colour == pytest.approx(stated["pbrMetallicRoughness"].get("baseColorFactor", [1, 1, 1])[:3])
    assert any(words in note for note in read.notes) if words else not read.notes


def test_the_coat_is_said(tmp_path):
    """ClearCoatTest: what to type for its coat, whose roughness .03 is below the sharpest of ours."""
    (note,) = looks(tmp_path / "a.glb", COATED).notes
    assert "coat=1,coat_roughness=0.02" in note
