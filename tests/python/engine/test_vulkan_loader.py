"""Programs that do not need Vulkan start without it: its loader is opened, not linked."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys

import pytest
from test_window import MISSING, display

import tiny
from engine_program import ENGINE, assert_refused

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytestmark = pytest.mark.skipif(ENGINE is None, reason="quadgraph-engine is not built: run tools/setup")

LOADER = "libvulkan.so.1"
PYTHON = (sys.executable, "-m", "quadgraph.cli")
CHOICE = ("QUADGRAPH_DEVICE", "DISPLAY", "WAYLAND_DISPLAY")


def run(environment: dict[str, str], *command: object) -> subprocess.CompletedProcess:
    return subprocess.run(
        list(map(str, command)), env=environment, capture_output=True, text=True, timeout=60, check=False
    )


@pytest.fixture
def undecided() -> dict[str, str]:
    """The environment, with neither a usual device nor a display."""
    return {name: value for name, value in os.environ.items() if name not in CHOICE}


@pytest.fixture
def no_loader(undecided, tmp_path) -> dict[str, str]:
    """An environment in which the dynamic linker finds an empty file in place of Vulkan's loader, and gives up."""
    (tmp_path / LOADER).touch()
    environment = undecided | {"LD_LIBRARY_PATH": str(tmp_path)}
    opened = run(environment, sys.executable, "-c", f"import ctypes; ctypes.CDLL('{LOADER}')")
    if opened.returncode == 0:
        pytest.skip(f"an empty {LOADER} does not hide the loader from this system's dynamic linker")
    return environment


@pytest.fixture
def no_driver(undecided, tmp_path) -> dict[str, str]:
    """An environment in which Vulkan's loader finds no driver."""
    absent = str(tmp_path / "absent.json")
    return undecided | {"VK_DRIVER_FILES": absent, "VK_ICD_FILENAMES": absent}


@pytest.mark.parametrize("program", [ENGINE, _core.__file__], ids=["quadgraph-engine", "_core"])
def test_nothing_links_the_loader(program):
    if shutil.which("ldd") is None:
        pytest.skip("there is no ldd")
    linked = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
    assert "libpng" in linked
    assert "libvulkan" not in linked


@pytest.mark.parametrize("absent", ["no_loader", "no_driver"])
def test_without_a_gpu_the_processor_computes(absent, request, tmp_path):
    environment = request.getfixturevalue(absent)
    report, picture = tmp_path / "report.json", tmp_path / "cube.png"
    solved = run(environment, *PYTHON, "solve", tiny.PATH, "--json", report)
    assert solved.returncode == 0, solved.stderr
    assert json.loads(report.read_text())["driver"].startswith("quadgraph cpu")
    drawn = run(environment, ENGINE, tiny.PATH, "--headless", "-o", picture, "--size", "64x64")
    assert drawn.returncode == 0, drawn.stderr
    assert picture.is_file()


def test_without_a_loader_a_gpu_is_refused_and_the_loader_named(no_loader, tmp_path):
    picture = tmp_path / "cube.png"
    for command in ((ENGINE, tiny.PATH, "--headless"), (*PYTHON, "render", tiny.PATH)):
        done = run(no_loader, *command, "-o", picture, "--size", "64x64", "--device", "llvmpipe")
        assert_refused(done, "no Vulkan loader", LOADER, "libvulkan1", "cpu is the only device")
    assert not picture.exists()


@pytest.mark.skipif("Xvfb" in MISSING, reason="not installed: Xvfb (tools/packages.txt)")
@pytest.mark.parametrize(("absent", "said"), [("no_loader", "libvulkan1"), ("no_driver", "mesa-vulkan-drivers")])
def test_without_vulkan_the_window_says_what_is_missing(absent, said, request, tmp_path):
    environment = request.getfixturevalue(absent)
    with display(tmp_path) as server:
        done = run(environment | {"DISPLAY": server.name}, ENGINE, tiny.PATH, "--device", "cpu")
    assert_refused(done, "Vulkan", said, "--headless")
