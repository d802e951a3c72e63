"""Shapes for the tests: the shared meshes where they are, pymeshlab's bunny, and generated ones."""

from __future__ import annotations

import os

# Workers share the cores: threads of OpenBLAS that wait for each other while others compute make the small matrices of
# these tests take a hundred times as long, and its version 0.3.30 can hang (OpenBLAS issue 5520).
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# So do those of the engine on the processor: the first worker has all of them, the others one each. What is found has
# the same bits with any number (tests/cpp/cpu/threads_test.cpp).
if os.environ.get("PYTEST_XDIST_WORKER", "gw0") != "gw0":
    os.environ.setdefault("QUADGRAPH_THREADS", "1")

# Nor does a test depend on who runs it: no file of defaults is there.
os.environ["XDG_CONFIG_HOME"] = os.devnull

import fcntl
import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from cpu_seconds import pytest_runtest_makereport as pytest_runtest_makereport
from cpu_seconds import pytest_runtest_protocol as pytest_runtest_protocol
from cpu_seconds import pytest_terminal_summary as pytest_terminal_summary
from leaks import nothing_left_on_devices as nothing_left_on_devices
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.mesh.surface import Surface
from shapes import pymeshlab_samples, read_ply

ROOT = Path(__file__).resolve().parents[2]

# Files that take longest, in about this order: begun first, so that no worker is left with one of them at the end, and
# those that wait for windows beside others.
LONGEST = (
    "test_lamp_finding.py",
    "test_interior.py",
    "test_window_preview.py",
    "test_session_import.py",
    "test_window.py",
    "test_embedded_engine.py",
    "test_window_look.py",
    "test_volume_recovery.py",
    "test_page_hands.py",
    "test_commands_run.py",
    "test_projector.py",
    "test_background_masks.py",
    "test_wrap.py",
    "test_window_hearing.py",
    "test_doctor.py",
    "test_mesh_walk.py",
    "test_body_indices.py",
    "test_mesh_colours.py",
    "test_photograph.py",
    "test_bake.py",
    "test_serve.py",
    "test_accuracy_unseen.py",
    "test_window_panel.py",
    "test_correction.py",
    "test_commands.py",
    "test_bench_command.py",
    "test_placements.py",
    "test_scene_file.py",
    "test_budget.py",
    "test_embedded_bake.py",
    "test_engine.py",
    "test_pose_search.py",
    "test_tetrahedralise.py",
    "test_painted_pictures.py",
    "test_window_samples.py",
    "test_bodies_by_walks.py",
    "test_lod.py",
    "test_converging.py",
    "test_embedded_by_walks.py",
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    rank = {name: number for number, name in enumerate(LONGEST)}
    items.sort(key=lambda item: rank.get(item.path.name, len(LONGEST)))


@pytest.fixture
def short(request: pytest.FixtureRequest) -> bool:
    """Whether long studies are left out of this run, in which others need not be as exact as documents state them."""
    return "not long" in request.config.option.markexpr


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder `shared` beside the repository, or the one that QUADGRAPH_SHARED names."""
    folder = Path(os.environ.get("QUADGRAPH_SHARED", ROOT.parent / "shared"))
    if not (folder / "meshes").is_dir():
        pytest.skip(f"no shared meshes: {folder / 'meshes'} is not a folder (set QUADGRAPH_SHARED)")
    return folder


@pytest.fixture(scope="session")
def bunny_path() -> Path:
    """pymeshlab's bundled bunny: 28k vertices, watertight, 2-manifold."""
    return pymeshlab_samples() / "bunny.obj"


@pytest.fixture(scope="session")
def bunny(bunny_path: Path) -> Surface:
    """The bundled bunny, 100 mm high."""
    surface = read_ply(bunny_path)
    scale = 100 / (surface.vertices[:, 1].max() - surface.vertices[:, 1].min())
    return Surface(surface.vertices * scale, surface.triangles).rounded()


@pytest.fixture(scope="session")
def all_workers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that all workers of a run have together."""
    alone = "PYTEST_XDIST_WORKER" not in os.environ
    return tmp_path_factory.getbasetemp() if alone else tmp_path_factory.getbasetemp().parent


@pytest.fixture(scope="session")
def small_bunny(bunny_path: Path, all_workers: Path) -> Path:
    """The bundled bunny baked at 60 mm with 3000 vertices on its finest surface, once for all workers."""
    return baked_once(bunny_path, all_workers / "small.qgraph", BakeOptions(height_mm=60.0, surface_vertices=3000))


@pytest.fixture(scope="session")
def small_body(shared: Path, all_workers: Path) -> Callable[[str], Path]:
    """Of a name of the shared meshes: baked at 60 mm with 3000 vertices on the finest surface, once for all workers."""

    def of(name: str) -> Path:
        options = BakeOptions(height_mm=60.0, surface_vertices=3000)
        return baked_once(shared / "meshes" / f"{name}.ply", all_workers / f"small-{name}.qgraph", options)

    return of


def baked_once(mesh: Path, path: Path, options: BakeOptions) -> Path:
    """Bake to `path` unless another worker has, with the report beside it as JSON."""
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            report = bake(mesh, path, options)
            path.with_suffix(".json").write_text(json.dumps(report.as_dict()))
    return path


@pytest.fixture(scope="module")
def browser():
    """Chromium without a window, driven by selenium; skips, saying why, where they are not there."""
    pytest.importorskip("selenium", reason="selenium is not installed: run tools/setup")
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not (chromium and driver):
        pytest.skip("no chromium and chromium-driver: apt-get install --no-install-recommends them as root")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    with webdriver.Chrome(options=options, service=Service(driver)) as found:
        yield found
