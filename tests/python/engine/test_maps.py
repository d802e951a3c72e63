"""Volumes carried into other bodies: onto the same one nothing changes, onto others depths stay what they are."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import trimesh

from baked import write_levels
from engine_program import ENGINE
from quadgraph import cli
from quadgraph.baking import bare
from quadgraph.base.errors import FormatError, InputError
from shapes import from_trimesh, icosphere, torus

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

from quadgraph import Engine, Stage, VolumeMap, VolumeMaterial, default_lights  # noqa: E402
from quadgraph.api.volume_map import MapKind, MapRepeat  # noqa: E402

LAMPS = [light.to_dict() for light in default_lights()]  # what an engine has

DOCS = Path(__file__).resolve().parents[3] / "docs"
SIDES = np.array([16.0, 12.0, 8.0])  # mm, of the block
BOX = np.array([-SIDES / 2, SIDES / 2])
RADIUS = 10.0  # mm, of the ball


def wavy(points):
    """Coefficients that differ everywhere."""
    x, y, z = points.T[:, :, None]
    return 1 + 0.5 * np.sin(x + 2 * y) * [1, 0.5, 0.2], 0.1 + 0.05 * np.cos(z - y) * [0.2, 0.5, 1]


def layers_of(sides, spacing):
    """A block of these sides, mm, whose sigma_a is the depth below its nearest face, 1 per 10 mm."""
    half = np.broadcast_to(sides, 3) / 2

    def layered(points):
        return 1.0, np.maximum((half - np.abs(points)).min(axis=1), 0) / 10

    return VolumeMaterial.from_function(layered, np.array([-half, half]), spacing)


def block_material():
    return VolumeMaterial.from_function(wavy, BOX, 0.5, eta=1.4)


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    mesh = trimesh.creation.box(extents=SIDES)
    for _ in range(3):
        mesh = mesh.subdivide()
    return write_levels(tmp_path_factory.mktemp("maps") / "block.qgraph", [from_trimesh(mesh)])


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("maps") / "ball.qgraph", [icosphere(3, RADIUS)])


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("maps") / "ring.qgraph", [torus()])


def values_at(material, points):
    """sigma_s_prime and sigma_a at places of a body, as the engine has them."""
    return core.Volume(*(np.asarray(each, np.float32) for each in (material.sigma_s_prime, material.sigma_a)),
                       np.broadcast_to(material.spacing, 3).tolist(), material.origin, material.eta, {}).at(
        points.astype(np.float32), (0, 0, 0))  # fmt: skip


def inside_of(body):
    """Places in the tets of a body, and its vertices."""
    graph = core.load(body)
    return np.concatenate([core.points_in_tets(graph, 0), graph.levels[0].vertices])


@pytest.mark.parametrize("how", ["box", "shell", "volume", "box,from=B", "shell,from=B", "volume,from=B"])
def test_onto_the_same_block_nothing_changes(block, how):
    material = block_material()
    carried, report = material.mapped(block, how.replace("B", str(block)))
    points = inside_of(block)
    for found, expected in zip(values_at(carried, points), values_at(material, points), strict=True):
        assert found == pytest.approx(expected, rel=1e-6)
    assert report.stretch == pytest.approx((1, 1, 1), abs=1e-6)
    assert (report.core, report.flipped_tets) == (0, 0)


@pytest.mark.parametrize("kind", ["box", "shell", "volume"])
@pytest.mark.parametrize("name", ["ball", "ring"])
def test_onto_the_same_body_nothing_changes(request, name, kind):
    body = request.getfixturevalue(name)
    points = inside_of(body)
    material = VolumeMaterial.from_function(wavy, np.array([points.min(axis=0) - 0.1, points.max(axis=0)]), 0.7)
    carried, report = material.mapped(body, VolumeMap(kind, source=body))
    for found, expected in zip(values_at(carried, points), values_at(material, points), strict=True):
        assert found == pytest.approx(expected, rel=1e-6)
    assert report.stretch == pytest.approx((1, 1, 1), abs=1e-6)
    assert report.flipped_tets == 0


def test_a_shell_keeps_depths_and_interpolates_what_is_deeper(ball):
    """Layers of the block are layers of the ball, mm for mm; where all about the core is alike, so is the core."""
    # So large a block that the ball's shadow on each of its faces stays far from the others.
    carried, report = layers_of(40, 0.5).mapped(ball, "shell,depth=3")
    points = np.random.default_rng(2).normal(size=(2000, 3))
    points *= RADIUS * np.random.default_rng(3).uniform(0.1, 0.95, (2000, 1)) / np.linalg.norm(points, axis=1)[:, None]
    level = core.load(ball).levels[0]
    corners = level.vertices.astype(float)[level.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    depth = ((corners[:, 0] * normals).sum(axis=1) - points @ normals.T).min(axis=1)  # of a convex body
    found = 10 * values_at(carried, points)[1][:, 0]
    shallow = depth < 2.5
    # At a facet's edge the nearest place changes, and cells are linear between: some hundredths of a mm.
    assert found[shallow] == pytest.approx(depth[shallow], abs=0.1)
    assert found[depth > 3.5] == pytest.approx(3, abs=0.05)
    assert report.core == pytest.approx((1 - 3.5 / RADIUS) ** 3, rel=0.05)  # the first cells have the shell's end
    assert report.stretch[1] == pytest.approx(1, abs=0.05)


def test_the_core_is_between_what_is_about_it(ball):
    material = block_material()
    carried, report = material.mapped(ball, "shell,depth=1")
    assert report.core > 0.6
    for name in ("sigma_s_prime", "sigma_a"):
        found, source = getattr(carried, name), getattr(material, name)
        assert found.min() >= source.min() * (1 - 1e-5)
        assert found.max() <= source.max() * (1 + 1e-5)
        deep = values_at(carried, np.zeros((1, 3)))[name == "sigma_a"][0]
        assert deep == pytest.approx(source.mean(axis=(0, 1, 2)), rel=0.25)


def test_a_shell_is_as_much_larger_as_scale_says(ball):
    carried, _ = layers_of(40, 0.5).mapped(ball, "shell,scale=2,depth=3")
    found = 10 * values_at(carried, np.array([[0, 0, RADIUS - 2.0]]))[1][0, 0]
    assert found == pytest.approx(1, abs=0.1)


def test_depths_below_another_surface_are_scaled_too(ball):
    def by_depth(points):
        return 1.0, np.maximum(RADIUS - np.linalg.norm(points, axis=1), 0) / 10

    material = VolumeMaterial.from_function(by_depth, np.array([[-RADIUS] * 3, [RADIUS] * 3]), 0.8)
    for scale in (1, 2):
        carried, _ = material.mapped(ball, VolumeMap("shell", scale=scale, source=ball))
        found = 10 * values_at(carried, np.array([[0, 0, RADIUS - 1.5]]))[1][0, 0]
        assert found == pytest.approx(1.5 / scale, abs=0.15)


def test_a_box_is_stretched_to_the_body_axis_by_axis(ball):
    material = block_material()
    carried, report = material.mapped(ball, "box")
    assert carried.spacing == pytest.approx(0.5 * 2 * RADIUS / SIDES, rel=1e-3)
    assert np.array_equal(carried.sigma_a, material.sigma_a)
    assert report.stretch == pytest.approx((20 / 16, 20 / 12, 20 / 8), rel=1e-3)


def test_a_small_box_is_mirrored_or_ends(ball):
    material = block_material()
    half = {repeat: material.mapped(ball, f"box,scale=0.5,repeat={repeat}")[0] for repeat in ("mirror", "clamp")}
    whole = material.mapped(ball, "box")[0]
    inner, edge, outer = np.array([[0, 0, 4.0]]), np.array([[0, 0, 5.0]]), np.array([[0, 0, 6.0]])
    for carried in half.values():
        assert values_at(carried, inner)[1] == pytest.approx(values_at(whole, 2 * inner)[1], rel=1e-3)
    assert values_at(half["mirror"], outer)[1] == pytest.approx(values_at(whole, 2 * inner)[1], rel=1e-3)
    assert values_at(half["clamp"], outer)[1] == pytest.approx(values_at(whole, 2 * edge)[1], rel=1e-3)


def test_a_ball_is_laid_into_the_block_whole(ball):
    """By a harmonic map: no tet inside out, what is on the surface on the surface, the middle in the middle."""
    material = layers_of(SIDES, 0.25)
    carried, report = material.mapped(ball, "volume")
    assert report.tets > 1000
    assert report.flipped_tets == 0
    vertices = core.load(ball).levels[0].vertices[: core.load(ball).levels[0].surface_vertex_count]
    assert 10 * values_at(carried, vertices)[1].mean() < 0.3
    assert 10 * values_at(carried, np.zeros((1, 3)))[1][0, 0] == pytest.approx(SIDES[2] / 2, abs=0.2)


def test_what_is_stated_of_coefficients_goes_along(ball):
    plain = block_material()
    stated = {name: np.full(plain.sigma_a.shape, value) for name, value in
              (("sigma_a_deviation", 0.2), ("sigma_a_resolution", 3.0))}  # fmt: skip
    material = VolumeMaterial(plain.sigma_s_prime, plain.sigma_a, plain.spacing, plain.origin, 1.4, **stated)
    carried, _ = material.mapped(ball, "shell,scale=2")
    assert carried.sigma_a_deviation == pytest.approx(0.2, rel=1e-4)
    assert carried.sigma_a_resolution == pytest.approx(6, rel=1e-4)  # a length, and all is twice as long
    assert carried.eta == pytest.approx(1.4)


def test_the_same_map_gives_the_same_bits(ball):
    first, second = (block_material().mapped(ball, "shell,depth=2")[0] for _ in range(2))
    assert np.array_equal(first.sigma_a, second.sigma_a)
    assert np.array_equal(first.sigma_s_prime, second.sigma_s_prime)


def test_every_way_to_say_it_shows_the_same(tmp_path, ball, block, capsys):
    """A text, a file that is mapped, a scene's text, its object, and an option beside it."""
    block_material().save(tmp_path / "wax.npz")
    how = f"shell,depth=2,from={block}"
    assert cli.main(["volume", str(tmp_path / "wax.npz"), "--map", how, "--body", str(ball),
                     "-o", str(tmp_path / "mapped.npz")]) == 0  # fmt: skip
    assert "a mm of the source is" in capsys.readouterr().out
    (tmp_path / "ball.qgraph").symlink_to(ball)
    (tmp_path / "block.qgraph").symlink_to(block)
    parts = {"volume": "wax.npz", "map": "shell", "depth": 2, "from": "block.qgraph"}
    materials = ["mapped.npz", "wax.npz,map=shell,depth=2,from=block.qgraph", parts]
    found = []
    for number, material in enumerate(materials):
        path = tmp_path / f"{number}.json"
        scene = {"body": "ball.qgraph", "material": material, "lights": LAMPS, "solver": {"cycles": 2}}
        path.write_text(json.dumps(scene))
        with Stage() as stage:
            stage.show(path)
            stage.solve()
            found.append(stage.engine.surface().exitance)
    with Engine(ball) as engine:
        engine.set_light_roughness(None)  # as scenes have it
        engine.material = f"{tmp_path / 'wax.npz'},map={how}"
        engine.solve(cycles=2)
        found.append(engine.surface().exitance)
    for other in found[1:]:
        assert np.array_equal(found[0], other)


