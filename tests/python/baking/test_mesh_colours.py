"""Colours of a mesh in its body: the right coefficients in the right places, and what a solve shows of them."""

from __future__ import annotations

import json

import numpy as np
import pytest

from baked import write_levels
from coloured_files import (
    GREEN,
    RED,
    across,
    coloured_glb,
    encoded,
    ramp,
    ramp_colour_0,
    ramp_glb,
    ramp_obj,
    ramp_ply,
    srgb,
    textured,
)
from quadgraph.api.engine import Engine
from quadgraph.api.lights import AmbientLight, DirectionalLight
from quadgraph.api.materials import Material, VolumeMaterial
from quadgraph.baking.colours.colour_options import ColourOptions
from quadgraph.baking.colours.colour_volume import mesh_colours
from quadgraph.baking.colours.reflectances import brightest, coefficients
from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere, join, moved

R = 10.0
BALL = icosphere(3, R)


@pytest.fixture(scope="module")
def body(tmp_path_factory):
    """A ball of 20 mm, baked in millimetres."""
    return write_levels(tmp_path_factory.mktemp("colours") / "ball.qgraph", [BALL])


def at(volume: VolumeMaterial, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients (n, 3) each, as the engine finds them."""
    return volume._compiled().at(np.asarray(points, float), np.zeros(3))


def wanted(colours: np.ndarray, path: float, eta: float) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of colours one by one, by the public inverse."""
    found = [Material.from_colour(tuple(each), path, eta) for each in colours]
    return tuple(np.array([getattr(each, name) for each in found]) for name in ("sigma_s_prime", "sigma_a"))


def directions(count: int) -> np.ndarray:
    vectors = np.random.default_rng(1).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@pytest.mark.parametrize(
    ("name", "write"), [("a.glb", ramp_glb), ("b.glb", ramp_colour_0), ("a.ply", ramp_ply), ("a.obj", ramp_obj)]
)
def test_at_the_surface_and_inside_are_the_surface_s_coefficients(body, tmp_path, name, write):
    """The ramp along x, whose nearest place of the surface is radially outwards; at the surface itself too."""
    options = ColourOptions(mean_free_path=0.8, eta=1.5, spacing=0.5)
    volume, _ = mesh_colours(write(tmp_path / name, BALL), body, options)
    ways = directions(300)
    for depth in (0.05, 1.0, 4.0):
        found = at(volume, (R - depth) * ways)
        for ours, known in zip(found, wanted(ramp((ways[:, 0] + 1) / 2), 0.8, 1.5), strict=True):
            assert ours == pytest.approx(known, rel=0.06, abs=0.002), depth


def test_coefficients_are_those_of_from_colour():
    colours = np.random.default_rng(0).uniform(0, 0.88, (50, 3))
    for ours, known in zip(coefficients(colours, np.full(3, 0.7), 1.4), wanted(colours, 0.7, 1.4), strict=True):
        assert ours == pytest.approx(known, rel=5e-4, abs=1e-6)


def test_what_is_brighter_than_a_body_can_be_is_cut_off(body, tmp_path):
    white = coloured_glb(tmp_path / "a.glb", BALL, {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1]}})
    volume, report = mesh_colours(white, body, ColourOptions(eta=1.5))
    assert report.cut == pytest.approx(1)
    assert any("brighter in a channel than" in note for note in report.notes)
    known = wanted(np.full((1, 3), brightest(1.5)), 1, 1.5)
    assert volume.sigma_a == pytest.approx(np.broadcast_to(known[1][0], volume.sigma_a.shape), rel=1e-3)


