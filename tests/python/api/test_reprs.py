"""What values say of themselves: a short line with numbers and units, and a table of a solve in notebooks."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import numpy as np
import pytest

import quadgraph
from grids import PATH as POLYGRID
from quadgraph import core
from quadgraph.api.reprs import UNITS
from tiny import PATH as CUBE

SUN = quadgraph.DirectionalLight(direction=(0, 0, 1), irradiance=(2.5, 2, 1.5))


class Texts(HTMLParser):
    """The rows of the tables of a document, and all of its text."""

    def __init__(self, document: str) -> None:
        super().__init__()
        self.rows, self.text = [], ""
        self.feed(document)

    def handle_starttag(self, tag, attrs):
        if tag == "tr":
            self.rows.append([])

    def handle_data(self, data):
        self.text += data
        if self.rows:
            self.rows[-1].append(data)


@pytest.mark.parametrize(
    ("value", "line"),
    [
        (SUN, "DirectionalLight(direction=(0, 0, 1), irradiance=(2.5, 2, 1.5) W/mm^2)"),
        (quadgraph.PointLight((1, 2, 3), 40), "PointLight(position=(1, 2, 3) mm, power=40 W)"),
        (quadgraph.Material(2, np.float32(0.01)), "Material(sigma_s_prime=2 1/mm, sigma_a=0.01 1/mm, eta=1.3)"),
        (
            quadgraph.VolumeMaterial(np.ones((2, 3, 4)), np.full((2, 3, 4), 0.1), 0.5),
            "VolumeMaterial(4 x 3 x 2 cells of 0.5 mm, sigma_s_prime=1 to 1 1/mm, sigma_a=0.1 to 0.1 1/mm, eta=1.3)",
        ),
        (quadgraph.Bend(30, towards=(1, 0, 0)), "Bend(degrees=30, towards=(1, 0, 0))"),
        (
            quadgraph.Lattice((5, 5, 5), np.zeros((125, 3)), box={"low": (0, 0, 0), "high": (1, 1, 1.5)}),
            "Lattice(size=(5, 5, 5), displacements=array of 125 x 3 mm, box={low: (0, 0, 0), high: (1, 1, 1.5)})",
        ),
        (quadgraph.Cage([[0, 0, 0], [1]], [], []), "Cage(cage=2 rows mm, moved=() mm, triangles=())"),
    ],
)
def test_a_value_is_one_line_with_units(value, line):
    assert repr(value) == line


def test_units_of_lights_are_the_engines():
    for kind in core.light_kinds():
        for field in kind.fields:
            assert UNITS.get(field.name, "") == field.unit, f"{kind.name}, {field.name}"


@pytest.fixture(scope="module")
def solved():
    """An engine after a solve."""
    with quadgraph.Engine(POLYGRID) as engine:
        engine.material, engine.lights = "wax", [SUN]
        engine.solve(method="fem", correction=False)
        yield engine


def test_an_engine_says_what_it_holds(solved):
    line = repr(solved)
    assert re.fullmatch(
        r"Engine\(polygrid.qgraph: [\d.]+ x [\d.]+ x [\d.]+ mm, \d+ tets, 2 levels, material wax, 1 light, "
        r"solved by fem; .+\)",
        line,
    ), line
    assert solved.device in line
    with quadgraph.Engine(CUBE) as other:
        other.material = quadgraph.Material(1, 1)
        assert "2 x 2 x 2 mm, 24 tets, 2 levels, a Material, 3 lights;" in repr(other)
    assert repr(other) == "Engine(tiny.qgraph, closed)"


def test_a_stage_says_what_it_shows():
    with quadgraph.Stage() as stage:
        assert repr(stage) == "Stage(no scene is shown)"
        stage.show(quadgraph.Scene(CUBE, "wax"))
        assert repr(stage).startswith("Stage(Engine(tiny.qgraph: 2 x 2 x 2 mm")
    assert repr(stage) == "Stage(closed)"


def test_results_say_their_size_and_range(solved):
    surface, fluence = solved.surface(), solved.fluence()
    mean = (surface.exitance * surface.area[:, None]).sum(axis=0) / surface.area.sum()
    line = repr(surface)
    assert line.startswith(f"SurfaceField({len(surface.area)} faces, {surface.area.sum():.4g} mm^2, exitance (")
    assert f"({', '.join(f'{each:.4g}' for each in mean)}) W/mm^2 on average" in line
    assert repr(fluence) == (
        f"Fluence({len(fluence.points)} points, {fluence.values.min():.4g} to {fluence.values.max():.4g} W/mm^2)"
    )
    picture = solved.render(width=20, height=10)
    assert re.fullmatch(r"Picture\(20 x 10 pixels, \d+% of them the body\)", repr(picture))
    assert picture._repr_png_().startswith(b"\x89PNG\r\n")


def test_a_solution_is_a_line_and_a_table(solved):
    solution = solved.solution
    energy = solution.energy
    line = repr(solution)
    assert "\n" not in line
    assert len(line) < 300
    assert line.startswith(f"Solution(fem / {solution.model} / buried / {solution.solver}: ")
    absorbed = [f"{each:.4g}" for each in energy.absorbed]
    assert f"({', '.join(absorbed)}) W absorbed" in line
    assert f"error {100 * solution.error.whole:.2g}%" in line
    shown = Texts(solution._repr_html_())
    assert shown.rows[0] == ["red", "green", "blue"]
    assert ["absorbed, W", *absorbed] in shown.rows
    assert [row[0] for row in shown.rows[1:]] == [
        "entered, W",
        "scattered out, W",
        "absorbed, W",
        "unscattered out, W",
        "balance",
    ]
    assert solution.advice in shown.text
    assert repr(energy).startswith("Energy(entered=(")
    assert repr(solution.error) == (
        f"ErrorEstimate(whole={100 * solution.error.whole:.2g}%, unlit={100 * solution.error.unlit:.2g}%, "
        f"dimmest={100 * solution.error.dimmest:.2g}%)"
    )


def test_what_is_said_against_an_answer_is_in_both(solved):
    with quadgraph.Engine(POLYGRID) as engine:
        engine.material, engine.lights = "wax", [SUN]
        solution = engine.solve(method="fem", solver="jacobi", max_iterations=2, correction=False)
    assert not solution.converged
    assert repr(solution).endswith(", not converged)")
    assert solution.stopped in Texts(solution._repr_html_()).text


def test_shortest_paths_have_no_powers():
    with quadgraph.Engine(CUBE) as engine:
        engine.material = "wax"
        solution = engine.solve(method="shortest-path", path={"cells": 10})
    words = f"{solution.path.solid:,} voxels of {solution.path.cell:.3g} mm in the body"
    assert repr(solution).startswith(f"Solution(shortest-path: {words}")
    shown = Texts(solution._repr_html_())
    assert shown.rows == []
    assert words in shown.text
