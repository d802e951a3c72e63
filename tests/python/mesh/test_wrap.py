"""Meshes that are no solids: refused with the way out, and baked with --wrap, whose distance is measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from quadgraph import cli
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.errors import InputError, QuadGraphError
from quadgraph.file import qgraph_file
from quadgraph.mesh import repair, wrap
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere, join, moved, torus, write_obj

LIMITS = (60.0, 2 << 30)


def without(surface: Surface, gone: np.ndarray) -> Surface:
    """The surface without some triangles (m,) bool."""
    return Surface(surface.vertices, surface.triangles[~gone])


def bowl(radius: float = 10.0) -> Surface:
    """The upper half of a ball's surface."""
    ball = icosphere(4, radius)
    return without(ball, ball.corners.mean(axis=1)[:, 1] < 0)


def torn(surface: Surface) -> Surface:
    """No two triangles share a vertex, and each is moved a little."""
    corners = surface.corners + np.random.default_rng(1).normal(scale=0.02, size=(len(surface.triangles), 1, 3))
    return Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def mobius() -> Surface:
    """A strip with one side, 4 wide on a circle of radius 10."""
    around, across = np.meshgrid(np.linspace(0, 2 * np.pi, 40, endpoint=False), np.linspace(-2, 2, 5), indexing="ij")
    radius = 10 + across * np.cos(around / 2)
    grid = np.stack([radius * np.cos(around), across * np.sin(around / 2), radius * np.sin(around)], axis=-1)
    cells = []
    for i in range(40):
        for j in range(4):
            turned = i == 39
            here, there = 5 * i + j, (4 - j if turned else 5 * (i + 1) + j)
            cells += [
                [here, here + 1, there],
                [here + 1, there - 1 if turned else there + 1, there],
            ]
    return Surface(grid.reshape(-1, 3), np.array(cells))


def soup() -> Surface:
    """Two hundred triangles anywhere in a ball of radius 10."""
    random = np.random.default_rng(2)
    middles = random.normal(size=(200, 1, 3))
    middles *= 10 * random.random((200, 1, 1)) ** (1 / 3) / np.linalg.norm(middles, axis=2, keepdims=True)
    corners = middles + random.normal(scale=2, size=(200, 3, 3))
    return Surface(corners.reshape(-1, 3), np.arange(600).reshape(-1, 3))


def fins() -> Surface:
    """A cube with sheets that stand on its edges: edges of three triangles and more, everywhere."""
    sheets = []
    for axis in range(3):
        sheet = trimesh.creation.box((10, 10, 10)).subdivide()
        flat = sheet.vertices.copy()
        flat[:, axis] = 0
        sheets.append(Surface(flat + 4, sheet.faces.astype(np.int64)))
    return join(cube(8), *sheets)


DEFECTS = {
    "half open": bowl,
    "crossing": lambda: join(torus(10, 4, 24, 12), moved(torus(10, 4, 24, 12), 9, 1, 2)),
    "torn": lambda: torn(icosphere(3, 10)),
    "one-sided": mobius,
    "soup": soup,
    "sheets": fins,
    "a plate": lambda: Surface(
        np.array([[0, 0, 0], [20, 0, 0], [20, 0, 5], [0, 0, 5.0]]), np.array([[0, 1, 2], [0, 2, 3]])
    ),
    "inside out in parts": lambda: torn(
        Surface(
            icosphere(3, 10).vertices,
            np.vstack([icosphere(3, 10).triangles[::2], icosphere(3, 10).triangles[1::2, ::-1]]),
        )
    ),
    "many holes": lambda: without(
        icosphere(3, 10), np.random.default_rng(3).random(len(icosphere(3, 10).triangles)) < 0.3
    ),
    "walls without thickness": lambda: join(bowl(), bowl(), bowl(4.0)),
}


LONG = ("sheets", "soup", "inside out in parts", "walls without thickness", "crossing")