def test_below_the_colours_lies_the_base(body, tmp_path):
    """The surface's down to half of the depth, between them a mixture, the base from there on; as patterns too."""
    options = ColourOptions(mean_free_path=0.5, base="wax", depth=4, spacing=0.4)
    volume, report = mesh_colours(ramp_glb(tmp_path / "a.glb", BALL), body, options)
    assert report.eta == pytest.approx(1.44)
    ways = directions(200)
    upper = wanted(ramp((ways[:, 0] + 1) / 2), 0.5, report.eta)
    for ours, known in zip(at(volume, (R - 1.5) * ways), upper, strict=True):
        assert ours == pytest.approx(known, rel=0.06, abs=0.002)
    grid = np.argwhere(np.linalg.norm(positions(volume), axis=-1) < R - 4.5)
    from quadgraph import core

    cells = tuple(grid.T)
    deep = core.material_at(core.Material("wax"), positions(volume)[cells], np.zeros(len(grid)))
    assert volume.sigma_s_prime[cells] == pytest.approx(deep[0], rel=1e-5)
    assert volume.sigma_a[cells] == pytest.approx(deep[1], rel=1e-4)
    mixed = at(volume, [[R - 3, 0, 0]])[1][0, 1]
    low, high = sorted([at(volume, [[R - 4.4, 0, 0]])[1][0, 1], at(volume, [[R - 1.6, 0, 0]])[1][0, 1]])
    assert low < mixed < high


def positions(volume: VolumeMaterial) -> np.ndarray:
    """Middles of the cells, (nz, ny, nx, 3) mm."""
    counts = volume.sigma_a.shape[:3]
    z, y, x = np.meshgrid(*(np.arange(n) * volume.spacing for n in counts), indexing="ij")
    return np.stack([x, y, z], axis=-1) + np.asarray(volume.origin)


def test_outside_no_cell_is_empty(body, tmp_path):
    volume, _ = mesh_colours(ramp_glb(tmp_path / "a.glb", BALL), body, ColourOptions(mean_free_path=2))
    for cells in (volume.sigma_s_prime, volume.sigma_a):
        assert (cells > 0).all()
    assert volume.sigma_s_prime + volume.sigma_a == pytest.approx(0.5, rel=1e-5)
    low = np.asarray(volume.origin)
    assert (low < -R).all()
    assert (low + volume.spacing * (np.array(volume.sigma_a.shape[2::-1]) - 1) > R).all()


def test_colours_land_where_a_bake_has_put_the_mesh(tmp_path):
    """A body that was baked in another unit, and whose z points up; and one of another file of the same shape."""
    from quadgraph.baking.pipeline import BakeOptions, bake

    standing = Surface(np.stack([BALL.vertices[:, 0], 2 * BALL.vertices[:, 1], BALL.vertices[:, 2]], 1), BALL.triangles)
    mesh = coloured_glb(tmp_path / "a.glb", standing, textured(), encoded(stripes()), up_coordinates(standing))
    bake(mesh, tmp_path / "a.qgraph", BakeOptions(height_mm=30, up="z", surface_vertices=300, levels=1))
    volume, _ = mesh_colours(mesh, tmp_path / "a.qgraph", ColourOptions(eta=1.5))
    # y of the file is -z of the body; three mm of the body are two of the file.
    red, green = (wanted(each[None], 1.0, 1.5)[1][0] for each in (RED, GREEN))
    assert at(volume, [[0, 0, -25]])[1][0] == pytest.approx(green, rel=0.05)
    assert at(volume, [[0, 0, 25]])[1][0] == pytest.approx(red, rel=0.05)
    small = Surface(standing.vertices / 1000, standing.triangles)
    other = coloured_glb(tmp_path / "b.glb", small, textured(), encoded(stripes()), up_coordinates(standing))
    again, _ = mesh_colours(other, tmp_path / "a.qgraph", ColourOptions(eta=1.5))
    assert again.sigma_a == pytest.approx(volume.sigma_a, rel=0.02)


def up_coordinates(surface: Surface) -> np.ndarray:
    """Texture coordinates whose v goes by y."""
    return np.column_stack([across(surface), across(surface, 1)])


def stripes() -> np.ndarray:
    """RED above GREEN."""
    return np.repeat(srgb(np.stack([RED, GREEN]))[:, None], 32, axis=0)


