"""`--error` of a file that was baked for one: every way to solve it takes what the bake measured, and says the same."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import pytest
from test_engine_executable import pytestmark, run

from baked import write_levels
from quadgraph import cli
from quadgraph.file import qgraph_file
from shapes import icosphere

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

__all__ = ["pytestmark"]

SUN = "directional:0,-0.6,-0.8:1"
SUN_IN_SCENE = {"type": "directional", "direction": [0, -0.6, -0.8], "irradiance": 1}


def trial(model: str, cycles: int, cost: float, error: float) -> dict:
    return {
        "surface_vertices": 162,
        "levels": 2,
        "deep": True,
        "model": model,
        "cycles": cycles,
        "sweeps": 0,
        "cost": cost,
        "errors": {"given": {"whole": error / 2, "unlit": error}},
        "share": 0.95,
    }


RECORD = {
    "material": "skin1",
    "lights": {"given": [SUN]},
    "lights_given": True,
    "inter_reflection": False,
    "surface_vertices": 162,
    "levels": [162, 42],
    "trials": [trial("diffusion", 2, 10.0, 0.04), trial("sp3", 3, 20.0, 0.01)],
}


def recorded(source: Path, path: Path, record: dict) -> Path:
    """A copy whose bake measured that."""
    file = qgraph_file.read(source)
    sections = {name: array for name, array in file.sections.items() if name != "metadata"}
    qgraph_file.write(path, file.metadata | {"budget": record}, sections)
    return path


@pytest.fixture(scope="module")
def sphere(tmp_path_factory) -> Path:
    """A sphere of two levels, radius 10 mm."""
    path = tmp_path_factory.mktemp("measured") / "sphere.qgraph"
    return write_levels(path, [icosphere(2, 10), icosphere(1, 10)])


@pytest.fixture(scope="module")
def baked(sphere) -> Path:
    return recorded(sphere, sphere.with_name("baked.qgraph"), RECORD)


@dataclass(frozen=True)
class Outcome:
    """What a run was, as far as all ways must agree."""

    status: int
    model: str
    cycles: int
    iterations: int
    budget: str
    unmet: tuple[str, ...]

    @classmethod
    def of(cls, status: int, solve: dict) -> Outcome:
        return cls(
            status,
            solve["model"],
            solve["cycles"],
            solve["levels"][-1]["iterations"],
            solve["budget"],
            tuple(solve["unmet"]),
        )


def by_command(folder: Path, *arguments: object) -> Outcome:
    """By `quadgraph render`."""
    report = folder / "report.json"
    out = ["-o", folder / "a.png", "--json", report]
    status = cli.main(["render", *map(str, [*arguments, *out])])
    return Outcome.of(status, json.loads(report.read_text()))


def by_engine(folder: Path, *arguments: object) -> Outcome:
    """By quadgraph-engine."""
    found = run("--headless", *arguments, "-o", folder / "a.png", "--json")
    assert found.stderr == ""
    return Outcome.of(found.returncode, json.loads(found.stdout)["solve"])


def scene_file(folder: Path, body: Path, error: float, material: str, **more: object) -> Path:
    path = folder / "scene.json"
    scene = {
        "quadgraph_scene": 1,
        "body": str(body),
        "material": material,
        "lights": [SUN_IN_SCENE],
        "solver": {"error": error},
        "picture": {"width": 16, "height": 16},
    }
    path.write_text(json.dumps(scene | more))
    return path


@pytest.mark.parametrize(
    ("error", "material", "expected", "words"),
    [
        (0.05, "skin1", (0, "diffusion", 2), "error 5%: kept, the bake measured 4% in this light with diffusion and 2"),
        (0.02, "skin1", (0, "sp3", 3), "error 2%: kept, the bake measured 1% in this light with sp3 and 3 cycles"),
        pytest.param(
            0.005,
            "skin1",
            (0, "sp3", 0),
            "error 0.5%: the bake measured no less than 1% on this file",
            marks=pytest.mark.long,
        ),
        pytest.param(
            0.0002,
            "wholemilk",
            (0, "diffusion", 0),
            "error 0.02%: the bake measured skin1, not wholemilk",
            marks=pytest.mark.long,
        ),
    ],
)
def test_every_way_to_solve_a_file_takes_what_its_bake_measured(baked, tmp_path, error, material, expected, words):
    options = ["--material", material, "--light", SUN, "--error", error, "--size", "16x16"]
    scene = scene_file(tmp_path, baked, error, material)
    found = by_command(tmp_path, baked, *options)
    assert (found.status, found.model, found.cycles) == expected
    assert words in found.budget
    assert (found.unmet == ()) == (found.cycles > 0)
    if found.cycles:
        assert found.iterations == found.cycles
    assert by_engine(tmp_path, baked, *options) == found
    assert by_command(tmp_path, scene) == found
    assert by_engine(tmp_path, scene) == found
    if found.unmet:
        for ways in (by_command, by_engine):
            assert ways(tmp_path, baked, *options, "--strict").status == 3
            assert ways(tmp_path, scene, "--strict").status == 3


def test_a_body_that_is_not_as_it_was_baked_is_left_to_the_estimate(baked, tmp_path):
    changed = [
        {"edits": [{"operation": "multiply", "sigma_a": 2}]},
        {"deformation": [{"type": "twist", "axis": [0, 1, 0], "degrees": 30}]},
    ]
    for change in changed:
        found = by_command(tmp_path, scene_file(tmp_path, baked, 0.3, "skin1", **change))
        assert "at rest and without edits or a normal map: the solve's own estimate decides" in found.budget
        assert found.cycles == 0
    engine = core.Engine(baked)
    engine.set_material("skin1")
    engine.set_lights([SUN])
    assert engine.solve(error=0.05)["cycles"] == 2
    engine.set_vertices(0, engine.graph.levels[0].vertices)
    assert "at rest" in engine.solve(error=0.3)["budget"]


def test_both_command_lines_print_the_same_sentences(baked, tmp_path, capsys):
    for error in ("5%", "0.5%"):
        options = [str(baked), "--material", "skin1", "--light", SUN, "--error", error, "-o", str(tmp_path / "a.png")]
        report = tmp_path / "report.json"
        cli.main(["render", *options, "--size", "16x16", "--json", str(report)])
        printed, written = capsys.readouterr().out, run("--headless", *options, "--size", "16x16").stdout
        solve = json.loads(report.read_text())
        for sentence in [solve["budget"], *solve["unmet"]]:
            assert sentence in printed
            assert sentence in written


def test_without_a_target_the_record_is_not_looked_at(sphere, tmp_path):
    broken = recorded(sphere, tmp_path / "broken.qgraph", {"error": "none"})
    found = by_command(tmp_path, broken, "--size", "16x16")
    assert (found.status, found.budget) == (0, "")


def test_a_broken_record_is_refused_by_both(sphere, tmp_path, capsys):
    broken = recorded(sphere, tmp_path / "broken.qgraph", RECORD | {"trials": [trial("sp3", 0, 1.0, 0.01)]})
    options = [str(broken), "--error", "5%", "-o", str(tmp_path / "a.png")]
    words = "broken.qgraph: metadata: /budget/trials/0/cycles: found 0, allowed is a whole number from 1 to 256"
    assert cli.main(["render", *options]) == 1
    assert words in capsys.readouterr().err
    refused = run("--headless", *options)
    assert refused.returncode == 1
    assert words in refused.stderr
    assert not (tmp_path / "a.png").exists()


def test_both_fail_where_the_finest_level_stops_early(sphere, tmp_path):
    options = ["--light", SUN, "--solver", "cascade", "--max-iterations", 2, "--size", "16x16"]
    found = by_command(tmp_path, sphere, *options)
    assert found.status == 3
    assert [sentence.split(" after ")[0] for sentence in found.unmet] == ["not converged: level 0 stopped"]
    assert by_engine(tmp_path, sphere, *options) == found


def test_a_coarser_level_that_stops_early_fails_no_solve(tmp_path):
    sphere = write_levels(tmp_path / "fine.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    scene = ["--material", "ketchup", "--light", SUN, "--solver", "cascade", "--tolerance", "1%", "--size", "16x16"]
    report = tmp_path / "report.json"
    options = [str(sphere), *scene, "--max-iterations", "48", "-o", str(tmp_path / "a.png"), "--json", str(report)]
    assert cli.main(["render", *options]) == 0
    levels = json.loads(report.read_text())["levels"]
    assert [(level["level"], level["converged"]) for level in levels] == [(1, False), (0, True)]
    assert by_engine(tmp_path, sphere, *scene, "--max-iterations", 48).status == 0
