"""Command lines: numbers, texts, names of frames, surroundings of the process."""

from __future__ import annotations

import json
import os

from attack import texts
from attack.case import Case, Outcome, Place
from attack.child import program
from attack.families.scenes import SCENE
from attack.physics import DEVICE, SOLVE_OUTPUTS, engine, rendered, solve, solved
from attack.texts import Rng

NUMBERS = {
    "bake": (
        "--height", "--levels", "--surface-vertices", "--grading", "--relax-nodes", "--visibility-rays", "--front",
        "--refine", "--interior", "--time-limit", "--memory-limit", "--error", "--cubes", "--cells", "--for-material",
    ),
    "solve": (
        "--tolerance", "--error", "--cycles", "--max-iterations", "--bounces", "--sweeps", "--sweep-points",
        "--sweep-seed", "--active-layers", "--path-cells", "--height",
    ),
    "render": (
        "--view", "--eye", "--look-at", "--fov", "--orthographic", "--size", "--roughness", "--exposure",
        "--background", "--frame", "--frames", "--show", "--tone", "--white-balance", "--aperture", "--focus",
    ),
    "turntable": ("--view", "--eye", "--size", "--exposure", "--background", "--frames", "--seconds"),
}  # fmt: skip
ENGINE = ("--view", "--fov", "--size", "--roughness", "--tolerance", "--cycles", "--sweep-points", "--exposure")
SLOW = (
    "--cycles",
    "--max-iterations",
    "--bounces",
    "--sweeps",
    "--sweep-points",
    "--path-cells",
    "--refine",
    "--levels",
)


def put(place: Place) -> None:
    """A body and a scene."""
    place.bodies.put(place.folder)
    (place.folder / "scene.json").write_text(json.dumps(SCENE | {"edits": [], "deformation": []}))


def numbers(rng: Rng) -> Case:
    """An option whose value is a number of any size, or none."""
    command = texts.pick(rng, [*NUMBERS, "engine"])
    option = texts.pick(rng, ENGINE if command == "engine" else NUMBERS[command])
    value = texts.number(rng).replace("\0", "")
    if option in ("--size", "--view", "--eye", "--look-at") and rng.integers(2):
        value = {"--size": "x", "--view": ","}.get(option, ",").join(
            texts.number(rng) for _ in range(2 + (option[2] in "el"))
        )
    many = option in SLOW or (command, option) == ("turntable", "--frames")
    if many and value.isdigit() and len(value) < 8:
        value = str(int(value) % 20)  # more is right, and takes its time
    return _with_option(command, option, value)


def _with_option(command: str, option: str, value: str) -> Case:
    words = (option.strip("-"), option[2:].replace("-", "_"), option, "relax", "material", "argument")
    name = f"{command} {option}={value[:40]!r}"
    given = f"{option}={value}"
    if command == "bake":

        def prepare(place: Place) -> None:
            (place.folder / "mesh.ply").write_bytes(place.bodies.body().with_suffix(".ply").read_bytes())

        unit = () if option == "--height" else ("--unit", "mm")
        line = ("quadgraph", "bake", "mesh.ply", "-o", "out.qgraph", *unit, given)
        if option != "--levels":
            line += ("--levels", "1")
        return Case(name, line, words, prepare, ("out.qgraph",), seconds=40)
    if command == "solve":
        return Case(name, (*solve(), given), words, put, SOLVE_OUTPUTS, judge=solved(), seconds=40)
    if command == "engine":
        return Case(name, (*engine(), given), words, put, ("out.png",), judge=rendered(size=None), seconds=40)
    if command == "turntable":
        rest = tuple(word for word in ("--size=32x32", "--frames=2") if not word.startswith(option))
        line = ("quadgraph", "turntable", "body.qgraph", "-o", "out.gif", *DEVICE, "--no-correction", *rest, given)
        return Case(name, line, words, put, ("out.gif",), seconds=40)
    file = "scene.json" if option in ("--frame", "--frames") else "body.qgraph"
    size = () if option == "--size" or file == "scene.json" else ("--size", "32x32")
    target = "%04d.png" if option == "--frames" else "out.png"
    line = ("quadgraph", "render", file, "-o", target, *DEVICE, *size, given)
    return Case(name, line, words, put, ("*.png",), seconds=40, partial=True)


