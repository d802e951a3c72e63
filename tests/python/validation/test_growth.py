"""What bakes and acquisitions cost, by size, lights and workers."""

from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console

from quadgraph_validation.benchmark import bench_tables, growth
from quadgraph_validation.bodies import unseen_bodies
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


def costs(sizes, power):
    return [
        {"surface_vertices": n, "tets": 8 * n, "lights": 2, "cpu_s": n**power, "peak_bytes": 1e3 * n, "steps": 5}
        | {"file_bytes": 100 * n}
        for n in sizes
    ]


def test_one_odd_body_decides_no_power():
    bakes = costs((1000, 2000, 5000, 10_000, 20_000), 1.2)
    bakes[2]["cpu_s"] *= 10
    found = {"bakes": bakes, "acquisitions": costs((500, 900), 0.8)}
    assert growth.exponents(found)["bake_s"] == pytest.approx(1.2, abs=1e-9)


def test_powers_are_those_of_the_costs():
    found = {"bakes": costs((1000, 5000, 20_000), 1.2), "acquisitions": costs((500, 900), 0.8)}
    found["acquisitions"].append(found["acquisitions"][0] | {"lights": 4, "cpu_s": 1e9})
    powers = growth.exponents(found)
    assert powers == pytest.approx({"bake_s": 1.2, "bake_bytes": 1.0, "acquire_step_s": 0.8})
    record = found | {"workers": [{"workers": 2, "bodies_an_hour": 77.0}], "exponents": powers}
    console = Console(record=True, width=150, file=io.StringIO())
    for table in bench_tables.growth(record):
        console.print(table)
    said = console.export_text()
    assert "160,000" in said
    assert "as tets to the power 1.20 (s), 1.00 (memory)" in said


@pytest.mark.parametrize("lights", growth.LIGHTS)
def test_every_lamp_shines_on_the_body(lights):
    lamps = growth._scene(lights)["lights"]
    assert len(lamps) == lights
    for lamp in lamps:
        centre, u, v = (np.array(lamp[name]) for name in ("centre", "u", "v"))
        way = np.cross(u, v)
        assert way @ -centre == pytest.approx(np.linalg.norm(way) * np.linalg.norm(centre), rel=1e-4)


def test_a_bake_says_what_it_took(tmp_path, monkeypatch):
    monkeypatch.setattr(growth, "bunny_mesh", lambda: tmp_path / "ball.ply")
    unseen_bodies.write(tmp_path / "ball.ply", icosphere(2, 10.0))
    found = growth.bake_cost(str(tmp_path), 60)
    assert found["tets"] > 50
    assert found["cpu_s"] > 0
    assert found["peak_bytes"] > 10**7
    assert found["file_bytes"] == (tmp_path / "growth-60.qgraph").stat().st_size
