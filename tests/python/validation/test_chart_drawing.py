"""The chart from its record: the front, the same bytes again, readable labels, and refusals."""

from __future__ import annotations

import json
import sys
from itertools import combinations

import numpy as np
import pytest
from PIL import Image

from chart_records import FAMILIES, record
from quadgraph import cli
from quadgraph_validation.chart import chart_page, labels, static_chart
from quadgraph_validation.chart import chart_record as records
from quadgraph_validation.chart.pareto import front


@pytest.fixture
def record_path(tmp_path):
    path = tmp_path / "chart.json"
    path.write_text(json.dumps(record()))
    return path


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """The folder of the record's charts and page."""
    folder = tmp_path_factory.mktemp("drawn")
    static_chart.write(folder, record())
    chart_page.write(folder / "chart.html", record())
    return folder


def test_the_front_holds_exactly_what_nothing_beats():
    generator = np.random.default_rng(1)
    for _ in range(50):
        points = [tuple(pair) for pair in generator.integers(1, 12, (20, 2)).astype(float)]
        found = {points[i] for i in front(points)}
        expected = {p for p in points if not any(q[0] <= p[0] and q[1] <= p[1] and q != p for q in points)}
        assert found == expected
        assert len(front(points)) == len(found)


@pytest.mark.long
def test_a_record_is_drawn_again_the_same_to_the_byte_without_a_device(drawn, record_path, tmp_path, monkeypatch):
    again = tmp_path / "again"
    monkeypatch.setitem(sys.modules, "quadgraph._core", None)
    assert cli.main(["chart", "--from", str(record_path), "--output", str(again)]) == 0
    names = [[path.name for path in sorted(folder.iterdir())] for folder in (drawn, again)]
    forms = [f"chart-{scene}.{form}" for scene in ("bunny", "sphere") for form in ("png", "svg")]
    assert names[0] == names[1] == sorted([*forms, "chart.html"])
    for name in names[0]:
        assert (drawn / name).read_bytes() == (again / name).read_bytes(), name
    changed = record(("bunny",))
    changed["scenes"][0]["points"][0]["ms"] *= 2
    static_chart.write(tmp_path / "changed", changed)
    assert (tmp_path / "changed" / "chart-bunny.png").read_bytes() != (drawn / "chart-bunny.png").read_bytes()


def test_the_committed_record_can_be_drawn_and_says_what_the_readme_does(request):
    found = records.read(request.config.rootpath / "docs" / "benchmarks" / "chart.json")
    (scene,) = [scene for scene in found["scenes"] if scene["name"] == "bunny"]
    points = {point["name"]: point for point in scene["points"]}
    published = points["quadgraph-fdm, as published · default bake · level 0 · cascade"]
    ours = points["fem, SP₃, inter-reflection · default bake · level 0 · fmg-pcg · 1 cycle a frame"]
    assert ours["ms"] < published["ms"]
    for part, times in (("whole", 16), ("unlit", 17)):
        assert times * ours["errors"]["transport"][part] < published["errors"]["transport"][part]
    dipoles = [point for point in scene["points"] if point["family"] == "dipole per vertex"]
    for part, least in (("whole", 0.17), ("unlit", 0.57)):
        assert min(point["errors"]["transport"][part] for point in dipoles) > least


# Rows of docs/methods.md, to the names of their points.
ROWS = {
    "`fem`, SP₃, one cycle": "fem, SP₃ · level 0 · fmg-pcg · 1 cycle a frame",
    "`quadgraph-fv`, SP₃": "quadgraph-fv, SP₃ · level 0 · dpcg",
    "`quadgraph-fdm`, as published": "quadgraph-fdm, as published · level 0 · cascade",
    "`polygrid`, as published": "polygrid, as published · polygrid · level 0 · cascade",
    "`polygrid-divergence`": "polygrid-divergence, diffusion · polygrid · level 0 · cascade",
    "`shortest-path`, transport cost": "shortest-path · transport · eikonal · 64 cells",
    "`shortest-path`, as published": "shortest-path · extinction · lattice · 64 cells",
    "dipole, a quarter of the vertices": "dipole per vertex · level 1 · numpy",
}


