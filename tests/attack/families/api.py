"""The Python interface: engines shared, forked and closed, arrays that are none, options of any size."""

from __future__ import annotations

import json
from typing import Any

from attack import texts
from attack.case import Case, Outcome, Place
from attack.texts import Rng

# What every program begins with: an engine of the ring, and how it ends: an error of ours in one line, or right.
HEAD = """
import copy, gc, json, os, pickle, sys, threading
import numpy as np
import quadgraph
from quadgraph import Engine, InputError, QuadGraphError, SceneFile, Stage

nan, inf = float("nan"), float("inf")
LIGHTS = ["directional:0.3,-0.5,-1:1", "ambient:0.1"]

def make():
    engine = Engine("body.qgraph", device="cpu")
    engine.material, engine.lights = "marble", LIGHTS
    return engine

def answer(engine, **options):
    solution = engine.solve(correction=False, **options)
    return solution, engine.surface().exitance

def right(solution, field=None):
    if not solution.converged or solution.stopped:
        return
    entered, balance = np.array(solution.energy.entered), np.array(solution.energy.balance)
    assert np.isfinite(entered).all() and np.isfinite(balance).all(), "converged, and not finite"
    error = solution.error.whole if solution.error else 0
    assert abs(balance[entered > 0]).max(initial=0) <= 1.05 * max(5e-4, error), f"converged, balance {balance}"
    assert field is None or np.isfinite(field).all(), "converged, and the field is not finite"

def same(a, b, what):
    error = np.sqrt(((a - b) ** 2).sum() / (b**2).sum())
    assert error < 2e-3, f"{what}: {error:.2%} off"

ALLOWED = (QuadGraphError, TypeError, ValueError)

def refused(call, *args, **kwargs):
    try:
        return call(*args, **kwargs)
    except ALLOWED as error:
        if not 0 < len(str(error)) < 500:
            raise SystemExit(f"quadgraph: error: {error}")
        return None

def main():
"""
TAIL = """

try:
    main()
except AssertionError as error:
    print("WRONG", str(error)[:300])
except ALLOWED as error:
    print(f"quadgraph: error: {error}", file=sys.stderr)
    sys.exit(1)
"""


def judged(place: Place, outcome: Outcome) -> str:
    """What a program found wrong itself."""
    return outcome.stdout.partition("WRONG ")[2].strip()


def program(name: str, body: str, expect: str = "", outputs: tuple[str, ...] = (), **more: Any) -> Case:
    """A case that runs lines of Python in a function."""
    lines = "".join(f"    {line}\n" for line in body.strip("\n").splitlines())

    def prepare(place: Place) -> None:
        place.bodies.put(place.folder)
        (place.folder / "program.py").write_text(HEAD + lines + TAIL)

    command = ("python", "program.py")
    return Case(name, command, (), prepare, outputs, judge=judged, expect=expect, **more)


def threads(rng: Rng) -> Case:
    """Threads that share an engine, or have one each: an answer, or a clear error."""
    count, shared, times = int(rng.integers(2, 7)), bool(rng.integers(3)), int(rng.integers(1, 4))
    body = f"""
engines = [make()] * {count} if {shared} else [make() for _ in range({count})]
truth = answer(make())[1]
found = []
def work(engine):
    for _ in range({times}):
        try:
            found.append(answer(engine)[1])
        except Exception as error:
            found.append(str(error))
workers = [threading.Thread(target=work, args=(engine,)) for engine in engines]
[worker.start() for worker in workers]
[worker.join() for worker in workers]
said = [each for each in found if isinstance(each, str)]
assert all("thread" in each or "solve" in each for each in said), said
assert {shared} or not said, said
[same(each, truth, "a thread") for each in found if not isinstance(each, str)]
"""
    return program(f"{count} threads, {'one engine' if shared else 'an engine each'}, {times} times", body, seconds=60)


def forks(rng: Rng) -> Case:
    """A child forked after a solve: told at once, or right with an engine of its own."""
    own, solved = bool(rng.integers(2)), bool(rng.integers(2))
    body = f"""
engine = make()
truth = answer(engine)[1] if {solved} else None
child = os.fork()
if child == 0:
    try:
        field = answer(make() if {own} else engine)[1]
        os._exit(0 if {own} else 7)
    except QuadGraphError as error:
        os._exit(8 if {own} or "fork" not in str(error) else 0)
code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
assert code == 0, f"the child ended with {{code}}"
if {solved}:
    same(answer(engine)[1], truth, "after the fork")
"""
    return program(f"fork {'after' if solved else 'before'} a solve, {'own' if own else 'inherited'} engine", body)