def test_another_body_s_mesh_is_refused(body, tmp_path):
    with pytest.raises(InputError, match="give the body that was baked of this mesh"):
        mesh_colours(ramp_glb(tmp_path / "a.glb", cube(20)), body)


def test_a_stated_medium_goes_down_to_the_core(tmp_path):
    """Two boxes, one by its colour above a base, one by KHR_materials_volume: per metre in the file, per mm here."""
    boxes = [moved(cube(10), -8, 0, 0), moved(cube(10), 8, 0, 0)]
    body = write_levels(tmp_path / "boxes.qgraph", [join(*boxes)])
    path = coloured_glb(tmp_path / "a.gltf", boxes[0], {"pbrMetallicRoughness": {"baseColorFactor": [*RED, 1]}})
    document = json.loads(path.read_text())
    volume = {"thicknessFactor": 5, "attenuationDistance": 4, "attenuationColor": [0.5, 0.2, 0.9]}
    entering = {"KHR_materials_transmission": {"transmissionFactor": 1}}
    document["materials"].append({"extensions": {"KHR_materials_volume": volume} | entering})
    document["meshes"].append({"primitives": [document["meshes"][0]["primitives"][0] | {"material": 1}]})
    document["nodes"].append({"mesh": 1, "translation": [16, 0, 0]})
    document["scenes"][0]["nodes"].append(1)
    path.write_text(json.dumps(document))
    made, report = mesh_colours(path, body, ColourOptions(base="sigma_s_prime=2,sigma_a=0.5", depth=2, spacing=0.4))
    assert report.stated == pytest.approx(0.5, abs=0.01)
    for place in ([8, 0, 0], [11.5, 1, 1], [12.9, 0, 0]):
        scattering, absorption = at(made, [place])
        assert np.exp(-absorption[0] * 4) == pytest.approx([0.5, 0.2, 0.9], rel=0.01)
        assert scattering[0] == pytest.approx(0, abs=1e-3)
    assert at(made, [[-8, 0, 0]])[1][0] == pytest.approx(0.5, rel=1e-3)


def test_the_other_side_of_a_thin_wall_does_not_shine_through(tmp_path):
    """A plate of 1 mm, red above and green below, in cells of half a millimetre."""
    plate = Surface(cube(1).vertices * [20, 1, 20], cube(1).triangles)
    plate = Surface(plate.corners.reshape(-1, 3), np.arange(36).reshape(-1, 3))
    upper = np.repeat(plate.doubled_normals[:, 1] > 0, 3)
    uv = np.column_stack([np.full(36, 0.5), np.where(upper, 0.25, 0.75)])
    mesh = coloured_glb(tmp_path / "a.glb", plate, textured(), encoded(stripes()), uv)
    body = write_levels(tmp_path / "plate.qgraph", [Surface(cube(1).vertices * [20, 1, 20], cube(1).triangles)])
    volume, _ = mesh_colours(mesh, body, ColourOptions(eta=1.5, spacing=0.25))
    red, green = (wanted(each[None], 1.0, 1.5)[1][0] for each in (RED, GREEN))
    assert at(volume, [[0, 0.45, 0], [4, 0.4, -3]])[1] == pytest.approx(np.stack([red, red]), rel=0.03)
    assert at(volume, [[0, -0.45, 0], [4, -0.4, -3]])[1] == pytest.approx(np.stack([green, green]), rel=0.03)


