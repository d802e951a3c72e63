"""Colours of mesh files: the same ball in every kind of file, and what places of a texture mean."""

from __future__ import annotations

import json

import numpy as np
import pytest

from coloured_files import (
    GREEN,
    RED,
    coloured_glb,
    encoded,
    ramp,
    ramp_colour_0,
    ramp_glb,
    ramp_obj,
    ramp_pixels,
    ramp_ply,
    srgb,
    textured,
)
from quadgraph.mesh.looks.parts import ColouredMesh
from quadgraph.mesh.looks.read_looks import read_looks
from quadgraph.mesh.looks.texture import Texture, decoded
from shapes import icosphere

BALL = icosphere(3, 10)


def colours_at_middles(mesh: ColouredMesh) -> tuple[np.ndarray, np.ndarray]:
    """Places and linear colours at the middles of all triangles."""
    triangle = np.arange(len(mesh.triangles))
    weights = np.full((len(triangle), 3), 1 / 3)
    return mesh.vertices[mesh.triangles].mean(axis=1), mesh.colour_at(triangle, weights)


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("a.glb", ramp_glb),
        ("a.gltf", ramp_glb),
        ("b.glb", ramp_colour_0),
        ("a.ply", ramp_ply),
        ("a.obj", ramp_obj),
    ],
)
def test_a_ramp_is_the_same_in_every_file(tmp_path, name, write):
    """Within what eight bits of sRGB tell, and what lies between two vertices of the PLY."""
    places, found = colours_at_middles(read_looks(write(tmp_path / name, BALL)))
    assert len(found) == len(BALL.triangles)
    assert found == pytest.approx(ramp((places[:, 0] + 10) / 20), abs=0.004)


def test_vertex_colours_of_obj_are_srgb(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 0 1 0 1 0.5 0\nf 1 2 3\n")
    assert colours_at_middles(read_looks(path))[1] == pytest.approx(np.array([[1, 0.21404, 0]]), abs=1e-4)


def test_srgb_is_decoded_before_the_mean_of_pixels():
    """Half black and half white is half of the light, not the light of grey 128."""
    texture = Texture(np.array([[[0, 0, 0], [255, 255, 255]]], np.uint8), ("clamp", "clamp"))
    assert texture.at(np.array([[0.5, 0.5]])) == pytest.approx(0.5)
    grey = Texture(np.full((1, 1, 3), 128, np.uint8))
    assert grey.at(np.array([[0.3, 0.9]])) == pytest.approx(0.2158605, abs=1e-6)


@pytest.mark.parametrize(
    ("wrap", "columns"), [("repeat", [2, 0, 1, 2, 0]), ("clamp", [0, 0, 1, 2, 2]), ("mirror", [0, 0, 1, 2, 2])]
)
def test_beyond_its_edges_a_texture_goes_on(wrap, columns):
    values = np.array([0, 100, 255], np.uint8)
    texture = Texture(np.repeat(values[None, :, None], 3, axis=2), (wrap, "clamp"))
    places = np.column_stack([(np.arange(-1, 4) + 0.5) / 3, np.full(5, 0.5)])
    middles = texture.at((np.column_stack([np.arange(3) + 0.5, np.full(3, 1.5)])) / 3)
    assert texture.at(places) == pytest.approx(middles[columns])


def test_mirrored_far_away_it_runs_backwards():
    texture = Texture(ramp_pixels(16), ("mirror", "repeat"))
    u = np.linspace(0.1, 0.9, 7)
    here, there = (texture.at(np.column_stack([x, np.full(7, 0.3)])) for x in (u, 2 - u))
    assert here == pytest.approx(there)


def test_factor_and_texture_multiply(tmp_path):
    path = coloured_glb(tmp_path / "a.glb", BALL, textured(baseColorFactor=[0.5, 1, 0.25, 1]), encoded(ramp_pixels()))
    places, found = colours_at_middles(read_looks(path))
    assert found == pytest.approx(ramp((places[:, 0] + 10) / 20) * [0.5, 1, 0.25], abs=0.003)


def test_a_texture_transform_turns_scales_and_moves(tmp_path):
    """The ramp along u is read along -v after a quarter turn counter-clockwise: u' = -s v + o."""
    material = textured()
    said = {"rotation": np.pi / 2, "scale": [1.0, 0.5], "offset": [0.9, 0.0]}
    material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {"KHR_texture_transform": said}
    v = (BALL.vertices[:, 1] + 10) / 20
    uv = np.column_stack([np.full(len(v), 0.3), v])
    path = coloured_glb(tmp_path / "a.glb", BALL, material, encoded(ramp_pixels()), uv)
    places, found = colours_at_middles(read_looks(path))
    assert found == pytest.approx(ramp(0.9 - 0.5 * (places[:, 1] + 10) / 20), abs=0.004)


def test_textures_beside_the_file_and_below_it(tmp_path):
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "skin 1.jpg").write_bytes(encoded(np.full((8, 8, 3), srgb(RED)), "JPEG"))
    path = coloured_glb(tmp_path / "a.gltf", BALL, textured(), b"not read", images=[{"uri": "maps/skin%201.jpg"}])
    assert colours_at_middles(read_looks(path))[1] == pytest.approx(np.tile(RED, (len(BALL.triangles), 1)), abs=0.02)


