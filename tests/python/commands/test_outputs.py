"""Outputs: never a file that is read, never what is no regular file, and nothing left when a bake is ended."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError
from quadgraph.base.outputs import check_outputs
from quadgraph.cli import main
from shapes import cube, icosphere, write_obj


def test_an_output_that_is_read_is_refused_whatever_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a").mkdir()
    file = tmp_path / "in.ply"
    file.write_text("precious")
    os.link(file, tmp_path / "hard.ply")
    light = "projector:0,0,9:0,0,-1:20:in.ply:1"
    for name in ("in.ply", "a/../in.ply", str(file), "hard.ply"):
        for read in (file, "in.ply", light):
            with pytest.raises(InputError, match="is read"):
                check_outputs([Path(name)], [read])
    with pytest.raises(InputError, match="two outputs"):
        check_outputs([Path("out.png"), Path("a/../out.png")], [])
    check_outputs([Path("out.png"), None, Path("out.json")], [file, "marble", light, None])


@pytest.mark.parametrize("kind", ["fifo", "link", "folder"])
def test_what_is_no_regular_file_is_not_replaced(tmp_path, kind):
    path, target = tmp_path / "out.json", tmp_path / "target"
    target.write_text("precious")
    {"fifo": os.mkfifo, "link": lambda p: p.symlink_to(target), "folder": os.mkdir}[kind](path)
    with pytest.raises(InputError, match="allowed is a regular file or a new name"):
        atomic_file.write_json(path, {})
    assert target.read_text() == "precious"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.json", "target"]


def test_a_bake_onto_its_mesh_leaves_it(tmp_path, capsys):
    mesh = write_obj(cube(2.0), tmp_path / "in.obj")
    before = mesh.read_bytes()
    for more in ([], ["--surface-only"]):
        assert main(["bake", str(mesh), "--unit", "mm", "-o", str(mesh), *more]) == 1
        assert "is read" in capsys.readouterr().err
        assert mesh.read_bytes() == before


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_bake_that_is_ended_leaves_nothing(tmp_path, number):
    mesh = write_obj(icosphere(5, 20.0), tmp_path / "in.obj")
    folder = tmp_path / "temporary"
    folder.mkdir()
    command = [sys.executable, "-m", "quadgraph.cli", "bake", mesh, "--unit", "mm", "-o", tmp_path / "out.qgraph"]
    # Whoever starts the tests in the background, or with nohup, has them and their children ignore INT or HUP.
    process = subprocess.Popen(
        command,
        env=os.environ | {"TMPDIR": str(folder)},
        stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),
    )
    while not any(folder.iterdir()):
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(number)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 128 + number, said
    assert not any(folder.iterdir())
    assert not (tmp_path / "out.qgraph").exists()


IMPORTING = """
import sys, time
from quadgraph.base import program
program.heed_signals()
try:
    import forgetful
    time.sleep(60)
except KeyboardInterrupt as error:
    print(type(error).__name__, "forgetful" in sys.modules)
"""
FORGETFUL = """
import os, signal
try:
    os.kill(os.getpid(), signal.{name})
    for _ in range(1000):
        pass
except BaseException:
    pass
"""


def run_script(script: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run Python on a text that may import what is in a folder, with signals as a shell leaves them."""
    return subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | {"PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=50,
        preexec_fn=lambda: [signal.signal(n, signal.SIG_DFL) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)],
    )


@pytest.mark.parametrize(
    ("name", "kind"), [("SIGTERM", "Stopped"), ("SIGHUP", "Stopped"), ("SIGINT", "KeyboardInterrupt")]
)
def test_a_signal_during_an_import_is_heeded_after_it(tmp_path, name, kind):
    """Modules that import others in a try of their own would forget it, and the program go on to its end."""
    (tmp_path / "forgetful.py").write_text(FORGETFUL.format(name=name))
    done = run_script(IMPORTING, tmp_path)
    assert done.stdout == f"{kind} True\n", done.stderr


AMID = """
import os, signal, sys
from quadgraph import cli

class Sends:
    def find_spec(self, name, *_):
        if name == "scipy.sparse._base":
            os.kill(os.getpid(), signal.SIGTERM)

sys.meta_path.insert(0, Sends())
print(cli.main(["shapes", "body.qgraph", "frame.ply", "-o", "out.qshapes"]))
print([name in sys.modules for name in ("scipy.sparse", "trimesh", "quadgraph.file.shapes_file")])
"""


def test_a_signal_waits_for_one_module_of_others_and_not_for_all(tmp_path):
    """What a command imports takes half a second, and seconds on a machine at work: it ends between two of them."""
    done = run_script(AMID, tmp_path)
    assert done.stdout == f"{128 + signal.SIGTERM}\n[True, False, False]\n", done.stderr


WAITING = """
import os, signal, time
from quadgraph.base import program
program.heed_signals()
try:
    import forgetful
    os.kill(os.getpid(), signal.SIGHUP)
    time.sleep(60)
except program.Stopped:
    signal.signal(signal.SIGALRM, signal.SIG_DFL)  # as when Python ends
time.sleep(0.2)
print("ended")
"""


def test_a_signal_that_waits_for_an_import_does_not_come_after_the_end(tmp_path):
    """Another one is heeded first; the timer of the one that waits would end the process with SIGALRM."""
    (tmp_path / "forgetful.py").write_text(FORGETFUL.format(name="SIGTERM"))
    done = run_script(WAITING, tmp_path)
    assert (done.returncode, done.stdout) == (0, "ended\n"), done.stderr


AFTERWARDS = """
import os, signal, time
from quadgraph import cli
print(cli.main(["cache"]))
try:
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(60)
except KeyboardInterrupt:
    print("interrupted")
"""


def test_a_program_that_ran_a_command_line_can_still_be_interrupted(tmp_path):
    done = run_script(AFTERWARDS, tmp_path)
    assert done.stdout.endswith("0\ninterrupted\n"), done.stderr


AGAIN = """
import os, signal, time
from quadgraph.base import program
program.heed_signals()
try:
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(60)
except program.Stopped:
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        os.kill(os.getpid(), number)
    print("cleaned up")
time.sleep(1.1)
try:
    os.kill(os.getpid(), signal.SIGHUP)
    time.sleep(60)
except program.Stopped:
    print("ended")
"""


def test_more_signals_do_not_meet_the_cleaning_up(tmp_path):
    """Those that follow at once are the same wish; a later one is heeded again."""
    done = run_script(AGAIN, tmp_path)
    assert done.stdout == "cleaned up\nended\n", done.stderr