def arrays(rng: Rng) -> Case:
    """Arrays that hold no numbers, or of other shapes and kinds."""
    shape = texts.pick(
        rng, ["(576, 3)", "(576,)", "(0, 3)", "(575, 3)", "(3,)", "()", "(576, 4)", "(1, 3)", "(2, 576, 3)"]
    )
    kind = texts.pick(rng, ["f4", "f8", ">f8", "i8", "c16", "?", "U3", "O", "f2"])
    value = texts.pick(rng, ["nan", "inf", "-inf", "-1", "3e38", "1e300", "0", "1", "1e-45"])
    call = texts.pick(
        rng,
        [
            "engine._engine.set_irradiance(0, values)",
            f"[engine._engine.set_irradiance(k, np.full((n, 3), {value})) for k, n in ((0, 576), (1, 144))]",
            "engine.fluence_at(values)",
            "engine.set_coefficients(lambda points: (values, 0.1))",
            "engine.set_coefficients(lambda points: (1.0, values))",
            "engine.set_coefficients(lambda points: (1.0, 0.1), values)",
            "quadgraph.VolumeMaterial.from_function(lambda points: (1.0, values), engine.box, 4.0)",
            "quadgraph.VolumeMaterial.from_function(lambda points: (1.0, 0.1), values, 4.0)",
            "quadgraph.VolumeMaterial.from_function(lambda points: (1.0, 0.1), engine.box, values)",
            "engine.to_meshio(values)",
            "setattr(engine, 'material', quadgraph.VolumeMaterial(sigma_s_prime=values, sigma_a=values, spacing=1.0))",
            "quadgraph.Shapes(values, [values, values])",
            "engine.set_deformation([quadgraph.Displaced(quadgraph.Shapes(values, [values] * 2), [1.0])])",
        ],
    )
    body = f"""
engine = make()
truth = answer(engine)[1]
values = np.full({shape}, {value}, "f8").astype("{kind}")
refused(lambda: {call})
solution = refused(engine.solve, correction=False)
if solution is not None:
    right(solution, engine.surface().exitance)
again = make()
same(answer(again)[1], truth, "a new engine")
"""
    return program(f"{call[:60]} of {shape} {kind} {value}", body)


def option_values(rng: Rng) -> Case:
    """Options of a solve or a picture with any values."""
    solver = [
        "tolerance",
        "error",
        "cycles",
        "max_iterations",
        "bounces",
        "active_layers",
        "smoothing",
        "exchange_rows",
        "sweep_seed",
    ]
    texty = ["method", "solver", "source", "model", "inter_reflection", "warm", "mean_rays", "path", "foreign"]
    picture = ["width", "height", "roughness", "radiance", "show", "ground", "surroundings", "exposure"]
    draw = bool(rng.integers(3) == 0)
    names = picture if draw else solver + texty
    small = {"cycles", "bounces", "max_iterations", "width", "height"}
    chosen = {}
    for name in rng.choice(names, int(rng.integers(1, 3)), replace=False):
        value = texts.pick(rng, [texts.extreme(rng), int(rng.integers(-3, 40)), texts.junk(rng), "fem", True])
        large = isinstance(value, float | int) and name in small and 40 < abs(value) < 2e6
        chosen[str(name)] = 7 if large else value
    call = (
        f"engine.render('20,10', **({{'width': 32, 'height': 32}} | {chosen!r}))"
        if draw
        else f"engine.solve(**{chosen!r})"
    )
    body = f"""
engine = make()
truth = answer(engine)[1]
result = refused(lambda: {call})
if isinstance(result, quadgraph.Solution):
    right(result)
same(answer(engine)[1], truth, "afterwards")
"""
    return program(f"{'render' if draw else 'solve'} {str(chosen)[:70]}", body, seconds=40)


def closed(rng: Rng) -> Case:
    """Engines and stages that are closed, copied, pickled, or gone while their results live."""
    steps = {
        "closed": "engine.close(); refused(engine.solve); refused(engine.render); refused(engine.surface)",
        "twice": "engine.close(); engine.close(); engine.__exit__(None, None, None)",
        "unsolved": "other = make(); refused(other.surface); refused(other.render); refused(other.fluence)",
        "copied": "refused(copy.copy, engine); refused(copy.deepcopy, engine)",
        "pickled": "refused(pickle.dumps, engine); refused(pickle.dumps, engine.solution)",
        "gone": "field = engine.surface(); picture = engine.render(width=16, height=16); del engine; gc.collect(); "
        "assert np.isfinite(field.exitance).all(); picture.srgb(); engine = make()",
        "stage": "stage = Stage(device='cpu'); refused(stage.solve); refused(stage.render); stage.close(); "
        "refused(stage.solve)",
        "no body": "refused(Engine, 'gone.qgraph'); refused(Engine, ''); refused(Engine, 7); refused(Engine, None)",
        "again": "engine.__init__('body.qgraph', device='cpu'); engine.material, engine.lights = 'marble', LIGHTS",
    }
    chosen = [str(name) for name in rng.choice(list(steps), int(rng.integers(1, 4)), replace=False)]
    lines = "\n".join(f"{steps[name]}\nengine = make()" for name in chosen)
    body = f"engine = make()\ntruth = answer(engine)[1]\n{lines}\nsame(answer(make())[1], truth, 'a new engine')"
    return program(f"engines {', '.join(chosen)}", body, seconds=40)


