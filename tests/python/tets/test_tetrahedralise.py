"""Tetrahedra fill the surface, all of it and nothing else, and stay positive in single precision."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest

from quadgraph.base.child_process import Program, check_limits, run, workspace
from quadgraph.base.errors import InputError, ToolError
from quadgraph.mesh import intersections
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.surface import Surface
from quadgraph.mesh.wrap import CGAL_MESH
from quadgraph.tets import tet_rounding
from quadgraph.tets.interior import Limits, of_size
from quadgraph.tets.tet_geometry import determinants
from quadgraph.tets.tet_rounding import orient, round_to_float32
from quadgraph.tets.tetrahedralise import tetrahedralise
from shapes import cube, icosphere, join, moved, torus


@pytest.mark.parametrize("surface", [icosphere(3, 10), cube(2), torus()], ids=["sphere", "cube", "torus"])
def test_tetgen_fills_the_surface_exactly(surface: Surface) -> None:
    mesh = tetrahedralise(surface)
    assert mesh.volume == pytest.approx(surface.volume, rel=1e-12)
    assert mesh.determinants.min() > 0
    assert np.array_equal(mesh.vertices[: len(surface.vertices)], surface.vertices)
    assert np.array_equal(mesh.vertices, mesh.vertices.astype(np.float32))
    boundary = mesh.boundary()
    assert boundary.is_closed_manifold
    assert boundary.volume == pytest.approx(mesh.volume, rel=1e-12)
    assert len(boundary.triangles) == len(surface.triangles)
    assert mesh.mesher.options == "-pYq1.4/0"


def test_volume_converges_to_the_ball() -> None:
    error = [4 / 3 * np.pi - tetrahedralise(icosphere(n)).volume for n in (1, 2, 3)]
    h = [0.5, 0.25, 0.125]
    assert np.polyfit(np.log(h), np.log(error), 1)[0] > 1.9


def test_two_pieces_are_both_filled() -> None:
    pair = join(icosphere(2), moved(cube(1), 5, 0, 0))
    assert tetrahedralise(pair).volume == pytest.approx(pair.volume, rel=1e-12)


def test_bunny(bunny: Surface) -> None:
    mesh = tetrahedralise(bunny)
    assert mesh.volume == pytest.approx(bunny.volume, rel=1e-6)
    assert mesh.determinants.min() > 0


@pytest.mark.parametrize(
    ("surface", "options", "words"),
    [
        (Surface(cube().vertices, cube().triangles[1:]), {}, "not a closed"),
        (Surface(cube().vertices, cube().triangles[:, ::-1]), {}, "outward"),
        (cube(), {"mesher": "gmsh"}, "gmsh"),
        (cube(), {"grading": 2.0}, "grading"),
        (cube(), {"mesher": "cgal", "grading": -1.0}, "grading"),
    ],
    ids=["open", "inside out", "unknown mesher", "tetgen grading", "negative grading"],
)
def test_bad_input_is_refused(surface: Surface, options: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        tetrahedralise(surface, **options)


def test_self_intersecting_surface_is_a_tool_error() -> None:
    crossing = join(icosphere(2), moved(icosphere(2), 0.9, 0.1, 0.05)).rounded()
    with pytest.raises(ToolError, match="tetgen"):
        tetrahedralise(crossing)


def test_crossings_are_found_and_only_there() -> None:
    crossing = join(icosphere(2), moved(icosphere(2), 0.9, 0.1, 0.05))
    found = intersecting_triangles(crossing)
    assert len(found) > 20
    # Both spheres have radius 1: they cross where the distance to both centres is about 1.
    middle = crossing.corners[found].mean(axis=1)
    assert np.abs(np.linalg.norm(middle, axis=1) - np.linalg.norm(middle - (0.9, 0.1, 0.05), axis=1)).max() < 0.5
    assert not len(intersecting_triangles(join(icosphere(2), moved(icosphere(2), 2.5, 0, 0))))


def test_the_test_for_crossings_may_take_longer_on_larger_meshes(monkeypatch) -> None:
    limits = []

    def run_for(*call, time_limit_s, **rest):
        limits.append(time_limit_s)
        return run(*call, time_limit_s=time_limit_s, **rest)

    monkeypatch.setattr(intersections, "run", run_for)
    small, large = icosphere(2), icosphere(4)
    for surface in (small, large):
        intersecting_triangles(surface)
    assert limits[1] - limits[0] >= 1e-3 * (len(large.vertices) - len(small.vertices))


@pytest.fixture(scope="module")
def cgal() -> None:
    """The CGAL mesher's tests need the program, which is an option of the build."""
    try:
        CGAL_MESH.path()
    except ToolError as missing:
        pytest.skip(str(missing))


