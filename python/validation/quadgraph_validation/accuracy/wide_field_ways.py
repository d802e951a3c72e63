"""Ways to the light that leaves the block of wide_field_case.py, each run in a process of its own."""

from __future__ import annotations

import contextlib
import io
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.api.engine import Engine
from quadgraph.api.materials import Material
from quadgraph.file import qgraph_file
from quadgraph.tets.graph import Graph
from quadgraph_validation.accuracy import wide_field_case as case
from quadgraph_validation.accuracy.wide_field_case import ETA, HALF, MEDIUM, SIDES, Left
from quadgraph_validation.base import extra_module
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import pmmc_walk

FEW_WALKS = 100_000  # of pmmc through the same tets
_FAR = 2000.0  # mm, of the projector that stands in for parallel light
_LOW = -SIDES[2] / 2

Solve = Callable[[Medium], Left]


@dataclass(frozen=True)
class WayTaken:
    """What a way found; seconds of processors of a set-up and of one solve, and of this by the clock; bytes: that it
    took at most beyond what there was before it; tets.
    """

    left: Left
    set_up_s: float
    solve_s: float
    clock_s: float
    peak_bytes: int
    tets: int


def redbird() -> Any:
    """Import redbirdpy. Raises InputError, naming what installs it, where it is absent."""
    with contextlib.redirect_stdout(io.StringIO()):
        return extra_module.load("redbirdpy", "rivals")


def tets_of(path: Path) -> Graph:
    """The finest level of a baked file."""
    sections = qgraph_file.read(path).sections
    tets, faces, face_tets, links = (
        np.array(sections[f"level0/{name}"], np.int64) for name in ("tets", "faces", "face_tets", "links")
    )
    vertices, nodes = (np.array(sections[f"level0/{name}"], np.float64) for name in ("vertices", "nodes"))
    return Graph(vertices, tets, faces, face_tets, links, nodes[: len(tets)], nodes[len(tets) :])


def by_redbird(path: Path, method: str) -> Solve:
    """Its finite elements, set up; method: of its linear solver."""
    module, body = redbird(), tets_of(path)
    prepared: dict[str, Any] = {}

    def prepare(medium: Medium) -> None:
        # Where its sources lie depends on the coefficients.
        prepared.update(cfg=module.meshprep(_asked(body, medium))[0], medium=medium)

    def solve(medium: Medium) -> Left:
        if prepared["medium"] != medium:
            prepare(medium)
        cfg = prepared["cfg"]
        readings, fluence = module.runforward(cfg, method=method, nthread=1)
        faces = np.asarray(cfg["face"])[:, :3].astype(int) - 1
        reflected = cfg["reff"]
        leaving = fluence[faces, 0].mean(axis=1) * (1 - reflected) / (2 * (1 + reflected)) * np.asarray(cfg["area"])
        return case.in_patches(body.vertices[faces].mean(axis=1), leaving, float(readings[0, 0]))

    prepare(MEDIUM)
    return solve


def reconstructed(path: Path, reading: float, start: float, steps: int) -> float:
    """sigma_a, 1/mm, that redbird's own reconstruction finds from what its detector reads, told the right sigma_s'."""
    module, body = redbird(), tets_of(path)
    guess = Medium(MEDIUM.sigma_s_prime, start)
    cfg, pairs = module.meshprep(_asked(body, guess))
    bulk = {"mua": start, "musp": guess.sigma_s_prime, "n": ETA}
    unknown = {"prop": _properties(guess), "seg": np.ones(len(body.vertices), int), "bulk": bulk}
    given: dict[str, Any] = {"maxiter": steps, "lambda_": 1e-9, "method": "cg+amg", "nthread": 1, "report": False}
    found = module.runrecon(cfg, unknown, np.array([[reading]]), pairs, reform="logphase", **given)[0]
    return float(np.asarray(found["prop"])[1, 0])


def _asked(body: Graph, medium: Medium) -> dict[str, Any]:
    """The example as redbird has it."""
    given: dict[str, Any] = {
        "node": body.vertices,
        "elem": body.tets + 1,
        "seg": np.ones(len(body.tets), int),
        "srctype": "planar",
        "srcdir": [0, 0, 1],
        "dettype": "planar",
        "detdir": [0, 0, -1],
        "omega": 0,
        "srcweight": 1,
        "prop": _properties(medium),
    }
    for name, z in (("src", _LOW), ("det", -_LOW)):
        given |= {f"{name}pos": [-HALF, -HALF, z], f"{name}param1": [2 * HALF, 0, 0, 0]}
        given |= {f"{name}param2": [0, 2 * HALF, 0, 0]}
    return given


def _properties(medium: Medium) -> np.ndarray:
    """Rows of air and of the medium, as redbird has them: sigma_a, scattering, its g and the index."""
    return np.array([[0, 0, 1, 1], [medium.sigma_a, medium.sigma_s_prime, 0, ETA]])


def by_pmmc(path: Path) -> Solve:
    """Its walks through the same tets."""
    pmmc_walk.load()
    body = tets_of(path)
    return lambda medium: case.walked(body, FEW_WALKS, 7)


def by_engine(path: Path, device: str, correction: bool) -> Solve:
    """Ours; the light is a projector so far away that its rays are parallel to .6 degrees."""
    from PIL import Image

    engine = Engine(path, device=device)
    white = path.with_suffix(".png")
    Image.fromarray(np.full((16, 16, 3), 255, np.uint8)).save(white)
    angle = float(2 * np.degrees(np.arctan(HALF / _FAR)))
    engine.lights = [f"projector:0,0,{_LOW - _FAR}:0,0,1:{angle}:{white}:1"]

    def solve(medium: Medium) -> Left:
        engine.material = Material((medium.sigma_s_prime,) * 3, (medium.sigma_a,) * 3, ETA)
        solution = engine.solve(correction=correction)
        entered = float(solution.energy.entered[0])
        field = engine.surface()
        detector = float(engine.fluence_at(case.detector_points())[:, 0].mean()) / entered
        power = field.exitance[:, 0].astype(np.float64) * field.area / entered
        return case.in_patches(field.position.astype(np.float64), power, detector)

    return solve


def measured(name: str, path: Path, device: str) -> WayTaken:
    """By the way of that name in WAYS; solved twice, and the second time counts."""
    before = _bytes("VmRSS")
    used = time.process_time()
    solve = WAYS[name](path, device)
    set_up = time.process_time() - used
    if not name.startswith("pmmc"):
        solve(MEDIUM)
    begun, used = time.perf_counter(), time.process_time()
    left = solve(MEDIUM)
    seconds, used = time.perf_counter() - begun, time.process_time() - used
    peak = _bytes("VmHWM") - before
    return WayTaken(left, set_up, used, seconds, peak, len(tets_of(path).tets))


def _bytes(name: str) -> int:
    """Of this process: a line of its status, such as VmRSS, of memory that it has."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024 * int(next(line for line in lines if line.startswith(f"{name}:")).split()[1])


WAYS: dict[str, Callable[[Path, str], Solve]] = {
    "redbirdpy, its default solver": lambda path, device: by_redbird(path, "auto"),
    "redbirdpy, cg+amg": lambda path, device: by_redbird(path, "cg+amg"),
    f"pmmc, {FEW_WALKS:,} walks": lambda path, device: by_pmmc(path),
    "ours, --no-correction": lambda path, device: by_engine(path, device, False),
    "ours": lambda path, device: by_engine(path, device, True),
}