def extreme_lights(rng: Rng) -> Case:
    """Lights as objects, of any power and place."""
    n = [texts.extreme(rng) if rng.integers(3) == 0 else float(rng.uniform(-50, 50)) for _ in range(8)]
    forms = [
        f"quadgraph.PointLight(position=({n[0]}, {n[1]}, {n[2]}), power={n[3]})",
        f"quadgraph.DirectionalLight(direction=({n[0]}, {n[1]}, {n[2]}), irradiance={n[3]})",
        f"quadgraph.AmbientLight(irradiance=({n[0]}, {n[1]}, {n[2]}))",
        f"quadgraph.SpotLight(({n[0]}, {n[1]}, 40), (0, 0, -1), angle={n[2]}, edge={n[3]}, power={n[4]})",
        f"quadgraph.RectangleLight(centre=(0, 0, {n[0]}), u=({n[1]}, 0, 0), v=(0, {n[2]}, {n[3]}), power={n[4]})",
    ]
    light = texts.pick(rng, forms)
    body = f"""
engine = make()
truth = answer(engine)[1]
def light():
    engine.lights = [{light}]
    return engine.solve(correction=False)
solution = refused(light)
if solution is not None:
    right(solution, engine.surface().exitance)
    entered = max(solution.energy.entered)
    said = solution.stopped or solution.light_warning
engine.lights = LIGHTS
same(answer(engine)[1], truth, "afterwards")
"""
    return program(light[:90], body)


def there_and_back(rng: Rng) -> Case:
    """Changes and their reverse, some of them refused between: the answer is what it was."""
    changes = [
        "engine.set_deformation([{'type': 'twist', 'axis': [0, 1, 0], 'degrees': 30}])",
        "engine.set_deformation([{'type': 'twist', 'axis': [0, 0, 0], 'degrees': nan}])",
        "engine.set_deformation([{'type': 'stretch', 'axis': [0, 1, 0], 'factor': 3}])",
        "engine.set_edits([{'operation': 'multiply', 'sigma_a': 9}])",
        "engine.set_edits([{'operation': 'set', 'sigma_a': -1}])",
        "setattr(engine, 'material', 'wholemilk')",
        "setattr(engine, 'material', 'no such')",
        "setattr(engine, 'lights', [])",
        "setattr(engine, 'lights', ['ambient:nan'])",
        "engine.solve(method='quadgraph-fv')",
        "engine.solve(method='polygrid')",
        "engine.solve(tolerance=-1)",
        "engine.render(width=-1)",
        "engine.set_cuts([{'type': 'plane', 'normal': [0, 0, 0], 'offset': 1}])",
    ]
    chosen = [changes[i] for i in rng.integers(0, len(changes), int(rng.integers(2, 9)))]
    lines = "\n".join(f"refused(lambda: {change})" for change in chosen)
    body = f"""
engine = make()
truth = answer(engine)[1]
{lines}
engine.set_deformation([])
engine.set_edits([])
engine.material, engine.lights = "marble", LIGHTS
same(answer(engine)[1], truth, "afterwards")
"""
    return program(f"there and back by {len(chosen)} changes, {chosen[0][7:50]}", body, seconds=40)


def stages(rng: Rng) -> Case:
    """Scenes one after the other in a stage, broken ones between."""
    good = {"body": "body.qgraph", "lights": [{"type": "ambient", "irradiance": 1}], "solver": {"correction": False}}
    listed = []
    for _ in range(int(rng.integers(2, 6))):
        path = texts.pick(rng, ["material", "lights", "deformation", "solver", "picture", "body", "camera"])
        value = texts.pick(rng, [texts.junk(rng), "jade", [], {"method": "quadgraph-fv"}])
        listed.append(good | {path: value})
    document = json.dumps([good, *listed, good])
    body = f"""
fields = []
with Stage(device="cpu") as stage:
    scenes = json.loads({document!r})
    for number, scene in enumerate(scenes):
        with open("s.json", "w") as file:
            json.dump(scene, file)
        def show():
            stage.show(SceneFile("s.json"))
            solution = stage.solve()
            right(solution)
            return stage.engine.surface().exitance
        field = refused(show)
        if number in (0, len(scenes) - 1):
            fields.append(field)
same(fields[1], fields[0], "the same scene again")
"""
    return program(f"stage, {len(listed)} scenes between", body, outputs=("s.json",), seconds=60)


RECIPES = (threads, forks, arrays, option_values, closed, extreme_lights, there_and_back, stages)