@pytest.mark.parametrize(
    "defect", [pytest.param(name, marks=pytest.mark.long) if name in LONG else name for name in DEFECTS]
)
def test_what_cannot_be_repaired_is_refused_with_the_way_out_and_baked_with_it(tmp_path: Path, defect: str):
    surface = DEFECTS[defect]()
    mesh = write_obj(surface, tmp_path / "mesh.obj")
    options = {"unit": "mm", "levels": 1, "visibility_rays": 0, "relax_nodes": 0}
    with pytest.raises(InputError, match=r"mesh\.obj: .*(; --wrap auto bakes a closed surface around it)"):
        bake(mesh, tmp_path / "body.qgraph", BakeOptions(**options))
    report = bake(mesh, tmp_path / "body.qgraph", BakeOptions(wrap="auto", **options))
    assert any(note.startswith("wrapped at ") for note in report.notes)
    file = qgraph_file.read(tmp_path / "body.qgraph")
    assert file.metadata["options"]["wrap"] == "auto"
    assert file.metadata["repairs"][0]["what"].startswith("wrapped at ")
    size = float(file.metadata["repairs"][0]["what"].split()[2])
    found = file.sections["display/vertices"]
    assert (found.min(axis=0) > surface.vertices.min(axis=0) - size / 20).all()
    assert (found.max(axis=0) < surface.vertices.max(axis=0) + size / 20).all()


def test_auto_does_not_go_in_through_a_hole():
    """The hole is as wide as the bowl, 20 mm: with a size above that the wrap covers it, with 2 mm it is a shell."""
    whole = 2 / 3 * np.pi * 10**3
    around = wrap.wrap(bowl(), 22.0, "bowl", *LIMITS)
    assert 0.9 < around.surface.volume / whole < 1.4
    shell = wrap.wrap(bowl(), 2.0, "bowl", *LIMITS)
    assert shell.surface.volume < 0.2 * whole
    punched = without(icosphere(4, 10), icosphere(4, 10).corners.mean(axis=1)[:, 1] > 9.8)  # a hole of 4 mm
    assert 0.6 < wrap.wrap(punched, wrap.AUTO, "ball", *LIMITS).surface.volume / (2 * whole) < 1.4
    assert wrap.wrap(punched, 1.5, "ball", *LIMITS).surface.volume < 0.2 * whole


def test_the_distance_is_that_of_all_points_of_the_wrap():
    """A bowl that is covered: the middle of the lid is 10 mm from the rim and from the bowl."""
    around = wrap.wrap(bowl(), 22.0, "bowl", *LIMITS)
    assert around.most == pytest.approx(10, rel=0.15)
    ball = wrap.wrap(icosphere(4, 10), 1.0, "ball", *LIMITS)
    assert 0.5 / 30 < ball.mean < 2 / 30
    assert ball.most < 0.2


def test_a_wrap_needs_no_repair():
    around = wrap.wrap(soup(), "auto", "soup", *LIMITS)
    repaired, steps = repair.repair(around.surface, "soup")
    assert not steps
    assert repaired.volume == pytest.approx(around.surface.volume, rel=1e-4)


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_a_size_out_of_range_is_refused(size: float):
    with pytest.raises(InputError, match=r"wrap: .* found, allowed are 0\.0\d+ to \d+.* mm for ball, or auto"):
        wrap.wrap(icosphere(2, 10), size, "ball", *LIMITS)


def test_a_wrap_out_of_time_says_so():
    with pytest.raises(QuadGraphError, match="quadgraph-cgal-mesh: stopped"):
        wrap.wrap(torus(10, 4, 96, 48), 0.06, "ring", 1.0, 2 << 30)


def test_the_command_line_wraps(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    mesh = str(write_obj(bowl(), tmp_path / "bowl.obj"))
    output = str(tmp_path / "bowl.qgraph")
    line = ["bake", mesh, "--unit", "mm", "--levels", "1", "-o", output]
    assert cli.main([*line, "--wrap", "2.2cm"]) == 0
    assert "wrapped at 22 mm: " in capsys.readouterr().out
    assert cli.main(["info", output]) == 0
    assert "wrapped at 22 mm, triangles: " in capsys.readouterr().out
    assert cli.main(["solve", output, "--wrap", "auto"]) == 1
    assert "--wrap are for meshes" in " ".join(capsys.readouterr().err.split())
    assert cli.main(["solve", mesh, "--method", "shortest-path", "--wrap", "auto"]) == 1
    assert "takes any mesh as it is" in " ".join(capsys.readouterr().err.split())
    with pytest.raises(SystemExit):
        cli.main([*line, "--wrap", "tight"])
    assert "--wrap" in capsys.readouterr().err
