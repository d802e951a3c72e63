"""The rooms of engine/ and shaders/ lie on floors, and includes lead down."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# From the lowest floor to the highest, as docs/architecture.md says: a room includes its own files and lower rooms'.
FLOORS = {
    "engine": (
        "base",
        "file",
        "optics",
        "deform",
        "reference",
        "derivative",
        "device",
        "vk",
        "cpu",
        "devices",
        "solve",
        "path",
        "render/display",
        "render/light",
        "render/inside",
        "render/picture",
        "render",
        "scene",
        "app",
    ),
    "shaders": (
        "shared",
        "material",
        "solver",
        "assemble",
        "deform",
        "source",
        "surface",
        "exchange",
        "transport",
        "gather",
        "light",
        "path",
        "display",
    ),
}
BODIES = ("file", "optics", "deform", "reference", "derivative")
# Rooms that know less of each other than their floors allow: the device knows no body, a body no device, one kind of
# device nothing of another, and what computes on devices only what they have in common.
STRANGERS = {(room, body) for room in ("device", "vk", "cpu", "devices") for body in BODIES}
STRANGERS |= {("cpu", "vk")}
STRANGERS |= {(room, kind) for room in ("solve", "path", "scene") for kind in ("vk", "cpu")}
STRANGERS |= {(room, kind) for room in FLOORS["engine"] if room.startswith("render") for kind in ("vk", "cpu")}
SUFFIXES = {".h", ".cpp", ".glsl", ".comp", ".vert", ".frag"}


def includes(file: Path) -> list[str]:
    """What a file includes in quotation marks."""
    return re.findall(r'^[ \t]*#[ \t]*include[ \t]+"([^"]+)"', file.read_text(), re.MULTILINE)


def sources(top: Path) -> list[Path]:
    """All files under a folder that include or are included."""
    return sorted(file for file in top.rglob("*") if file.suffix in SUFFIXES)


def room_of(top: Path, file: Path) -> str:
    """The folder of a file below its top one."""
    return file.relative_to(top).parent.as_posix()


def included_file(root: Path, top: str, name: str) -> Path | None:
    """The file under `top` that `name` means; None for one from elsewhere, such as compiled shaders."""
    if top == "shaders":
        return root / "shaders" / name
    return root / name if name.startswith("engine/") else None


def faults(root: Path, top: str) -> list[str]:
    """Arrows that lead up, or between strangers, or nowhere, and files in folders that no floor lists."""
    floors, found = FLOORS[top], []
    for file in sources(root / top):
        room, here = room_of(root / top, file), file.relative_to(root)
        if room not in floors:
            found.append(f"{here}: {top}/{room} is on no floor")
            continue
        for name in includes(file):
            target = included_file(root, top, name)
            if target is None:
                continue
            if not target.is_file():
                found.append(f"{here}: there is no {name}")
                continue
            other = room_of(root / top, target)
            if other not in floors:
                found.append(f"{here}: {name} is on no floor")
            elif floors.index(other) > floors.index(room) or (top == "engine" and (room, other) in STRANGERS):
                found.append(f"{here}: must not include {name}")
    return found


@pytest.mark.parametrize("top", FLOORS)
def test_every_include_leads_down(top):
    """Nothing points up, at no file, or out of the rooms that are listed."""
    assert faults(ROOT, top) == []


@pytest.mark.parametrize("top", FLOORS)
def test_every_floor_has_files(top):
    """A room that is listed is there."""
    rooms = {room_of(ROOT / top, file) for file in sources(ROOT / top)}
    assert set(FLOORS[top]) == rooms


def test_shaders_know_nothing_of_the_engine():
    """What shaders/ includes lies there too, in C++ as in GLSL; generated headers and the system's are the engine's."""
    outside = [f"{file}: {name}" for file in sources(ROOT / "shaders") for name in includes(file) if "engine/" in name]
    assert outside == []


def test_headers_that_the_engine_takes_from_the_shaders_are_there():
    """What engine/ includes of shaders/ is a header that both languages compile."""
    named = {name for file in sources(ROOT / "engine") for name in includes(file) if name.startswith("shaders/")}
    assert named
    assert [name for name in sorted(named) if not (name.endswith(".h") and (ROOT / name).is_file())] == []


def test_every_file_that_shaders_share_guards_itself():
    """A file may be included by several that need it: it is compiled once."""
    shared = [file for file in sources(ROOT / "shaders") if file.suffix in {".h", ".glsl"}]
    guards = {file: f"QUADGRAPH_{file.name.upper().replace('.', '_')}" for file in shared}
    open_ones = [
        str(file) for file, guard in guards.items() if f"#ifndef {guard}\n#define {guard}\n" not in file.read_text()
    ]
    assert open_ones == []


@pytest.mark.parametrize(
    ("room", "line", "said"),
    [
        ("base", '#include "engine/app/main.h"', "must not include engine/app/main.h"),
        ("vk", '#include "engine/file/graph.h"', "must not include engine/file/graph.h"),
        ("solve", '#include "engine/vk/context.h"', "must not include engine/vk/context.h"),
        ("base", '  #  include "engine/base/gone.h"', "there is no engine/base/gone.h"),
        ("attic", "", "engine/attic is on no floor"),
    ],
)
def test_a_fault_is_seen(tmp_path, room, line, said):
    """An arrow up, one to a stranger, one to nothing and a folder without a floor are each reported."""
    for file in ("engine/app/main.h", "engine/file/graph.h", "engine/vk/context.h", f"engine/{room}/here.cpp"):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text("")
    (tmp_path / f"engine/{room}/here.cpp").write_text(line + "\n")
    assert faults(tmp_path, "engine") == [f"engine/{room}/here.cpp: {said}"]
