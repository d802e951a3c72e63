"""Much of everything, and little of disk and files: lights, edits, engines, full disks, two writers."""

from __future__ import annotations

import json
import os
import subprocess
from dataclasses import replace

from attack import texts
from attack.case import Case, Outcome, Place
from attack.child import program as path_of
from attack.families import api, outputs
from attack.families.scenes import SCENE
from attack.families.signals import whole
from attack.physics import Judge, engine, rendered
from attack.texts import Rng


def _scene(document: dict, name: str, seconds: float = 30) -> Case:
    def prepare(place: Place) -> None:
        outputs.put(place)
        (place.folder / "scene.json").write_text(json.dumps(document))

    names = ("scene.json", "lights", "edits")
    return Case(name, engine("scene.json"), names, prepare, ("out.png",), judge=rendered(size=None), seconds=seconds)


def lights(rng: Rng) -> Case:
    """From a few lights to thousands."""
    count = int(10 ** rng.uniform(0.3, 3.5))
    kinds = [
        lambda: {"type": "point", "position": rng.uniform(-40, 40, 3).tolist(), "power": 1},
        lambda: {"type": "directional", "direction": rng.normal(size=3).tolist(), "irradiance": 1},
        lambda: {"type": "spot", "position": [0, 0, 50], "direction": [0, 0, -1], "angle": 30, "power": 1},
        lambda: {"type": "rectangle", "centre": [0, 0, 40], "u": [9, 0, 0], "v": [0, -9, 0], "power": 1},
        lambda: {"type": "ambient", "irradiance": 0.01},
    ]
    kind = texts.pick(rng, kinds)
    listed = [kind() for _ in range(count)]
    scene = SCENE | {"lights": listed, "edits": [], "deformation": [], "tracks": []}
    return _scene(scene, f"{count} lights, {listed[0]['type']}", 60)


def edits(rng: Rng) -> Case:
    """From a few edits to twenty thousand."""
    count = int(10 ** rng.uniform(0.3, 4.3))
    edit = {"operation": "multiply", "sigma_a": 1.001, "radius": 1}
    listed = [edit | {"stroke": rng.uniform(-14, 14, (2, 3)).tolist()} for _ in range(count)]
    return _scene(SCENE | {"edits": listed, "deformation": [], "tracks": []}, f"{count} edits", 60)