def lights(rng: Rng) -> Case:
    """Lights of the command line with numbers of any size."""
    n = [f"{10 ** rng.uniform(-2, 3):.3f}" for _ in range(10)]
    for spot in rng.integers(0, 10, int(rng.integers(1, 3))):
        n[spot] = texts.number(rng).replace("\0", "") if rng.integers(2) else f"{texts.extreme(rng):.4g}"
    forms = [
        f"directional:{n[0]},{n[1]},-{n[2]}:{n[3]}",
        f"point:{n[0]},{n[1]},{n[2]}:{n[3]}/{n[4]}/{n[5]}",
        f"ambient:{n[0]}",
        f"spot:{n[0]},{n[1]},{n[2]}:-{n[3]},-{n[4]},-{n[5]}:{n[6]},{n[7]}:{n[8]}",
        f"rectangle:0,0,{n[0]}:{n[1]},0,0:0,-{n[2]},{n[3]}:{n[4]}",
        f"{texts.word(rng, 3)}:1".replace("\0", ""),
        f"point:{':' * int(10 ** rng.uniform(0, 4))}",
        f"ambient:{'1/' * int(10 ** rng.uniform(0, 5))}1",
    ]
    text = texts.pick(rng, forms)
    case = solve("body.qgraph", "--no-correction", f"--light={text}")
    return Case(f"light {text[:80]!r}", case, ("light", "argument"), put, SOLVE_OUTPUTS, judge=_lit_or_said)


def _lit_or_said(place: Place, outcome: Outcome) -> str:
    """A solve whose light may be 0, and then is dark; what is in the body is said."""
    report = json.loads((place.folder / "report.json").read_text())
    given = max(report["energy"]["entered"])
    dark = given == 0 and not report["light_warning"] and not report["stopped"]
    return solved(lit=False)(place, outcome) or ("" if not dark or _no_power(outcome) else "dark, without a word")


def _no_power(outcome: Outcome) -> bool:
    """Whether no light was asked for: a power of 0 is right."""
    return "0.0000" in outcome.stdout or " 0 " in outcome.stdout


def words(rng: Rng) -> Case:
    """Options that are none, twice, long, or without a value."""
    command = texts.pick(rng, ["bake", "solve", "render", "info", "shapes", "volume", "turntable", "sheet"])
    kinds = [
        (f"--{texts.word(rng, 5)}",),
        ("--device",),
        ("--device", texts.word(rng, 4)),
        ("--unit", "mm", "--unit", "parsec"),
        ("-o",),
        ("@body.qgraph",),
        ("--method=" + texts.word(rng, 4),),
        ("body.qgraph",) * int(10 ** rng.uniform(0, 4)),
        ("\udcff\udcfe",),
    ]
    more = tuple(word.replace("\0", "") for word in texts.pick(rng, kinds))
    name = f"{command} {more[0][:40]!a} ({len(more)})"
    right = command == "info" or (command, more) == ("solve", ("--",))  # which ends the options, and says no more
    return Case(name, ("quadgraph", command, "body.qgraph", *more), (), put, expect="" if right else "refused")


def frame_names(rng: Rng) -> Case:
    """Names of frames that would fill memory, or write where nobody asked."""
    width = int(10 ** rng.uniform(0.7, 10))
    name = texts.pick(
        rng, [f"%{width}d", f"%0{width}d", "%s%d", "%d%d", "%n", "%*d", "%05d%", "%x", "%-5d", "%+d", "%.9999d", "%04d"]
    )
    suffix = texts.pick(rng, [".png", ".exr", ".mp4", ".xyz", ""])
    file = f"out{name}{suffix}"
    line = ("quadgraph", "render", "scene.json", "-o", file, "--frames", "2", *DEVICE)
    return Case(f"frames {file[:40]!r}", line, ("out",), put, ("out*",), partial=True)


def frame_numbers(rng: Rng) -> Case:
    """Frames without number."""
    count = texts.pick(
        rng, ["4000000000", "0", "-1", "1e9", "1.5", texts.number(rng), str(int(10 ** rng.uniform(6.01, 20)))]
    )
    option = texts.pick(rng, ["--frames", "--frame"])
    line = ("quadgraph", "render", "scene.json", "-o", "out%04d.png" if option == "--frames" else "out.png", *DEVICE)
    given = f"{option}={count}".replace("\0", "")
    return Case(given[:60], (*line, given), ("frame",), put, ("out*",), partial=True)