@pytest.mark.usefixtures("cgal")
def test_cgal_volume_converges_to_the_ball() -> None:
    spheres = [icosphere(n, 10) for n in (1, 2, 3)]
    meshes = [tetrahedralise(sphere, mesher="cgal", grading=1.0) for sphere in spheres]
    for mesh in meshes:
        assert mesh.determinants.min() > 0
        assert mesh.boundary().compacted().is_closed_manifold
        assert mesh.boundary().compacted().components == 1
        assert np.linalg.norm(mesh.vertices, axis=1).max() < 10 * (1 + 1e-6)
    error = [1 - mesh.volume / (4 / 3 * np.pi * 1000) for mesh in meshes]
    assert np.polyfit(np.log([4, 2, 1]), np.log(error), 1)[0] > 1.5


@pytest.mark.usefixtures("cgal")
def test_cgal_grading_grows_tets_inside_and_keeps_the_surface() -> None:
    sphere = icosphere(3, 10)
    meshes = [tetrahedralise(sphere, mesher="cgal", grading=K) for K in (0.2, 0.5, 1.0, 2.0)]
    tets = [len(mesh.tets) for mesh in meshes]
    assert tets == sorted(tets, reverse=True)
    assert tets[0] > 2 * tets[-1]
    size = [np.cbrt(mesh.determinants).mean() for mesh in meshes]
    assert size == sorted(size)
    fine = meshes[0]
    depth = 10 - np.linalg.norm(fine.vertices[fine.tets].mean(axis=1), axis=1)
    edge = np.cbrt(fine.determinants * np.sqrt(2))  # of the regular tet of that volume
    local = np.linalg.norm(np.diff(sphere.vertices[sphere.topology.edges], axis=1), axis=2).mean()
    # The field bounds sizes from above: no tet is much larger than grading * distance + local size.
    assert (edge < 1.3 * (0.2 * depth + local)).all()


@pytest.mark.usefixtures("cgal")
def test_cgal_keeps_a_largest_size() -> None:
    sphere = icosphere(2, 10)
    within = Limits(sphere, of_size(1.5))
    free, bounded = (tetrahedralise(sphere, mesher="cgal", grading=1.0, limits=limits) for limits in (None, within))
    edges = [np.cbrt(mesh.determinants * np.sqrt(2)).max() for mesh in (free, bounded)]
    assert edges[0] > 2.5
    assert edges[1] < 1.5
    assert bounded.mesher.options == "--grading 1 --largest 1.5"


@pytest.mark.usefixtures("cgal")
def test_cgal_is_the_same_every_time() -> None:
    first, second = (tetrahedralise(torus(), mesher="cgal", grading=1.0) for _ in range(2))
    assert np.array_equal(first.vertices, second.vertices)
    assert np.array_equal(first.tets, second.tets)
    assert first.boundary().compacted().genus == 1


@pytest.mark.usefixtures("cgal")
def test_cgal_refuses_crossing_surfaces() -> None:
    crossing = join(icosphere(2), moved(icosphere(2), 0.9, 0.1, 0.05)).rounded()
    with pytest.raises(ToolError, match="intersects itself"):
        tetrahedralise(crossing, mesher="cgal")


def test_rounding_keeps_tets_positive() -> None:
    rng = np.random.default_rng(1)
    surface = moved(icosphere(2), 1000, 1000, 1000).rounded()
    mesh = tetrahedralise(surface)
    # Interior vertices pressed against the surface: closer to flat than float32 resolves at 1000 mm.
    vertices, fixed = mesh.vertices.copy(), len(surface.vertices)
    tets = mesh.tets
    for vertex in range(fixed, len(vertices)):
        star = tets[(tets == vertex).any(axis=1)]
        others = star[0][star[0] != vertex]
        start, goal = vertices[vertex].copy(), vertices[others].mean(axis=0) + rng.normal(size=3) * 1e-9
        for step in (1 - 1e-8, 1 - 1e-6, 1 - 1e-4, 0.5):
            vertices[vertex] = start + step * (goal - start)
            if determinants(vertices, star).min() > 0:
                break
        else:
            vertices[vertex] = start
    assert determinants(vertices, tets).min() > 0
    naive = vertices.astype(np.float32).astype(np.float64)
    assert determinants(naive, tets).min() <= 0
    rounded = round_to_float32(vertices, tets, fixed)
    assert determinants(rounded, tets).min() > 0
    assert np.array_equal(rounded[:fixed], surface.vertices)


def test_rounding_that_cannot_help_is_refused() -> None:
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]])
    with pytest.raises(ToolError, match="no volume"):
        round_to_float32(flat, orient(flat, np.array([[0, 1, 2, 3]])), 4)


