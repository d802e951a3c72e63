"""From a mesh file to a .qgraph file: what is in it, that it is the same every time, and what happens when it fails."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from quadgraph.baking import pipeline, workers
from quadgraph.base.errors import InputError, ToolError
from quadgraph.file import qgraph_file
from quadgraph.mesh import display_map
from quadgraph.mesh.surface import Surface
from shapes import icosphere, write_obj

SUBDIVISIONS = 4  # 2562 vertices


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("bake")


@pytest.fixture(scope="module")
def sphere(folder) -> Path:
    return write_obj(icosphere(SUBDIVISIONS, 1), folder / "sphere.obj")


@pytest.fixture(scope="module")
def baked(sphere, folder) -> tuple[pipeline.BakeReport, qgraph_file.QGraphFile]:
    report = pipeline.bake(sphere, folder / "sphere.qgraph", pipeline.BakeOptions(unit="cm", levels=3))
    return report, qgraph_file.read(folder / "sphere.qgraph")


def test_metadata_tells_where_it_comes_from(baked, sphere):
    metadata = baked[1].metadata
    source = {"name": "sphere.obj", "sha256": hashlib.sha256(sphere.read_bytes()).hexdigest()}
    assert metadata["source"] == source | {"vertices": 2562, "triangles": 5120}
    assert metadata["unit_mm"] == 10
    assert metadata["mesher"]["name"] == "tetgen"
    assert metadata["mesher"]["grading"] is None
    assert metadata["repairs"] == []
    assert metadata["options"]["levels"] == 3
    assert metadata["options"]["order"] == "blocks"
    assert metadata["tools"]["numpy"] == np.__version__


def test_metadata_tells_what_the_interior_is_for(baked, folder):
    interior = baked[1].metadata["interior"]
    assert (interior["rule"], interior["materials"]) == ("auto", [])
    assert interior["edge_mm"][0] > 4 / 3  # a tenth of the mean chord, or more where that would be too many tets
    np.testing.assert_allclose(np.divide(interior["edge_mm"], interior["edge_mm"][0]), [1, 2, 4])
    assert baked[0].interior == interior
    coarse = write_obj(icosphere(3, 1), folder / "inside.obj")
    for wanted, rule, edges in (("surface", "surface", [None, None]), (1.2, "size", [1.2, 2.4])):
        options = pipeline.BakeOptions(unit="cm", levels=2, interior=wanted)
        pipeline.bake(coarse, folder / "inside.qgraph", options)
        told = qgraph_file.read(folder / "inside.qgraph").metadata["interior"]
        assert (told["rule"], told["edge_mm"]) == (rule, edges)
    material = "sigma_s_prime=2,sigma_a=0.01"
    options = pipeline.BakeOptions(unit="cm", levels=1, for_materials=(material,))
    pipeline.bake(coarse, folder / "inside.qgraph", options)
    told = qgraph_file.read(folder / "inside.qgraph").metadata
    assert (told["interior"]["rule"], told["interior"]["materials"]) == ("materials", [material])
    assert told["options"]["for_materials"] == [material]


def test_levels_fill_the_ball_and_shrink_by_four(baked):
    levels = baked[1].metadata["levels"]
    assert len(levels) == 3
    exact = 4 / 3 * np.pi * 10**3
    for fine, coarse in itertools.pairwise(levels):
        assert coarse["surface_vertices"] == pytest.approx(fine["surface_vertices"] / 4, rel=0.1)
    for level in levels:
        assert level["volume_mm3"] == pytest.approx(exact, rel=6 / level["surface_vertices"] + 1e-3)


def test_level_metadata_agrees_with_the_sections(baked):
    for number, level in enumerate(baked[1].metadata["levels"]):
        part = {name: baked[1].sections[f"level{number}/{name}"] for name in ("vertices", "tets", "faces")}
        assert {name: len(array) for name, array in part.items()}.items() <= level.items()
        surface = Surface(part["vertices"].astype(np.float64), part["faces"].astype(np.int64))
        assert level["volume_mm3"] == pytest.approx(surface.volume, rel=1e-6)
        assert level["area_mm2"] == pytest.approx(surface.area, rel=1e-6)


def test_the_display_mesh_is_the_input(baked):
    sections = baked[1].sections
    expected = 10 * icosphere(SUBDIVISIONS, 1).vertices
    np.testing.assert_allclose(sections["display/vertices"], expected, atol=1e-5)
    faces = sections["level0/faces"][sections["display/face"]]
    corner = sections["display/barycentric"].argmax(axis=1)
    mapped = sections["level0/vertices"][faces[np.arange(len(faces)), corner]]
    assert np.array_equal(mapped, sections["display/vertices"])
    assert (sections["display/barycentric"].max(axis=1) == 1).all()


def test_the_report_tells_time_memory_and_order(baked):
    report = baked[0].as_dict()
    assert report["byte_size"] == Path(report["output"]).stat().st_size
    assert {"read", "repair", "simplify", "tetrahedra and graphs", "transfers", "write"} <= set(report["seconds"])
    assert min(report["seconds"].values()) >= 0
    assert report["peak_memory"]["self"] > 10e6
    finest = report["levels"][0]
    assert finest["link_length_variation"]["after"]["local"] < finest["link_length_variation"]["before"]["local"]
    assert set(finest["seconds"]) == {"tetrahedra", "graph", "relax", "order"}


def test_the_same_input_gives_the_same_bytes(baked, sphere, folder):
    pipeline.bake(sphere, folder / "again.qgraph", pipeline.BakeOptions(unit="cm", levels=3))
    assert (folder / "again.qgraph").read_bytes() == (folder / "sphere.qgraph").read_bytes()


def test_random_order_is_the_same_object_in_worse_order(baked, sphere, folder):
    options = pipeline.BakeOptions(unit="cm", levels=3, order="random")
    report = pipeline.bake(sphere, folder / "random.qgraph", options)
    lines = [entry.levels[0]["locality"]["lines_per_block"] for entry in (baked[0], report)]
    assert lines[0] < 0.3 * lines[1]
    ours, theirs = (f.sections["level0/nodes"] for f in (baked[1], qgraph_file.read(folder / "random.qgraph")))
    assert np.array_equal(ours[np.lexsort(ours.T)], theirs[np.lexsort(theirs.T)])


def test_a_smaller_simulation_surface_keeps_the_display_mesh(sphere, folder):
    options = pipeline.BakeOptions(unit="cm", levels=1, surface_vertices=600)
    pipeline.bake(sphere, folder / "small.qgraph", options)
    file = qgraph_file.read(folder / "small.qgraph")
    assert file.metadata["levels"][0]["surface_vertices"] == pytest.approx(600, rel=0.1)
    assert len(file.sections["display/vertices"]) == 2562
    faces = file.sections["level0/faces"][file.sections["display/face"]]
    corners = file.sections["level0/vertices"][faces].astype(np.float64)
    mapped = np.einsum("ij,ijk->ik", file.sections["display/barycentric"], corners)
    # The coarse surface lies within the height of its largest triangle's cap.
    distance = np.linalg.norm(mapped - file.sections["display/vertices"], axis=1)
    assert distance.max() < 0.3


def test_a_refined_simulation_surface_keeps_the_display_mesh(folder):
    coarse = write_obj(icosphere(2, 1), folder / "coarse.obj")
    pipeline.bake(coarse, folder / "refined.qgraph", pipeline.BakeOptions(unit="cm", levels=2, refine=2))
    file = qgraph_file.read(folder / "refined.qgraph")
    assert file.metadata["levels"][0]["surface_vertices"] == 2562
    assert file.metadata["options"]["refine"] == 2
    assert file.metadata["levels"][0]["volume_mm3"] == pytest.approx(4 / 3 * np.pi * 1000, rel=0.003)
    assert len(file.sections["display/vertices"]) == 162
    assert (file.sections["display/barycentric"].max(axis=1) == 1).all()
    both = pipeline.BakeOptions(unit="cm", levels=1, refine=1, surface_vertices=400)
    pipeline.bake(coarse, folder / "between.qgraph", both)
    between = qgraph_file.read(folder / "between.qgraph").metadata["levels"][0]
    assert between["surface_vertices"] == pytest.approx(400, rel=0.1)


def _failing_below(monkeypatch, vertices: int) -> None:
    real = pipeline.tetrahedralise

    def fail(surface: Surface, **options):
        if len(surface.vertices) < vertices:
            raise ToolError("tetgen: made no tetrahedra")
        return real(surface, **options)

    monkeypatch.setattr(pipeline, "tetrahedralise", fail)


def test_the_chain_ends_where_a_coarse_level_fails(sphere, tmp_path, monkeypatch):
    _failing_below(monkeypatch, 300)
    report = pipeline.bake(sphere, tmp_path / "short.qgraph", pipeline.BakeOptions(unit="cm", levels=3))
    assert len(report.levels) == 2
    assert any("level 2 was left out" in note and "made no tetrahedra" in note for note in report.notes)
    assert qgraph_file.read(tmp_path / "short.qgraph").level_count == 2


def test_without_a_finest_level_there_is_no_file(sphere, tmp_path, monkeypatch):
    _failing_below(monkeypatch, 10**6)
    with pytest.raises(ToolError, match=f"{sphere}: tetgen: made no tetrahedra"):
        pipeline.bake(sphere, tmp_path / "none.qgraph", pipeline.BakeOptions(unit="cm"))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"unit": "mm", "height_mm": 5.0}, "both unit and height"),
        ({"unit": "inch"}, "inch"),
        ({"unit": "mm", "levels": 17}, "levels: 17"),
        ({"unit": "mm", "order": "alphabetical"}, "order: 'alphabetical'"),
        ({"unit": "mm", "relax_nodes": -1}, "relax_nodes: -1"),
        ({"unit": "mm", "mesher": "gmsh"}, "gmsh"),
        ({"unit": "mm", "grading": 2.0}, "grading"),
        ({"unit": "mm", "surface_vertices": 10**6}, "surface_vertices: 1000000 found.*--refine"),
        ({"unit": "mm", "refine": 6}, "refine: 6"),
        ({"unit": "mm", "interior": "fine"}, "interior: 'fine'"),
        ({"unit": "mm", "interior": -1.0}, "interior: -1"),
        ({"unit": "mm", "interior": 1.0, "mesher": "polygrid"}, "interior: found with mesher 'polygrid'"),
        ({"unit": "mm", "refine": 1, "mesher": "polygrid"}, "refine: found with mesher 'polygrid'"),
        ({"unit": "mm", "for_materials": ("sigma_s_prime=2,sigma_a=-1",)}, "sigma_a.*-1"),
    ],
)
def test_bad_options_are_named(sphere, tmp_path, options, message):
    with pytest.raises(InputError, match=message):
        pipeline.bake(sphere, tmp_path / "bad.qgraph", pipeline.BakeOptions(**options))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("output", ["absent/a.qgraph", "."])
def test_unusable_outputs_are_refused_before_the_work(tmp_path, output):
    with pytest.raises(InputError, match=r"does not exist|is a folder"):
        pipeline.bake(tmp_path / "not read.obj", tmp_path / output, pipeline.BakeOptions(unit="mm"))


@pytest.fixture
def slow_tetgen(tmp_path, monkeypatch) -> Path:
    """Put a tetgen that never ends filling first in PATH; returns the file where it leaves its process id."""
    real = shutil.which("tetgen")
    assert real, "tetgen is not installed"
    program, note = tmp_path / "bin" / "tetgen", tmp_path / "pid"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\ncase "$1" in -p*) echo $$ > {note}; exec sleep 300;; esac\nexec {real} "$@"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:{os.environ['PATH']}")
    return note


def _wait_for(condition: Callable[[], bool], seconds: float = 30) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def _start_bake(sphere: Path, output: Path, note: Path) -> tuple[subprocess.Popen, int]:
    """Start the command line and return it with the process id of its tetgen once that works."""
    command = [sys.executable, "-m", "quadgraph.cli", "bake", str(sphere), "--unit", "mm", "-o", str(output)]
    # A shell that starts the tests in the background has them, and so their children, ignore the interrupt.
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    _wait_for(lambda: process.poll() is not None or (note.exists() and note.read_text().strip() != ""))
    assert process.poll() is None, process.communicate()[1]
    return process, int(note.read_text())


def _gone(pid: int) -> bool:
    status = Path(f"/proc/{pid}/stat")
    try:
        return status.read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except FileNotFoundError:
        return True


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_killed_bake_leaves_no_file_and_no_program(sphere, tmp_path, slow_tetgen, how):
    output = tmp_path / "out" / "killed.qgraph"
    output.parent.mkdir()
    process, tetgen = _start_bake(sphere, output, slow_tetgen)
    process.send_signal(how)
    errors = process.communicate(timeout=20)[1]
    assert process.returncode == (-how if how == signal.SIGKILL else 128 + how)
    assert "Traceback" not in errors
    assert not list(output.parent.iterdir())
    _wait_for(lambda: _gone(tetgen))


def test_a_bake_killed_while_writing_leaves_no_output_file(sphere, tmp_path):
    output = tmp_path / "killed.qgraph"
    script = (
        "import os, signal, sys; from quadgraph import cli\n"
        "os.fsync = lambda handle: os.kill(os.getpid(), signal.SIGKILL)\n"
        f"cli.main(['bake', {str(sphere)!r}, '--unit', 'mm', '--levels', '1', '-o', {str(output)!r}])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True)
    assert done.returncode == -signal.SIGKILL
    assert not output.exists()


@pytest.mark.long
def test_bunny_within_its_budget_of_memory(bunny_path, tmp_path):
    # In a process whose parent is small: Linux counts a process's peak from that of the one it was started by.
    command = [sys.executable, "-m", "quadgraph.cli", "bake", bunny_path, "-o", tmp_path / "bunny.qgraph"]
    started = ["sh", "-c", '"$@"; exit $?', "sh", *command, "--height", "100mm", "--json"]
    done = subprocess.run([str(part) for part in started], capture_output=True, text=True, check=True, timeout=300)
    report = json.loads(done.stdout)
    print(f"bunny baked in {report['seconds']['total']:.1f} s")
    assert report["peak_memory"]["self"] + workers.WORKERS * report["peak_memory"]["largest_child"] < 2e9
    assert report["byte_size"] < 64e6
    finest = qgraph_file.read(tmp_path / "bunny.qgraph").metadata["levels"][0]
    assert finest["tets"] > 150_000
    assert len(report["levels"]) >= 4


def test_display_vertices_of_the_bunny_match_exactly(bunny):
    face, coordinates = display_map.nearest_faces(bunny.vertices, bunny)
    assert np.array_equal(np.einsum("ij,ijk->ik", coordinates, bunny.corners[face]), bunny.vertices)