def deformers(rng: Rng) -> Case:
    """From a few deformers to thousands, which leave the body where it is."""
    count = int(10 ** rng.uniform(0.3, 3.5))
    step = {"type": "twist", "axis": [0, 1, 0]}
    listed = [step | {"degrees": 1 if i % 2 else -1} for i in range(2 * (count // 2))]
    return _scene(SCENE | {"edits": [], "deformation": listed, "tracks": []}, f"{len(listed)} deformers", 60)


def engines(rng: Rng) -> Case:
    """Many engines in a process, together or one after the other."""
    together, count = bool(rng.integers(2)), int(10 ** rng.uniform(0.3, 1.6))
    body = f"""
truth = answer(make())[1]
kept = []
for number in range({count}):
    engine = make()
    same(answer(engine)[1], truth, f"engine {{number}}")
    kept = [*kept, engine] if {together} else []
"""
    memory = 4 * 10**9 if together else 10**9
    name = f"{count} engines {'together' if together else 'after each other'}"
    return api.program(name, body, seconds=90, memory=memory)


def loops(rng: Rng) -> Case:
    """One engine that is changed and asked again and again keeps no memory."""
    count = int(rng.integers(10, 60))
    body = f"""
import resource
engine = make()
def frame(number):
    engine.lights = [f"directional:{{number % 7 - 3}},-1,-1:1"]
    engine.set_edits([{{"operation": "multiply", "sigma_a": 1 + number % 5}}])
    right(answer(engine)[0])
    engine.render(f"{{7 * number}},10", width=24, height=24)
def held():
    return int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()
[frame(number) for number in range(10)]
before = held()
[frame(number) for number in range({count})]
assert held() - before < 6e7, f"{{(held() - before) / 1e6:.0f}} MB more after {count} frames"
"""
    return api.program(f"{count} frames of one engine", body, seconds=90)


def full_disk(rng: Rng) -> Case:
    """A disk that fills up while an output is written: a message, the old file as it was, nothing half-written."""
    file = texts.pick(rng, list(outputs.WRITERS))
    blocks = int(10 ** rng.uniform(0, 1.2)) if file != "out.qgraph" else int(10 ** rng.uniform(0, 1.7))
    line = outputs.WRITERS[file]

    def prepare(place: Place) -> None:
        outputs.put(place)
        (place.folder / file).write_text("what was there")

    case = Case(f"{line[0]} {file}, {blocks} blocks", line, (file, "temp", "space"), prepare, (file,), blocks=blocks)
    return replace(case, judge=whole)


def read_only(rng: Rng) -> Case:
    """A folder in which nothing may be written."""
    file = texts.pick(rng, list(outputs.WRITERS))
    line = outputs.WRITERS[file]
    command = tuple(f"locked/{file}" if word == file else word for word in line)
    if os.geteuid() == 0:
        drop = "-dac_override,-dac_read_search"
        command = (
            "sh",
            "-c",
            f'exec setpriv --bounding-set={drop} --inh-caps={drop} "$@"',
            "sh",
            path_of(line[0]),
            *command[1:],
        )

    def prepare(place: Place) -> None:
        outputs.put(place)
        (place.folder / "locked").mkdir()
        (place.folder / "locked" / file).write_text("what was there")
        (place.folder / "locked").chmod(0o555)

    return Case(f"{line[0]} {file}, read-only folder", command, (file, "locked"), prepare, expect="refused")


def no_temporary_folder(rng: Rng) -> Case:
    """No folder for temporary files, which a bake needs: a message, or without one."""
    lines = [
        ("quadgraph", "bake", "mesh.ply", "--unit", "mm", "-o", "out.qgraph"),
        outputs.WRITERS["out.mp4"],
        outputs.WRITERS["out.json"],
    ]
    line = texts.pick(rng, lines)
    name = f"{line[1]} {line[-1]}"
    if rng.integers(2):
        return Case(f"{name}, no block", line, ("out.", "temp"), outputs.put, blocks=0, expect="refused")
    missing = {"TMPDIR": texts.pick(rng, ["/nonexistent", "/dev/null", "", "x" * 5000])}
    return Case(f"{name}, TMPDIR {missing['TMPDIR'][:12]!r}", line, (), outputs.put, (line[-1],), environment=missing)


def few_files(rng: Rng) -> Case:
    """A process that may open few files; of fewer than six Python cannot read its own modules."""
    line = texts.pick(rng, [outputs.WRITERS[name] for name in ("out.json", "out.png", "out.exr")])
    files = int(rng.integers(6, 30))
    return Case(f"{line[0]} {line[1]}, {files} files", line, (), outputs.put, (line[-1],), files=files)


# The time of day jumps to and fro by years, from one question to the next.
CLOCK = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>

static long jump(void) {
  static unsigned asked;
  return atol(getenv("JUMP")) * (asked++ % 3 - 1L);
}

int clock_gettime(clockid_t clock, struct timespec* now) {
  int (*real)(clockid_t, struct timespec*) = dlsym(RTLD_NEXT, "clock_gettime");
  int result = real(clock, now);
  if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) now->tv_sec += jump();
  return result;
}

int gettimeofday(struct timeval* now, void* zone) {
  struct timespec ts;
  clock_gettime(CLOCK_REALTIME, &ts);
  now->tv_sec = ts.tv_sec;
  now->tv_usec = ts.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* now) {
  struct timespec ts;
  clock_gettime(CLOCK_REALTIME, &ts);
  if (now) *now = ts.tv_sec;
  return ts.tv_sec;
}
"""


def jumping_clock(rng: Rng) -> Case:
    """A clock that is set forward and back while a program runs."""
    baked = ("quadgraph", "render", "mesh.ply", "--unit", "mm", *outputs.SMALL, "-o", "out.png")
    line, seconds = texts.pick(rng, [*outputs.WRITERS.values(), baked]), int(10 ** rng.uniform(0, 9))

    def prepare(place: Place) -> None:
        outputs.put(place)
        command = ["cc", "-shared", "-fPIC", "-o", place.folder / "clock.so", "-x", "c", "-", "-ldl"]
        subprocess.run(command, input=CLOCK, text=True, check=True, capture_output=True)

    preloaded = {"LD_PRELOAD": "./clock.so", "JUMP": str(seconds)}
    name = f"{line[0]} {line[1]} to {line[-1]}, a clock that jumps by {seconds} s"
    return Case(name, line, (), prepare, (line[-1],), environment=preloaded, judge=whole, expect="fine", seconds=40)


def two_writers(rng: Rng) -> Case:
    """Two processes that write one output at once: it is whole, and one of theirs."""
    file = texts.pick(rng, [name for name in outputs.WRITERS if name != "out.mp4"])
    line = outputs.WRITERS[file]
    count, delay = int(rng.integers(2, 4)), float(rng.uniform(0, 0.3))
    command = (
        "sh",
        "-c",
        f'for i in {"x " * count}; do "$@" & sleep {delay:.2f}; done; wait',
        "sh",
        path_of(line[0]),
        *line[1:],
    )
    name = f"{count} times {line[0]} {line[1]} onto {file}"
    return Case(name, command, (), outputs.put, (file,), judge=_there(file), memory=3 * 10**9, seconds=60)


def _there(file: str) -> Judge:
    def judge(place: Place, outcome: Outcome) -> str:
        return whole(place, outcome) if (place.folder / file).is_file() else f"{file} is not there"

    return judge


RECIPES = (
    lights,
    edits,
    deformers,
    engines,
    loops,
    full_disk,
    read_only,
    no_temporary_folder,
    few_files,
    jumping_clock,
    two_writers,
)
