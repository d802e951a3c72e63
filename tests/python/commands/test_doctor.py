"""`quadgraph doctor` says what is there and what to do about the rest, whatever is missing, and never fails itself."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from engine_program import ROOT
from quadgraph.commands import doctor_checks

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SWIFTSHADER = Path("/usr/lib/chromium/vk_swiftshader_icd.json")
NEEDED = {"quadgraph", "Python", "NumPy", "engine", "picture", "mesh libraries", "TetGen", "temporary files"}


def doctor(*arguments: str, script: str = "", **environment: str | None) -> subprocess.CompletedProcess:
    """Run it in another environment; None takes a name away, and the script comes before it."""
    changed = {name: value for name, value in (os.environ | environment).items() if value is not None}
    code = f"import sys\n{script}\nfrom quadgraph.cli import main\nsys.exit(main(['doctor', *{list(arguments)!r}]))"
    return subprocess.run(
        [sys.executable, "-c", code], env=changed, capture_output=True, text=True, timeout=240, check=False
    )


# In place of importing all that bakes, which takes longer than all else, where a test is about something else.
SPARED = """from quadgraph.commands import doctor_checks
tried = doctor_checks.tried
doctor_checks.tried = lambda what: {"modules": []} if what == "bake" else tried(what)
"""


def report(script: str = SPARED, **environment: str | None) -> tuple[int, dict]:
    done = doctor("--json", script=script, **environment)
    assert done.stderr == ""
    return done.returncode, json.loads(done.stdout)


def named(found: dict, name: str) -> dict:
    return next(check for check in found["checks"] if check["name"] == name)


def test_all_is_well_here_and_told_to_people():
    done = doctor()
    assert (done.returncode, done.stderr) == (0, "")
    assert "baking and rendering work" in done.stdout
    assert re.search(r"ok +picture +made on .* \(.*\): ", done.stdout)
    assert re.search(r"ok +TetGen +/", done.stdout)


def test_json_has_every_check_with_a_cure_for_what_is_missing():
    status, found = report(script="", DISPLAY=None, WAYLAND_DISPLAY=None)
    assert (status, found["works"]) == (0, True)
    assert {check["name"] for check in found["checks"] if check["needed"]} == NEEDED
    for check in found["checks"]:
        assert check["found"]
        assert (check["cure"] is None) == check["ok"], check
    assert not named(found, "window")["ok"]
    assert "no display" in named(found, "window")["found"]


def test_cures_name_packages_that_tools_packages_has():
    text = Path(doctor_checks.__file__).read_text()
    packages = (ROOT / "tools" / "packages.txt").read_text()
    commands = re.findall(r"apt install ((?:[a-z][\w.+-]+ ?)+)", text)
    assert len(commands) >= 4
    for name in {name for command in commands for name in command.split() if name != "for" and name != "pymeshlab"}:
        assert re.search(rf"(^|\s){re.escape(name)}(\s|$)", packages, re.MULTILINE), name


def test_without_drivers_the_processor_is_taken_and_said_aloud(tmp_path):
    absent = str(tmp_path / "absent.json")
    status, found = report(VK_DRIVER_FILES=absent, VK_ICD_FILENAMES=absent, QUADGRAPH_DEVICE=None)
    assert status == 0
    assert found["driver"].startswith("quadgraph cpu")
    assert "no GPU" in named(found, "picture")["found"]
    assert "mesa-vulkan-drivers" in named(found, "Vulkan")["cure"]


def test_without_a_loader_it_is_named_and_all_works(tmp_path):
    (tmp_path / "libvulkan.so.1").touch()
    environment = {"LD_LIBRARY_PATH": str(tmp_path), "QUADGRAPH_DEVICE": None}
    status, found = report(**environment)
    if named(found, "Vulkan")["ok"]:
        pytest.skip("an empty libvulkan.so.1 does not hide the loader from this system's dynamic linker")
    assert status == 0
    assert "no Vulkan loader" in named(found, "Vulkan")["found"]


def test_a_software_device_that_is_named_is_said_aloud():
    software = [each["name"] for each in _core.vulkan_devices() if each["software"] and not each["lacks"]]
    if not software:
        pytest.skip("there is no software device of Vulkan")
    status, found = report(QUADGRAPH_DEVICE=software[0])
    assert status == 0
    assert found["device"] == software[0]
    assert "QUADGRAPH_DEVICE" in named(found, "picture")["found"]
    assert "no GPU" in named(found, "picture")["found"]


def test_a_driver_that_crashes_on_shaders_is_refused_before_it_does():
    if not SWIFTSHADER.exists():
        pytest.skip(f"{SWIFTSHADER} is not there: apt install chromium")
    only = {name: str(SWIFTSHADER) for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES")}
    status, found = report(QUADGRAPH_DEVICE="swift", **only)
    assert (status, found["works"]) == (1, False)
    assert "SwiftShader" in named(found, "picture")["found"]
    assert "crash" in named(found, "picture")["found"]


def test_a_device_that_is_not_there_is_what_is_missing():
    status, found = report(QUADGRAPH_DEVICE="no such device")
    assert (status, found["works"]) == (1, False)
    assert "no such device" in named(found, "picture")["found"]
    assert named(found, "picture")["cure"] == "unset QUADGRAPH_DEVICE"


def test_missing_programs_and_folders_are_named(tmp_path):
    """TetGen is not beside the interpreter but on the PATH; a home that is a file takes no cache."""
    home = tmp_path / "home"
    home.touch()
    status, found = report(PATH=str(tmp_path), HOME=str(home), XDG_CACHE_HOME=None)
    assert status == 1
    assert named(found, "TetGen")["cure"] == "apt install tetgen"
    cache = named(found, "cache")
    assert not cache["ok"]
    assert "XDG_CACHE_HOME" in cache["cure"]
    assert home.read_bytes() == b""


def test_without_any_temporary_folder_it_says_so():
    script = SPARED + "import tempfile; tempfile._candidate_tempdir_list = lambda: []"
    done = doctor("--json", script=script)
    found = json.loads(done.stdout)
    assert done.returncode == 1
    assert "TMPDIR" in named(found, "temporary files")["cure"]


def test_without_the_engine_it_says_what_builds_it():
    done = doctor("--json", script="sys.modules['quadgraph._core'] = None")
    found = json.loads(done.stdout)
    assert done.returncode == 1
    assert "tools/setup" in named(found, "engine")["cure"]


def test_a_process_that_a_library_ends_is_a_check_that_failed(monkeypatch):
    monkeypatch.setattr(doctor_checks.sys, "executable", "/bin/false")
    doctor_checks.tried.cache_clear()
    try:
        assert "ended with 1" in doctor_checks.tried("picture")["error"]
        assert {check.name for check in doctor_checks.devices() if not check.ok} == {"Vulkan", "picture"}
    finally:
        doctor_checks.tried.cache_clear()