def test_the_page_on_methods_says_what_the_record_does(request):
    docs = request.config.rootpath / "docs"
    scenes = {scene["name"]: scene for scene in records.read(docs / "benchmarks" / "chart.json")["scenes"]}
    lines = (docs / "methods.md").read_text().splitlines()
    for row, name in ROWS.items():
        (line,) = [line for line in lines if line.startswith(f"| {row} | ")]
        cells = [cell.strip() for cell in line.split("|")[2:-1]]
        for index, scene in enumerate(("sphere", "bunny")):
            (point,) = [point for point in scenes[scene]["points"] if point["name"] == name]
            for cell, truth in zip(cells[3 * index :], ("pde", "transport"), strict=False):
                errors = point["errors"][truth]
                told = " / ".join(f"{100 * errors[part]:.3g}%" for part in records.PARTS) if errors else "\N{EN DASH}"
                assert cell == told, (row, scene, truth)


# Columns of the table of scenes in docs/chart.md.
COLUMNS = (
    "dipole per vertex · level 1 · numpy",
    "quadgraph-fdm, as published · default bake · level 0 · cascade",
    "polygrid, as published · polygrid · level 0 · cascade",
    "polygrid-divergence, diffusion · polygrid · level 0 · cascade",
    "shortest-path · transport · eikonal · 64 cells",
    "fem, SP₃, inter-reflection · default bake · level 0 · fmg-pcg · 1 cycle a frame",
)


def test_the_page_on_the_chart_says_what_the_record_does(request):
    docs = request.config.rootpath / "docs"
    lines = (docs / "chart.md").read_text().splitlines()
    for scene in records.read(docs / "benchmarks" / "chart.json")["scenes"]:
        measured = [point for point in scene["points"] if "failed" not in point]
        points = {point["name"]: point["errors"]["transport"] for point in measured}
        (line,) = [line for line in lines if line.split(",")[0].split(" |")[0] == f"| {scene['name']}"]
        told = [cell.strip() for cell in line.split("|")[2:-1]]
        found = [[points[name].get(part) for part in records.PARTS] for name in COLUMNS]
        assert told == [" / ".join(f"{100 * error:.3g}%" for error in errors if error) for errors in found]


# Rows of the table of flicker and lag in docs/chart.md, to the names of their points.
MOVING = {
    "SP₃, inter-reflection, one cycle, chain": "fem, SP₃, inter-reflection · level 0 · fmg-pcg · 1 cycle a frame",
    "SP₃, inter-reflection, one cycle, default bake": COLUMNS[-1],
    "corrected in motion, chain": "fem, SP₃, inter-reflection, corrected · level 0 · fmg-pcg · in motion",
    "corrected in motion, default bake": (
        "fem, SP₃, inter-reflection, corrected · default bake · level 0 · fmg-pcg · in motion"
    ),
    "path tracing, 1 sample a pixel": "path tracing · 1 sample a pixel",
    "path tracing, 4 samples a pixel": "path tracing · 4 samples a pixel",
    "15 scatterings at most, 1 sample a pixel": "path tracing, 15 scatterings at most · 1 sample a pixel",
    "15 scatterings at most, 4 samples a pixel": "path tracing, 15 scatterings at most · 4 samples a pixel",
}


def test_the_page_on_the_chart_says_how_steady_frames_are(request):
    docs = request.config.rootpath / "docs"
    lines = (docs / "chart.md").read_text().splitlines()
    (scene,) = [one for one in records.read(docs / "benchmarks" / "chart.json")["scenes"] if one["name"] == "bunny"]
    points = {point["name"]: point for point in scene["points"]}
    for words, name in MOVING.items():
        point = points[name]
        errors = " / ".join(f"{100 * point['errors']['transport'][part]:.3g}%" for part in records.PARTS)
        cells = (f"{point['ms']:,.0f}", errors, records.flicker_text(point), records.lag_text(point))
        assert f"| {words} | {' | '.join(cells)} |" in lines
    as_long = ("path tracing, 4 samples a pixel", "corrected in motion, default bake")
    traced, ours = (points[MOVING[words]]["motion"]["flicker"] for words in as_long)
    assert traced > 10 * ours