@pytest.mark.skipif(ENGINE is None, reason="quadgraph-engine is not built: run tools/setup")
def test_programs_take_the_map_beside_a_scene_or_a_body(tmp_path, ball):
    block_material().save(tmp_path / "wax.npz")
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps({"body": str(ball), "material": "wax.npz"}))
    usual = ["--map", "shell,depth=2", "--size", "24x24", "--cycles", "2"]
    pictures = [tmp_path / f"{name}.exr" for name in ("by-engine", "by-render")]
    subprocess.run([ENGINE, scene, "--headless", *usual, "-o", pictures[0]], check=True, capture_output=True)
    assert cli.main(["render", str(scene), *usual, "-o", str(pictures[1])]) == 0
    radiance = [np.array(core.read_image(path)) for path in pictures]
    assert radiance[0].max() > 0
    assert np.allclose(*radiance, rtol=1e-5)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ("shel", "did you mean 'shell'"),
        ("shell,scale=0", "map: scale: found 0, allowed is 0.01 to 100"),
        ("shell,depth=nan", "map: depth: found 'nan'"),
        ("shell,depth=0", "map: depth: found 0, allowed is more than 0"),
        ("shell,repeat=mirrored", "allowed are mirror, clamp"),
        ("shell,sale=2", "did you mean 'scale'"),
        ("shell,scale=2,scale=2", "found twice"),
        ("volume,scale=2", "map: scale: found with volume"),
        ("box,depth=2", "map: depth: found with box"),
        ("shell,from=block.obj", "bake it first"),
        ("shell,from=nowhere.qgraph", "nowhere.qgraph: cannot be read"),
        ("", "allowed are box, shell, volume"),
    ],
)
def test_wrong_maps_are_refused_with_what_is_allowed(ball, how, said):
    with pytest.raises(InputError, match=said):
        block_material().mapped(ball, how)


