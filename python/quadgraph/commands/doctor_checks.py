"""What `quadgraph doctor` looks at: a function for each, none of which raises."""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from quadgraph.base import config_file
from quadgraph.base.cache_folder import cache_folder
from quadgraph.base.errors import QuadGraphError
from quadgraph.base.message import shortened
from quadgraph.base.version import __version__

VULKAN = "apt install libvulkan-dev mesa-vulkan-drivers, and the driver of the GPU where Mesa has none"
BUILD = "in the source tree: tools/setup"
_TIME_LIMIT_S = 120.0  # of what is tried in a process of its own
_LIBRARIES = "apt install libgl1 libopengl0 libxkbcommon0 for pymeshlab, and in the source tree: pip install ."


@dataclass(frozen=True)
class Check:
    """One line: what was looked at, whether it is there and needed, what was found, and what to do where it is not.

    needed: baking a mesh and rendering it does not work without it.
    """

    name: str
    ok: bool
    needed: bool
    found: str
    cure: str | None = None


@cache
def tried(what: str) -> dict[str, Any]:
    """What a process of its own says of it (doctor_child.py), under "error" why it says nothing."""
    command = [sys.executable, "-P", "-m", "quadgraph.commands.doctor_child", what]
    try:
        done = subprocess.run(command, capture_output=True, timeout=_TIME_LIMIT_S, check=False)
    except subprocess.TimeoutExpired:
        return {"error": f"did not end in {_TIME_LIMIT_S:g} s"}
    except OSError as error:
        return {"error": f"{sys.executable}: {error.strerror}"}
    try:
        return json.loads(done.stdout)
    except ValueError:
        words = done.stderr.decode(errors="replace").strip().splitlines() or ["no output"]
        return {"error": f"ended with {done.returncode}: {words[-1]}"}


def versions() -> Iterator[Check]:
    """QuadGraph, Python, NumPy and the compiled engine."""
    yield Check("quadgraph", True, True, f"{__version__} in {Path(__file__).resolve().parents[1]}")
    yield Check("Python", True, True, f"{platform.python_version()}, {sys.executable}")
    try:
        yield Check("NumPy", True, True, importlib.metadata.version("numpy"))
    except importlib.metadata.PackageNotFoundError as error:
        yield Check("NumPy", False, True, str(error), "pip install numpy")
    try:
        from quadgraph.core import load_core

        yield Check("engine", True, True, str(load_core().__file__))
    except QuadGraphError as error:
        yield Check("engine", False, True, str(error), BUILD)


def devices() -> Iterator[Check]:
    """Vulkan's loader, every device, and a picture made on the one that is taken."""
    found = tried("devices")
    if "error" in found:
        yield Check("Vulkan", False, False, found["error"], VULKAN)
    else:
        usable = [each for each in found["vulkan"] if not each["lacks"]]
        several = f"{len(found['vulkan'])} found, the engine can run on {len(usable)}"
        yield Check("Vulkan", bool(usable), False, several, None if usable else VULKAN)
        for each in found["vulkan"]:
            kind = "a software device: it computes on the processor" if each["software"] else "a GPU"
            lacks = f", lacks {each['lacks']}" if each["lacks"] else ""
            cure = "update its driver, or use --device cpu" if lacks else None
            yield Check("device", not lacks, False, f"{each['name']} ({each['driver']}), {kind}{lacks}", cure)
    yield Check("device", True, False, "cpu, the processor: always there, needs nothing of Vulkan")
    made = tried("picture")
    if "error" in made:
        cure = "unset QUADGRAPH_DEVICE" if os.environ.get("QUADGRAPH_DEVICE") else BUILD
        yield Check("picture", False, True, f"none could be made: {made['error']}", cure)
    else:
        yield Check("picture", True, True, f"made on {made['device']} ({made['driver']}): {why(made, found)}")


def why(made: dict[str, Any], found: dict[str, Any]) -> str:
    """Why the device that a picture was made on is taken, and that it is no GPU where it is none."""
    software = {each["name"] for each in found.get("vulkan", ()) if each["software"]}
    slow = "; that is no GPU: pictures are the same and take longer"
    if wanted := os.environ.get("QUADGRAPH_DEVICE"):
        slow = slow if is_processor(made) or made["device"] in software else ""
        return f"QUADGRAPH_DEVICE={wanted} of the environment names it{slow}"
    if not is_processor(made):
        return "a GPU, which is taken where there is one, a discrete one first"
    only = ", and software devices of Vulkan are taken only by name" if software else ""
    return f"no GPU was found{only}{slow}"


def is_processor(made: dict[str, Any]) -> bool:
    """Whether a picture was made on the processor, without Vulkan."""
    return str(made.get("driver")).startswith("quadgraph cpu")