def test_the_picture_has_four_panels_at_the_width_of_the_readme(drawn):
    assert [panel.part for panel in records.panels(record()["scenes"][0])] == ["whole", "unlit"] * 2
    width, height = Image.open(drawn / "chart-bunny.png").size
    assert 1200 <= width <= 1800
    assert 700 <= height <= 1400
    assert (drawn / "chart-bunny.png").stat().st_size < 300_000


def test_flicker_and_lag_are_columns_and_a_panel(drawn, record_path, tmp_path, capsys):
    moving = record(("bunny",))
    lag = {"light": {"frames": 0.5, "error": 0.1}, "camera": {"frames": -0.01, "error": 0.02}}
    for point, flicker in zip(moving["scenes"][0]["points"], (0.013, 0.0, 0.2), strict=False):
        point["motion"] = {"flicker": flicker, "lag": lag}
    last = records.panels(moving["scenes"][0])[-1]
    assert last.title.startswith("in motion: flicker")
    assert last.errors == [0.2, 0.013]  # by time; on a scale of decades there is no 0
    assert last.front == [0, 1]
    static_chart.write(tmp_path, moving)
    sizes = [Image.open(folder / "chart-bunny.png").size for folder in (drawn, tmp_path)]
    assert sizes[0][0] == sizes[1][0]
    assert sizes[0][1] < sizes[1][1]
    record_path.write_text(json.dumps(moving))
    assert cli.main(["chart", "--from", str(record_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert sum("0.50 ± 0.10 / -0.01 ± 0.02" in line for line in lines) == 3
    assert sum(" 1.3% " in line for line in lines) == 1


def test_labels_cover_neither_each_other_nor_points():
    from matplotlib import pyplot

    figure, axis = pyplot.subplots(figsize=(6, 4))
    generator = np.random.default_rng(2)
    x, y = 10 ** generator.uniform(0, 2, 14), 10 ** generator.uniform(-3, 0, 14)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.scatter(x, y, 40)
    axis.set_xlim(0.5, 300)
    axis.set_ylim(5e-4, 2)
    figure.canvas.draw()
    labels.place(axis, [(x[i], y[i], f"a method of level {i}", "black") for i in range(6)])
    renderer = figure.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in axis.texts]
    assert len(boxes) == 6
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))
    places = axis.transData.transform(np.column_stack([x, y]))
    assert not any(box.contains(*place) for box in boxes for place in places)
    pyplot.close(figure)


def test_tables_tell_times_errors_the_best_and_what_failed(record_path, capsys):
    assert cli.main(["chart", "--from", str(record_path)]) == 0
    out = capsys.readouterr().out
    assert "does not converge" in out
    rows = [line for line in out.splitlines() if f"{FAMILIES[0]} · level 0 · fmg-pcg  " in line]
    assert len(rows) == 2
    assert all(text in rows[0] for text in ("40", "1%*", "3%*", "5%*"))
    slower = next(line for line in out.splitlines() if f"{FAMILIES[3]} · level 0" in line)
    assert "*" not in slower


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda r: r.pop("scenes"), "scenes: not there"),
        (lambda r: r.update(format=7), "format: 7 found, 3 allowed"),
        (lambda r: r["scenes"][0]["points"][0].pop("errors"), "scenes: KeyError of 'errors'"),
        (lambda r: r["scenes"][1].pop("run"), "scenes: KeyError of 'run'"),
    ],
)
def test_what_is_no_record_is_refused_with_its_field(record_path, change, message, capsys):
    wrong = record()
    change(wrong)
    record_path.write_text(json.dumps(wrong))
    assert cli.main(["chart", "--from", str(record_path)]) == 1
    assert message in capsys.readouterr().err


def test_options_that_a_record_has_decided_are_refused(record_path, tmp_path, capsys):
    assert cli.main(["chart", "--from", str(record_path), "--scene", "bunny"]) == 1
    assert "--from draws a record as it is" in capsys.readouterr().err
    record_path.write_text("{")
    assert cli.main(["chart", "--from", str(record_path)]) == 1
    assert "cannot be read as JSON" in capsys.readouterr().err