def test_the_names_of_python_and_of_the_schema_are_the_engine_s():
    material = json.loads((DOCS / "scene.schema.json").read_text())["$defs"]["material"]["anyOf"][1]["properties"]
    for kind, text, member in ((MapKind, "none", "map"), (MapRepeat, "box,repeat=none", "repeat")):
        with pytest.raises(InputError) as refused:
            core.with_map("wax.npz", text)
        names = str(refused.value).rpartition("allowed are ")[2].split(", ")
        assert list(get_args(kind)) == names == material[member]["enum"]


def test_a_map_that_would_tear_is_refused(ring, ball):
    with pytest.raises(InputError, match=r"found a body of 1 piece\(s\) with 1 handle\(s\).*take box or shell"):
        block_material().mapped(ring, "volume")
    with pytest.raises(InputError, match=r"allowed is that of the source, 1 piece\(s\) with 1 handle\(s\)"):
        block_material().mapped(ball, f"volume,from={ring}")


def test_volumes_and_bodies_that_do_not_serve(tmp_path, ball):
    flat = VolumeMaterial(np.ones((1, 4, 4)), np.ones((1, 4, 4)), 1.0)
    with pytest.raises(InputError, match="one cell along an axis"):
        flat.mapped(ball, "volume")
    assert np.ptp(flat.mapped(ball, "shell")[0].sigma_a) < 1e-5
    even = VolumeMaterial(np.ones((1, 1, 1)), np.ones((1, 1, 1)), 1.0)
    assert even.mapped(ball, "shell")[0].sigma_a.shape == (1, 1, 1, 3)
    (tmp_path / "no.qgraph").write_bytes(b"no")
    with pytest.raises(FormatError):
        even.mapped(tmp_path / "no.qgraph", "shell")
    scene = {"body": str(ball), "material": {"volume": "wax.npz", "repeat": "mirror"}}
    with pytest.raises(InputError, match="/material/map"):
        core.check_scene(json.dumps(scene))
    scene["material"] = {"volume": "wax.npz", "map": "shell", "size": 2}
    with pytest.raises(InputError, match="/material/size"):
        core.check_scene(json.dumps(scene))
    with pytest.raises(InputError, match=r"/material.*allowed is the name of a file \.npz"):
        core.check_scene(json.dumps({"body": str(ball), "material": {"volume": "wax.vdb"}}))
    with pytest.raises(InputError, match="found with the material 'marble'"):
        core.with_map("marble", "shell")