def surroundings(rng: Rng) -> Case:
    """A process with odd variables, without standard streams, or in a folder that is gone."""
    variables = [
        {"COLUMNS": texts.pick(rng, ["-5", "0", "1", "999999999", "x"])},
        {"LANG": "C", "LC_ALL": "C", "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"},
        {"HOME": "/nonexistent", "XDG_CACHE_HOME": ""},
        {"TERM": "x" * 5000, "NO_COLOR": "", "FORCE_COLOR": "1"},
        {"TMPDIR": "/nonexistent"},
        {"PATH": "/nonexistent"},
        {"QUADGRAPH_DEVICE": texts.word(rng, 3).replace("\0", "")},
        {"OMP_NUM_THREADS": "-1", "LD_PRELOAD": ""},
    ]
    chosen = texts.pick(rng, variables)
    command = texts.pick(rng, [("quadgraph", "info", "body.qgraph"), solve()])
    outputs = SOLVE_OUTPUTS if command[1] == "solve" else ()
    expect = "fine" if not any(key in chosen for key in ("QUADGRAPH_DEVICE", "FORCE_COLOR")) else ""
    judge = solved() if outputs else lambda place, outcome: ""
    coloured = dict(chosen)
    coloured.pop("FORCE_COLOR", None)
    name = f"{command[1]} with {str(coloured)[:60]!a}"
    return Case(name, command, (), put, outputs, judge=judge, expect=expect, environment=coloured)


def streams(rng: Rng) -> Case:
    """Standard output that is full, closed, or whose reader is gone."""
    command = texts.pick(
        rng, ['"$0" info body.qgraph', '"$0" solve body.qgraph --device cpu --no-correction', '"$0" --help']
    )
    tail = texts.pick(rng, ["> /dev/full", ">&-", "| head -c 10 > /dev/null", "2>&-", "<&-", "2> /dev/full"])
    line = ("sh", "-c", f"{command} {tail}", program("quadgraph"))
    return Case(f"{command[5:20]} {tail}", line, (), put, expect="" if tail == "> /dev/full" else "fine")


def wrong_files(rng: Rng) -> Case:
    """A file of another kind, or none, where a body is wanted."""
    kind = texts.pick(rng, ["gone", "folder", "fifo", "zero", "null", "mesh", "json", "long", "control", "name"])
    name = {"long": "y" * 4000, "control": "\x1b[31mbody.qgraph", "zero": "/dev/zero", "null": "/dev/null"}.get(
        kind, "wrong.qgraph"
    )
    command = texts.pick(
        rng, [("quadgraph", "info", name), solve(name), engine(name), ("quadgraph", "render", name, "-o", "out.png")]
    )

    def prepare(place: Place) -> None:
        path = place.folder / "wrong.qgraph"
        if kind == "folder":
            path.mkdir()
        elif kind == "fifo":
            os.mkfifo(path)
        elif kind in ("mesh", "json"):
            path.write_text("ply\n" if kind == "mesh" else "{}")

    shown = ("body.qgraph",) if kind == "control" else (name[:20],)
    return Case(f"{command[0]} {command[1]:.10} of {kind}", command, shown, prepare, expect="refused")


def answers(rng: Rng) -> Case:
    """Options that are allowed, on any body: an answer that is in balance, or that says it is none."""
    body = texts.pick(rng, ["ring", "single", "tiny", "polygrid", "surface"])
    methods = ["fem", "quadgraph-fv", "quadgraph-fdm", "shortest-path", "polygrid", "polygrid-divergence"]
    method = "shortest-path" if body == "surface" else texts.pick(rng, methods)
    choices = {
        "--solver": ["fmg-pcg", "vcycle", "dpcg", "cascade", "auto"],
        "--source": ["buried", "diffuse"],
        "--model": ["diffusion", "sp3", "auto"],
        "--material": ["marble", "skin1", "jade", "ketchup", "wholemilk", "wood", "sigma_s_prime=0.5,sigma_a=0.001"],
        "--sweeps": ["1", "2"],
        "--bounces": ["1", "0"],
        "--path-cells": ["8", "24"],
    }
    chosen = [str(name) for name in rng.choice(list(choices), int(rng.integers(1, 4)), replace=False)]
    options = [word for name in chosen for word in (name, texts.pick(rng, choices[name]))]
    field = () if method == "shortest-path" else ("--field", "field.npz")
    line = ("quadgraph", "solve", "body.qgraph", *DEVICE, "--json", "report.json", *field, "--method", method)

    def prepare(place: Place) -> None:
        place.bodies.put(place.folder, body)

    fitting = body in ("ring", "single") and method in ("fem", "quadgraph-fv", "quadgraph-fdm")
    name = f"solve of {body}, {method} {' '.join(options)}"
    words = ("polygrid", "body.qgraph", "method", "solver", "model", "source", "sweeps")
    doubtful = {"--source", "--model", "--solver"} | ({"--sweeps"} if method != "fem" else set())
    expect = "fine" if fitting and not doubtful & set(chosen) else ""
    return Case(name, (*line, *options), words, prepare, SOLVE_OUTPUTS, judge=solved(), expect=expect, seconds=60)


RECIPES = (
    answers,
    numbers,
    lights,
    words,
    frame_names,
    frame_numbers,
    surroundings,
    streams,
    wrong_files,
)
