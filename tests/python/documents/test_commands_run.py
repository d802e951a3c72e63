"""The commands of the documents run, page by page, in a fresh folder with what a reader has, and write what they say.

In every run those that take seconds, on a small ball in place of the bunny, with a file of defaults that makes pictures
small; in the long run all but those that exceptions.toml names, on the bunny that tools/demo bakes.
"""

from __future__ import annotations

import faulthandler
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh
from shell_pages import PAGES, ROOT, Command, blocks, environment, script, written

from engine_program import ENGINE
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.mesh.surface import Surface
from shapes import icosphere, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("quadgraph_validation", reason="quadgraph-validation is not installed: run tools/setup")
pytestmark = pytest.mark.skipif(ENGINE is None, reason="quadgraph-engine is not built: run tools/setup")

SHORT = [page for page in PAGES if script(page, long=False)]
LONG = [page for page in PAGES if script(page, long=True)]
PYTHON = ("README.md", "docs/scene.md")  # their blocks of Python are whole programs
SCENES = {"docs/deformation.md": "twist.json", "docs/scene.md": "scene.json"}  # files that a page shows as JSON


def furnish(folder: Path, page: str, mesh: Path, body: Path) -> None:
    """Give a page what its reader has: the repository's documents, the demo's body, and meshes of their own."""
    shutil.copytree(ROOT / "docs", folder / "docs")
    (folder / "out" / "tour").mkdir(parents=True)
    shutil.copy(body, folder / "out" / "bunny.qgraph")
    shutil.copy(ROOT / "docs/benchmarks/chart.json", folder / "chart.json")
    for name in ("mesh.obj", "bunny.obj"):
        shutil.copy(mesh, folder / name)
    for name in ("part.stl", "spot.ply", "teapot.ply"):
        trimesh.creation.icosphere(subdivisions=4, radius=20).export(folder / name)
    if page in SCENES:
        (folder / SCENES[page]).write_text(blocks(page, "json")[0])
    if page != "docs/deformation.md":  # which bakes its own
        shutil.copy(body, folder / "bunny.qgraph")
    rest = trimesh.load(mesh, process=False, force="mesh")
    (folder / "walk").mkdir()
    for step in range(3):
        stretched = np.array(rest.vertices) * [1, 1 + 0.02 * step, 1]
        write_obj(Surface(stretched, np.array(rest.faces)), folder / "walk" / f"{step}.obj")


def small_pictures(folder: Path) -> None:
    """Give the commands in a folder a file of defaults by which pictures are small where no size is typed."""
    (folder / "config" / "quadgraph").mkdir(parents=True)
    (folder / "config" / "quadgraph" / "config.toml").write_text('[render]\nsize = "160x90"\n')


def run(folder: Path, commands: tuple[Command, ...]) -> None:
    """Run commands in a folder, one after the other in one shell; each has to succeed and to write what it says."""
    lines = ["set -euo pipefail"]
    for number, command in enumerate(commands):
        lines += [f"echo {number} > at-command", command.text]
    begun = time.time() - 1
    with (folder / "said").open("w") as said:
        done = subprocess.run(
            ["bash", "-c", "\n".join(lines)],
            cwd=folder,
            env=environment(folder) | {"XDG_CONFIG_HOME": str(folder / "config")},
            stdout=said,
            stderr=subprocess.STDOUT,
            timeout=7200,
        )
    if done.returncode != 0:
        at = commands[int((folder / "at-command").read_text())]
        pytest.fail(f"{at.page}: {at.text}\nexit status {done.returncode}\n{(folder / 'said').read_text()[-3000:]}")
    for name in written(commands):
        found = [file for match in folder.glob(name) for file in ([match] if match.is_file() else match.iterdir())]
        new = [file for file in found if file.stat().st_mtime >= begun and file.stat().st_size > 0]
        assert new, f"{commands[0].page}: {name} was not written"


def run_python(folder: Path, page: str) -> None:
    """Run a page's programs in Python."""
    for text in blocks(page, "python") if page in PYTHON else []:
        subprocess.run([sys.executable, "-c", text], cwd=folder, env=environment(folder), check=True, timeout=600)


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> tuple[Path, Path]:
    """A ball as OBJ, and baked."""
    folder = tmp_path_factory.mktemp("ball")
    finer = write_obj(icosphere(4, 40), folder / "finer.obj")
    bake(finer, folder / "ball.qgraph", BakeOptions(height_mm=80, surface_vertices=800))
    return write_obj(icosphere(3, 40), folder / "ball.obj"), folder / "ball.qgraph"


@pytest.fixture(scope="module")
def demo(bunny_path, tmp_path_factory) -> tuple[Path, Path]:
    """The bunny that pymeshlab bundles, and baked as tools/demo does."""
    body = tmp_path_factory.mktemp("demo") / "bunny.qgraph"
    bake(bunny_path, body, BakeOptions(height_mm=80))
    return bunny_path, body


@pytest.mark.parametrize("page", SHORT)
def test_the_short_commands_of_a_page_run(page, tmp_path, ball):
    furnish(tmp_path, page, *ball)
    small_pictures(tmp_path)
    run(tmp_path, script(page, long=False))
    if page == "README.md":
        run_python(tmp_path, page)
        assert (tmp_path / "milk.png").stat().st_size > 0


@pytest.mark.long
@pytest.mark.parametrize("page", LONG)
def test_all_commands_of_a_page_run(page, tmp_path, demo):
    if "montage" in " ".join(command.text for command in script(page, long=True)) and not shutil.which("montage"):
        pytest.skip("ImageMagick is not installed (tools/packages.txt)")
    faulthandler.cancel_dump_traceback_later()  # a page may take longer than what pytest takes for a hang
    furnish(tmp_path, page, *demo)
    run(tmp_path, script(page, long=True))
    run_python(tmp_path, page)


def test_a_command_that_fails_is_named(tmp_path):
    with pytest.raises(pytest.fail.Exception, match=r"exit status 1\n(.|\n)*gone\.qgraph"):
        run(tmp_path, (Command("a page", "true"), Command("a page", "quadgraph info gone.qgraph")))


def test_a_file_that_is_not_written_is_named(tmp_path):
    with pytest.raises(AssertionError, match=r"picture\.png was not written"):
        run(tmp_path, (Command("a page", "quadgraph --version -o picture.png"),))