def test_rounding_gives_many_flat_tets_up_that_do_not_become_fewer(monkeypatch) -> None:
    """Moving a vertex mends nothing where its whole star lies in a plane, and a round over many takes its time."""
    one = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]])
    count = 200
    vertices = (one + np.array([3.0, 0, 0]) * np.arange(count)[:, None, None]).reshape(-1, 3)
    moved = []
    monkeypatch.setattr(tet_rounding, "_centre", lambda _vertices, _star, vertex: moved.append(int(vertex)))
    with pytest.raises(ToolError, match=f"{count} tetrahedra have no volume"):
        round_to_float32(vertices, np.arange(4 * count).reshape(-1, 4), 0)
    assert 1 <= moved.count(0) <= 5


def test_missing_program_names_its_package(tmp_path: Path) -> None:
    with pytest.raises(ToolError, match="apt install nothing"):
        run(Program("quadgraph-no-such", "apt install nothing"), [], directory=tmp_path, time_limit_s=1,
            memory_limit_bytes=None)  # fmt: skip


def test_time_and_memory_limits_are_kept(tmp_path: Path) -> None:
    python = Program("python3", "Python")
    began = time.monotonic()
    with pytest.raises(ToolError, match="time limit"):
        run(python, ["-c", "import time; print('started', flush=True); time.sleep(60)"], directory=tmp_path,
            time_limit_s=0.5, memory_limit_bytes=None)  # fmt: skip
    assert time.monotonic() - began < 10
    with pytest.raises(ToolError, match="stopped after 1 s, its time limit: at work"):
        run(python, ["-c", "print('at work', flush=True)\nwhile True: pass"], directory=tmp_path,
            time_limit_s=1, memory_limit_bytes=None)  # fmt: skip
    # One that waits for its turn takes no processor time.
    run(python, ["-c", "import time; time.sleep(1.5)"], directory=tmp_path, time_limit_s=1, memory_limit_bytes=None)
    with pytest.raises(ToolError, match="MemoryError"):
        run(python, ["-c", "x = bytearray(1 << 30)"], directory=tmp_path, time_limit_s=20,
            memory_limit_bytes=512 << 20)  # fmt: skip


def test_child_dies_with_its_parent(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from quadgraph.base.child_process import *\n"
        "run(Program('python3', ''), ['-c', 'import os,time; open(\"pid\",\"w\").write(str(os.getpid())); "
        "time.sleep(60)'], directory=Path(sys.argv[1]), time_limit_s=60, memory_limit_bytes=None)"
    )
    parent = subprocess.Popen([sys.executable, "-c", code, str(tmp_path)])
    pid_file = tmp_path / "pid"
    deadline = time.monotonic() + 20
    while not (pid_file.exists() and pid_file.read_text()):
        assert time.monotonic() < deadline, "the child did not start"
        time.sleep(0.05)
    child = int(pid_file.read_text())
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    while _alive(child):
        assert time.monotonic() < deadline, f"process {child} outlived its parent"
        time.sleep(0.05)


def test_an_interrupt_while_a_child_starts_is_not_lost(tmp_path: Path) -> None:
    # Python runs this hook while it forks; an exception in a hook, also that of an interrupt, is printed and lost.
    code = (
        "import os, signal, sys; from pathlib import Path; from quadgraph.base.child_process import *\n"
        "def hook():\n    os.kill(os.getpid(), signal.SIGINT)\n    return len('an interrupt is raised by now')\n"
        "os.register_at_fork(after_in_parent=hook)\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "try:\n"
        "    run(Program('sleep', ''), ['60'], directory=Path(sys.argv[1]), time_limit_s=60, memory_limit_bytes=None)\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted')\n"
    )
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, timeout=30)
    assert (done.stdout, done.stderr) == ("interrupted\n", "")


def test_an_interrupt_while_a_workspace_is_removed_leaves_nothing(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    remove = os.rmdir

    def interrupted(*arguments, **options) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        assert len("an interrupt is raised by now")
        remove(*arguments, **options)

    monkeypatch.setattr(os, "rmdir", interrupted)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt), workspace() as folder:
            (folder / "surface.smesh").write_text("of a mesher")
    finally:
        signal.signal(signal.SIGINT, before)
    assert not any(tmp_path.iterdir())


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{pid}/stat")
    return state.exists() and state.read_text().rsplit(")", 1)[1].split()[0] != "Z"


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ({"time_limit_s": 1e300}, r"time_limit: 1e\+300 s found, allowed are more than 0 and at most 1e\+06"),
        ({"time_limit_s": float("nan")}, "time_limit: nan s found"),
        ({"memory_limit_bytes": 10**30}, r"memory_limit: 1e\+21 GB found, allowed are more than 0 and at most 1e\+06"),
        ({"memory_limit_bytes": 0}, "memory_limit: 0 GB found"),
    ],
)
def test_limits_that_the_system_cannot_hold_are_refused(limits, message):
    with pytest.raises(InputError, match=message):
        check_limits(**({"time_limit_s": 1.0, "memory_limit_bytes": 1} | limits))