def test_a_body_too_coarse_for_the_texture_says_so(body, tmp_path):
    fine = np.repeat(stripes(), 40, axis=1)
    mesh = coloured_glb(tmp_path / "a.glb", BALL, textured(), encoded(np.repeat(fine, 8, axis=0)))
    _, report = mesh_colours(mesh, body)
    assert report.detail < report.spacing < report.edge
    assert any("bake it finer" in note for note in report.notes)
    _, report = mesh_colours(mesh, body, ColourOptions(cells=1000))
    assert np.prod(report.cells) <= 1000
    assert any("allow more cells" in note for note in report.notes)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"mean_free_path": 0}, "mean_free_path: 0 found"),
        ({"mean_free_path": (1, np.nan, 1)}, "mean_free_path"),
        ({"mean_free_path": "1mm"}, "mean_free_path: text found"),
        ({"depth": 2}, "depth: found without a base"),
        ({"base": "wax", "depth": -1}, "depth: -1 found"),
        ({"base": "a.npz"}, "base: the volume 'a.npz' found"),
        ({"base": "waxx"}, "waxx"),
        ({"eta": 0.5}, "eta: 0.5 found, 1 to 3 allowed"),
        ({"cells": 10}, "cells: 10 found, 1,000 to"),
        ({"spacing": np.inf}, "spacing: inf found"),
    ],
)
def test_options_that_are_wrong(options, words):
    with pytest.raises(InputError) as error:
        ColourOptions(**options)
    assert words in str(error.value)


def test_a_spacing_that_is_too_fine_says_what_fits(body, tmp_path):
    with pytest.raises(InputError, match=r"spacing: 0.01 mm makes .* at most 1,000,000 are allowed; take about"):
        mesh_colours(ramp_glb(tmp_path / "a.glb", BALL), body, ColourOptions(spacing=0.01))


def test_a_thick_body_shows_the_colours_of_its_texture(tmp_path):
    """Halves of a ball of forty mean free paths, away from where they meet: within 4% under light from the
    front, which is what `reflectance` speaks of, and 0 to 10% brighter in even light, more of which enters aslant.
    """
    ball = icosphere(4, 20)
    body = write_levels(tmp_path / "ball.qgraph", [ball])
    pixels = np.repeat(srgb(np.stack([RED, GREEN]))[None], 4, axis=0)
    mesh = coloured_glb(tmp_path / "a.glb", ball, textured(), encoded(np.repeat(pixels, 32, axis=1)))
    material, _ = mesh_colours(mesh, body, ColourOptions(mean_free_path=1, eta=1.5))
    with Engine(body, device="cpu") as engine:
        engine.material = material
        engine.lights = [AmbientLight(irradiance=1)]
        engine.solve()
        surface = engine.surface()
        for colour, side in ((RED, -1), (GREEN, 1)):
            seen = surface.exitance[side * surface.position[:, 0] > 5]
            assert seen.mean(axis=0) / colour == pytest.approx(1.05, abs=0.05)
        for colour, side in ((RED, -1), (GREEN, 1)):
            engine.lights = [DirectionalLight(direction=(-side, 0, 0), irradiance=1)]
            engine.solve()
            surface = engine.surface()
            front = side * surface.position[:, 0] > 19.5
            assert surface.exitance[front].mean(axis=0) == pytest.approx(colour, rel=0.04)


def test_bright_colours_show_what_lies_below_them(tmp_path, short):
    """A base that shows .25, four mean free paths deep, takes nothing of a red of .2, of a blue of .8 over a third."""
    ball = icosphere(4, 20)
    body = write_levels(tmp_path / "ball.qgraph", [ball])
    mesh = coloured_glb(tmp_path / "a.glb", ball, {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.5, 0.8, 1]}})
    seen = []
    with Engine(body, device="cpu") as engine:
        engine.lights = [AmbientLight(irradiance=1)]
        for base in (None, "sigma_s_prime=0.9,sigma_a=0.1"):
            options = ColourOptions(eta=1.5, base=base, spacing=1.1 if short else 0.8)
            engine.material, _ = mesh_colours(mesh, body, options)
            engine.solve()
            seen.append(engine.surface().exitance.mean(axis=0))
    assert seen[1] / seen[0] == pytest.approx([1.006, 0.83, 0.62], abs=0.03)


def test_the_ramp_runs_across_the_ball():
    """What the other tests take for granted of the helper."""
    assert across(BALL)[[BALL.vertices[:, 0].argmin(), BALL.vertices[:, 0].argmax()]].tolist() == [0, 1]
