"""Bodies that lie within others: tets meet the surface that they share, level by level, and each is of its body."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from quadgraph import cli
from quadgraph.baking import embedding
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.embedding import Embedded, Nest
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.baking.surface_changes import refined
from quadgraph.base.errors import InputError
from quadgraph.file import qgraph_file
from quadgraph.mesh.surface import Surface
from quadgraph.tets.tet_geometry import FACE_CORNERS, determinants
from shapes import cube, icosphere, join, moved, torus, write_obj

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


def turned_inside_out(surface: Surface) -> Surface:
    return Surface(surface.vertices, surface.triangles[:, ::-1])


# Jelly with a cavity; in it a ring, a hollow stone that the jelly fills, and a stone with a core; a ball beside.
SHAPES = {
    "core": moved(icosphere(2, 1.0), 4.0, 0.3, 0.0),
    "ball": moved(icosphere(2, 3.0), 14.0, 0.0, 0.0),
    "jelly": join(icosphere(4, 10.0), turned_inside_out(moved(icosphere(2, 1.5), 0.0, 6.0, 0.0))),
    "stone": moved(icosphere(3, 2.5), 4.0, 0.0, 0.5),
    "hollow": moved(join(icosphere(3, 2.0), turned_inside_out(icosphere(2, 1.0))), -4.0, 0.0, 0.0),
    "ring": moved(torus(3.0, 0.8, 32, 16), 0.0, -5.0, 0.0),
}
WITHIN = {"core": "stone", "stone": "jelly", "hollow": "jelly", "ring": "jelly"}


@pytest.fixture(scope="module")
def baked(tmp_path_factory):
    """The report of the bake of all shapes, and its file."""
    folder = tmp_path_factory.mktemp("nest")
    meshes = [BodyMesh(name, write_obj(shape, folder / f"{name}.obj"), unit="mm") for name, shape in SHAPES.items()]
    return bake_bodies(meshes, folder / "nest.qgraph", BakeOptions(visibility_rays=16)), folder / "nest.qgraph"


def volumes_of(path, level: int) -> dict[str, float]:
    """Volume of the tets of each body, mm^3."""
    loaded = _core.load(path)
    of = loaded.levels[level]
    volumes = np.bincount(of.tet_bodies, determinants(of.vertices, of.tets.astype(np.int64)) / 6)
    return dict(zip(loaded.bodies, volumes, strict=True))


def test_the_report_and_the_file_say_what_lies_within_what(baked):
    report, path = baked
    for name, host in WITHIN.items():
        said = f"{name}: lies within {host} and shares its surface with it, with no air between"
        assert said in report.notes
    assert sum("lies within" in note for note in report.notes) == len(WITHIN)
    bodies = qgraph_file.read(path).metadata["bodies"]
    assert {body["name"]: body["within"] for body in bodies if "within" in body} == WITHIN
    loaded = _core.load(path)
    assert [loaded.bodies[host] for host in loaded.hosts] == [WITHIN.get(name, name) for name in loaded.bodies]


def test_each_body_has_the_volume_between_its_surface_and_those_within(baked):
    volume = {name: shape.volume for name, shape in SHAPES.items()}
    wanted = volume | {"stone": volume["stone"] - volume["core"]}
    wanted["jelly"] -= volume["stone"] + volume["hollow"] + volume["ring"]
    assert volumes_of(baked[1], 0) == pytest.approx(wanted, rel=1e-5)
    told = {body["name"]: body["volume_mm3"] for body in qgraph_file.read(baked[1]).metadata["bodies"]}
    assert told == pytest.approx(wanted, rel=1e-5)


def test_tets_meet_the_shared_surface_with_their_faces_and_share_its_vertices(baked):
    loaded = _core.load(baked[1])
    for number, level in enumerate(loaded.levels):
        tets, links, body = (np.asarray(each).astype(np.int64) for each in (level.tets, level.links, level.tet_bodies))
        inside = links < len(tets)
        differ = inside & (body[np.where(inside, links, 0)] != body[:, None])
        tet, corner = np.nonzero(differ)
        faces = tets[tet[:, None], FACE_CORNERS[corner]]
        for name in WITHIN if number == 0 else ():
            one = loaded.bodies.index(name)
            shared = np.sort(faces[body[tet] == one], axis=1)
            shape = SHAPES[name]
            alone = len(shape.triangles) + (len(SHAPES["core"].triangles) if name == "stone" else 0)
            assert len(np.unique(shared, axis=0)) == alone
            assert cKDTree(level.vertices[np.unique(shared)]).query(shape.vertices)[0].max() < 1e-5
        assert differ.any()
        on_surface = np.asarray(level.tet_bodies)[level.face_tets]
        assert {loaded.bodies[k] for k in np.unique(on_surface)} == {"jelly", "ball"}
    shown = loaded.levels[0].tet_bodies[loaded.levels[0].face_tets[loaded.display["face"]]]
    assert len(shown) == len(SHAPES["jelly"].vertices) + len(SHAPES["ball"].vertices)


def test_coarser_levels_have_the_bodies_in_their_places(baked):
    report, path = baked
    assert len(report.levels) > 1
    fine, coarse = volumes_of(path, 0), volumes_of(path, 1)
    assert report.levels[1]["tets"] < 0.5 * report.levels[0]["tets"]
    for name, volume in coarse.items():
        assert volume == pytest.approx(fine[name], rel=0.4 if name in ("core", "hollow") else 0.15), name


def test_the_same_nest_gives_the_same_bytes(tmp_path):
    shapes = {"a": icosphere(2, 5.0), "b": icosphere(1, 2.0)}
    paths = {name: write_obj(shape, tmp_path / f"{name}.obj") for name, shape in shapes.items()}
    for file in ("one", "two"):
        meshes = [BodyMesh(name, path, unit="mm") for name, path in paths.items()]
        bake_bodies(meshes, tmp_path / f"{file}.qgraph", BakeOptions(visibility_rays=8))
    assert (tmp_path / "one.qgraph").read_bytes() == (tmp_path / "two.qgraph").read_bytes()


def test_surfaces_that_cross_once_they_are_simplified_are_finer_or_refused():
    """Balls 0.03 mm from each other whose triangles lie otherwise, so that coarser ones, of 0.025 mm height, cross."""
    ball = icosphere(4, 10.0)
    turned = Rotation.from_euler("xyz", [20, 33, 47], degrees=True).apply(icosphere(4, 9.97).vertices)
    tight = Embedded("tight", Surface(turned, ball.triangles))
    chain, notes = Nest(ball, [tight], 0, None).chain(None, lambda text: None)
    assert any("have the surfaces of level" in note or "cross" in note for note in notes)
    for level in chain:
        assert level.outer.volume > level.inner[0].volume
    with pytest.raises(InputError, match="surface_vertices or refine: as they make them, surfaces of bodies within"):
        Nest(ball, [Embedded("tight", tight.surface, 300)], 0, None)
    with pytest.raises(InputError, match="tight: surface_vertices: 9999 found"):
        Nest(ball, [Embedded("tight", tight.surface, 9999)], 0, None)
    assert embedding.LevelSurfaces(ball, [tight.surface]).whole.triangles.max() == 2 * len(ball.vertices) - 1


def test_the_command_line_bakes_what_lies_within_and_tells(tmp_path, capsys):
    meshes = {"jelly": cube(10.0), "stone": moved(icosphere(2, 2.0), 1.0, 0.0, 0.0)}
    paths = [str(write_obj(shape, tmp_path / f"{name}.obj")) for name, shape in meshes.items()]
    file = str(tmp_path / "both.qgraph")
    assert cli.main(["bake", *paths, "--join", "--unit", "mm", "-o", file]) == 0
    assert "stone: lies within jelly" in capsys.readouterr().out
    assert cli.main(["info", file]) == 0
    assert "within" in capsys.readouterr().out
    other = str(tmp_path / "c.qgraph")
    assert cli.main(["bake", *paths, "--join", "--unit", "mm", "--mesher", "cgal", "-o", other]) == 1
    assert 'jelly: mesher: "cgal" found with a body within another' in capsys.readouterr().err
    assert not (tmp_path / "c.qgraph").exists()


def test_triangles_around_others_are_cut_for_a_material_unless_they_would_cross_them():
    outer, checker = icosphere(2, 10.0), "checker,period=6"
    nest = Nest(outer, [Embedded("stone", icosphere(2, 3.0))], 0, None)
    finer = refined(nest.finest.outer, [checker])
    assert finer.cuts
    assert nest.take(finer) == [finer.note]
    assert nest.finest.outer is finer.surface
    near = Nest(outer, [Embedded("stone", icosphere(2, 9.0))], 0, None)
    kept = near.finest.outer
    sunk = refined(Surface(0.9 * outer.vertices, outer.triangles), [checker])  # cuts the stone
    assert "stay as they are" in near.take(sunk)[0]
    assert near.finest.outer is kept