def test_a_sheet_without_an_inside_takes_what_wants_none(tmp_path):
    """For shortest paths any surface is a body, a flat one too, which has no levels."""
    mesh = tmp_path / "sheet.obj"
    mesh.write_text("v 0 0 0\nv 20 0 0\nv 20 15 0\nv 0 15 0\nf 1 2 3\nf 1 3 4\n")
    bare.write(mesh, tmp_path / "sheet.qgraph", unit="mm")
    material = block_material()
    for how in ("box", "shell", "box,scale=0.3"):
        carried, _ = material.mapped(tmp_path / "sheet.qgraph", how)
        assert np.isfinite(carried.sigma_a).all()
        assert carried.sigma_a.max() > carried.sigma_a.min() >= 0
    with pytest.raises(InputError, match="found a body without tets"):
        material.mapped(tmp_path / "sheet.qgraph", "volume")


def test_cells_are_never_too_many(ball):
    """However small those of the source are, or however large the body beside them."""
    tiny = VolumeMaterial(np.ones((2, 2, 2)), np.arange(8.0).reshape(2, 2, 2), 1e-30)
    carried, _ = tiny.mapped(ball, "box,scale=0.01")
    assert carried.sigma_a[..., 0].size <= 1e6
    assert np.isfinite(carried.sigma_a).all()