def meshers() -> Iterator[Check]:
    """What a bake takes: libraries, TetGen, and the CGAL mesher."""
    found = tried("bake")
    yield Check("mesh libraries", "error" not in found, True, found.get("error", "read, repaired and simplified by"
                " pymeshlab, trimesh, SciPy and embreex"), _LIBRARIES if "error" in found else None)  # fmt: skip
    yield _program("TetGen", True, "apt install tetgen", "quadgraph.mesh.intersections", "TETGEN")
    cure = "apt install libcgal-dev libgmp-dev libmpfr-dev, then in the source tree: tools/setup"
    yield _program("CGAL mesher", False, cure, "quadgraph.mesh.wrap", "CGAL_MESH")


def _program(name: str, needed: bool, cure: str, module: str, member: str) -> Check:
    """Whether a program is there that a module keeps the place of."""
    try:
        return Check(name, True, needed, str(getattr(importlib.import_module(module), member).path()))
    except (ImportError, QuadGraphError, OSError) as error:
        return Check(name, False, needed, str(error), cure)


def window() -> Iterator[Check]:
    """What `quadgraph view` takes: its program, Vulkan and a display."""
    from quadgraph.commands import view

    shown = next((f"{name}={value}" for name in ("WAYLAND_DISPLAY", "DISPLAY") if (value := os.environ.get(name))), "")
    try:
        program = view.find_program()
    except QuadGraphError as error:
        yield Check("window", False, False, str(error), f"{BUILD} --vulkan")
        return
    if "error" in tried("devices"):
        yield Check("window", False, False, "a window needs Vulkan, see above", VULKAN)
    elif not shown:
        yield Check("window", False, False, "there is no display: neither DISPLAY nor WAYLAND_DISPLAY is set",
                    "start it in a desktop session, or use quadgraph render")  # fmt: skip
    else:
        yield Check("window", True, False, f"{program} on {shown}")


def folders() -> Iterator[Check]:
    """The folder of temporary files, which every bake needs, and that of bodies that are kept."""
    try:
        place = Path(tempfile.gettempdir())
        reason = cannot_write(place)
    except OSError as error:
        place, reason = Path(os.environ.get("TMPDIR", "/tmp")), str(error)
    cure = "set TMPDIR to a folder with room that you may write to"
    yield Check("temporary files", not reason, True, reason or str(place), cure if reason else None)
    try:
        place = cache_folder()
        size = sum(path.stat().st_size for path in place.rglob("*") if path.is_file())
        reason = cannot_write(place)
    except (OSError, RuntimeError) as error:
        size, reason = 0, str(error)
    cure = "set XDG_CACHE_HOME to a folder that you may write to; until then every bake is done again"
    found = reason or f"{place}, {size / 1e6:.1f} MB, writable (quadgraph cache lists it)"
    yield Check("cache", not reason, False, found, cure if reason else None)


def defaults() -> Iterator[Check]:
    """The user's file of defaults."""
    try:
        said = config_file.load()
        path = config_file.place()
        yield Check("config", True, False, f"{path}, {len(said)} entries" if path.exists() else f"none ({path})")
    except (QuadGraphError, OSError, RuntimeError) as error:
        yield Check("config", False, False, str(error), "correct it, or use --no-config")


def cannot_write(place: Path) -> str:
    """Why no file can be made in a folder, or in the first above it that there is; nothing where one can."""
    there = next(folder for folder in (place, *place.absolute().parents) if folder.exists())
    try:
        with tempfile.TemporaryFile(dir=there) as stream:
            stream.write(b"0" * 4096)
    except OSError as error:
        return f"{place}: cannot be written ({error.strerror})"
    return ""


def extras() -> Iterator[Check]:
    """What only some outputs and inputs need."""
    from quadgraph.file import openvdb

    there = importlib.util.find_spec("av") is not None
    cure = "pip install 'quadgraph[film]'"
    yield Check("films", there, False, "PyAV " + importlib.metadata.version("av") if there else "no PyAV: no .mp4 and "
                "no .webm", None if there else cure)  # fmt: skip
    try:
        yield Check("OpenVDB", True, False, f"its module is in {openvdb.OPENVDB.path()}")
    except (QuadGraphError, OSError):
        cure = "apt install python3-openvdb"
        yield Check("OpenVDB", False, False, "no Python module: quadgraph volume cannot read .vdb", cure)
    made = "error" not in tried("picture")
    yield Check("OpenEXR", made, False, "part of the engine" if made else "see picture", None if made else BUILD)


GROUPS: dict[str, Callable[[], Iterator[Check]]] = {
    "versions": versions,
    "devices": devices,
    "bakes": meshers,
    "window": window,
    "folders": folders,
    "config": defaults,
    "extras": extras,
}


def checks() -> list[Check]:
    """All of them; what fails in a way that nobody foresaw is one that is missing."""
    found: list[Check] = []
    for name, group in GROUPS.items():
        try:
            found.extend(group())
        except Exception as error:
            found.append(Check(name, False, True, shortened(f"{type(error).__name__}: {error}"), BUILD))
    return found