def test_webp_comes_by_an_extension(tmp_path):
    picture = encoded(np.full((8, 8, 3), srgb(RED)), "WEBP")
    textures = [{"extensions": {"EXT_texture_webp": {"source": 0}}}]
    path = coloured_glb(tmp_path / "a.glb", BALL, textured(), picture, textures=textures)
    assert colours_at_middles(read_looks(path))[1] == pytest.approx(np.tile(RED, (len(BALL.triangles), 1)), abs=0.03)


def test_parts_have_their_own_colours(tmp_path):
    """Two nodes, one of them mirrored: transforms, and which way faces look, as the bake has them."""
    path = coloured_glb(tmp_path / "a.gltf", BALL, {"pbrMetallicRoughness": {"baseColorFactor": [*RED, 1]}})
    document = json.loads(path.read_text())
    document["materials"].append({"pbrMetallicRoughness": {"baseColorFactor": [*GREEN, 0.5]}})
    document["meshes"].append({"primitives": [document["meshes"][0]["primitives"][0] | {"material": 1}]})
    document["nodes"].append({"mesh": 1, "translation": [30, 0, 0], "scale": [-1, 1, 1]})
    document["scenes"][0]["nodes"].append(1)
    path.write_text(json.dumps(document))
    mesh = read_looks(path)
    places, found = colours_at_middles(mesh)
    assert found[places[:, 0] < 15] == pytest.approx(np.tile(RED, (len(BALL.triangles), 1)))
    assert found[places[:, 0] > 15] == pytest.approx(np.tile(GREEN, (len(BALL.triangles), 1)))
    corners = mesh.vertices[mesh.triangles]
    outwards = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    centre = np.where(places[:, :1] > 15, [[30.0, 0, 0]], [[0.0, 0, 0]])
    assert (np.einsum("ij,ij->i", outwards, places - centre) > 0).all()


def test_diffuse_colour_of_older_files(tmp_path):
    said = {"diffuseTexture": {"index": 0}, "diffuseFactor": [1, 0.5, 1, 1]}
    material = {"extensions": {"KHR_materials_pbrSpecularGlossiness": said}}
    path = coloured_glb(tmp_path / "a.glb", BALL, material, encoded(ramp_pixels()))
    places, found = colours_at_middles(read_looks(path))
    assert found == pytest.approx(ramp((places[:, 0] + 10) / 20) * [1, 0.5, 1], abs=0.003)


def test_options_of_a_map_are_read(tmp_path):
    line = "map_Kd -clamp on -s 0.5 1 1 -o 0.25 0 -bm 1 ramp.png"
    places, found = colours_at_middles(read_looks(ramp_obj(tmp_path / "a.obj", BALL, line)))
    assert found == pytest.approx(ramp(0.25 + 0.5 * (places[:, 0] + 10) / 20), abs=0.004)


def test_sixteen_bits_of_grey_keep_their_shade():
    values = np.array([[0, 32768, 65535]], np.uint16)
    assert decoded(encoded(values), "x")[0, :, 0].tolist() == [0, 127, 255]
