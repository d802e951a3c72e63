"""`quadgraph bench` as a user runs it: what is printed and what the record holds."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import pymeshlab
import pytest

from baked import write_levels
from quadgraph import cli
from quadgraph_validation.benchmark import figures, forecast, scaling
from quadgraph_validation.benchmark.bench_scene import Device
from quadgraph_validation.benchmark.frame_passes import METHODS
from quadgraph_validation.benchmark.solver_convergence import TARGETS, WAYS
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

TINY = str(Path(__file__).parents[2] / "data" / "tiny.qgraph")


@pytest.fixture(scope="module")
def sphere(tmp_path_factory):
    """A sphere of two levels, radius 10 mm."""
    path = tmp_path_factory.mktemp("bench") / "sphere.qgraph"
    return str(write_levels(path, [icosphere(2, 10), icosphere(1, 10)]))


def bench(tmp_path, *arguments: str) -> dict:
    """Run and return the record."""
    path = tmp_path / "record.json"
    assert cli.main(["bench", *arguments, "--repeats", "1", "--json", str(path)]) == 0
    record = json.loads(path.read_text())
    assert record["figures"] == figures.of(record)
    assert all(figure["runs"] == 1 for figure in record["figures"].values())
    assert all(record[key] for key in ("device", "driver", "commit", "version", "cores"))
    return record


def test_a_run_ends_in_a_line_that_can_be_compared(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("quadgraph_validation.benchmark.frame_passes.METHODS", METHODS[:1])
    path = tmp_path / "record.json"
    assert cli.main(["bench", TINY, "--passes", "--live", "--repeats", "3", "--json", str(path)]) == 0
    printed = capsys.readouterr().out
    ended = json.loads(printed.splitlines()[-1])
    assert ended["schema"] == figures.SCHEMA
    assert all(ended[key] for key in ("commit", "device", "driver", "cores"))
    assert ended["figures"] == json.loads(path.read_text())["figures"]
    assert {"frame/light/ms", "passes/fem/diffusion/buried/fmg-pcg/ms"} <= set(ended["figures"])
    for name, figure in ended["figures"].items():
        assert figure["value"] >= 0
        assert figure["runs"] == (3 if figure["unit"] == "ms" else 1), name
    whole = ended["figures"]["frame/light/ms"]
    assert whole["value"] > 0
    assert whole["spread"] is not None
    (tmp_path / "printed.txt").write_text(printed)
    assert cli.main(["bench", "--compare", str(path), str(tmp_path / "printed.txt")]) == 0
    assert f"{len(ended['figures'])} figures: 0 slower, 0 faster" in capsys.readouterr().out


def test_passes_have_time_bytes_and_a_share_of_copying_in_both_orders(sphere, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("quadgraph_validation.benchmark.frame_passes.METHODS", METHODS[:2])
    record = bench(tmp_path, sphere, "--passes", "--random-order", sphere)
    assert len(record["passes"]) == 2
    assert "passes/fem/sp3/buried/fmg-pcg/random-order/assembly/ms" in record["figures"]
    assert {entry["model"] for entry in record["passes"]} == {"diffusion", "sp3"}
    for method in record["passes"]:
        assert {"assembly", "shadow maps"} <= {entry["name"] for entry in method["passes"]}
        for entry in method["passes"] + method["random_order_passes"]:
            assert entry["time_ms"] >= 0
            assert entry["bytes"] > 0
            assert entry["copy_share"] * record["copy"]["gb_per_s"] == pytest.approx(entry["gb_per_s"])
    printed = capsys.readouterr().out
    for words in ("in blocks, and at random", "of copying", "cost of a solution", record["device"]):
        assert words in printed


def test_a_forecast_adds_up_what_passes_move_and_what_dispatches_cost(sphere, tmp_path, capsys):
    kinds = bench(tmp_path, sphere, "--live", "--forecast", "100,5")["live"]["kinds"]
    said = capsys.readouterr().out
    for kind in kinds:
        found = kind["forecast"]
        assert found["moving_ms"] == pytest.approx(sum(entry["bytes"] for entry in kind["passes"]) / 1e8)
        assert found["dispatching_ms"] == pytest.approx(5e-3 * sum(entry["count"] for entry in kind["passes"]))
        assert found["ms"] == pytest.approx(found["moving_ms"] + found["dispatching_ms"])
        assert f"{kind['changes']} changing: at least" in " ".join(said.split())
    walked = forecast.parse("100,5,0.001").of(kinds[0])
    assert walked["moving_ms"] >= kinds[0]["walk_segments"] > kinds[0]["forecast"]["moving_ms"]  # a tet a millisecond
    for text in ("100", "0,3", "100,x", "1,2,3,4", "-1,2"):
        with pytest.raises(SystemExit):
            cli.main(["bench", sphere, "--live", f"--forecast={text}"])
        assert "allowed is GB/S,US or GB/S,US,M" in capsys.readouterr().err
    assert cli.main(["bench", sphere, "--passes", "--forecast", "100,5"]) == 1
    assert "--forecast belongs to --live, which is absent" in capsys.readouterr().err


def test_live_frames_do_more_the_more_changes(sphere, tmp_path, capsys):
    live = bench(tmp_path, sphere, "--live")["live"]
    names = [{entry["name"] for entry in kind["passes"]} for kind in live["kinds"]]
    assert "source walk" in names[0]
    assert "assembly" not in names[0]
    assert "assembly" in names[1]
    assert names[0] < names[1] < names[2]
    assert all(kind["wall_ms"] >= sum(entry["time_ms"] for entry in kind["passes"]) > 0 for kind in live["kinds"])
    for kind in live["kinds"]:
        assert 0 < kind["off"]["median"] <= kind["off"]["most"] < 0.1
        assert kind["off"]["rms"] < 0.03
        assert kind["walk_segments_per_s"] > 1e4
    printed = " ".join(capsys.readouterr().out.split())
    assert "light, material and shape changing" in printed
    assert "off by" in printed
    assert "million tets a second" in printed


def test_a_frame_has_the_pixels_that_are_asked_for(sphere, tmp_path, capsys):
    live = [bench(tmp_path, sphere, "--live", "--side", side)["live"] for side in ("32", "64", "128")]
    small, middle, large = (
        next(each["bytes"] for each in found["kinds"][0]["passes"] if each["name"] == "shading") for found in live
    )
    assert [found["side"] for found in live] == [32, 64, 128]
    assert large - middle == 4 * (middle - small) > 0  # beside those of the mesh
    assert cli.main(["bench", sphere, "--side", "64"]) == 1
    assert "--side belongs to --live, which is absent" in capsys.readouterr().err


def test_solvers_have_curves_and_targets_and_are_drawn(sphere, tmp_path, capsys):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install './python/validation[bench]'")
    record = bench(tmp_path, sphere, "--solvers", "--chart", str(tmp_path / "images"))
    (scene,) = record["solvers"]
    assert {f"solvers/sphere/fmg-pcg/0.1%/{what}" for what in ("work", "ms", "wall/ms")} <= set(record["figures"])
    assert [way["name"] for way in scene["ways"]] == [way.label for way in WAYS]
    for way in scene["ways"]:
        for before, after in pairwise(way["points"]):
            assert before["work"] < after["work"]
            assert before["unlit"] > after["unlit"]
        assert [entry["unlit"] for entry in way["targets"]] == list(TARGETS)
        for entry in way["targets"]:
            assert entry["reached"]["unlit"] <= entry["unlit"]
            assert entry["reached"]["wall_ms"] >= 0.9 * entry["reached"]["time_ms"] > 0
    printed = capsys.readouterr().out
    for words in (*(way.label for way in WAYS), "error-work.png", "error-time.png"):
        assert words in printed


def test_rivals_are_beside_ours(sphere, tmp_path, capsys):
    pytest.importorskip("pyamg", reason="pyamg is not installed: pip install './python/validation[bench]'")
    record = bench(tmp_path, sphere, "--rivals")
    (scene,) = record["rivals"]
    expected = {"rivals/sphere/1%/ours/fmg-pcg/ms", "rivals/sphere/1%/pyamg-+-cg/error/ms"}
    assert expected <= set(record["figures"])
    assert scene["agreement"]["whole"] < 1e-3
    assert {"fmg-pcg", "dpcg"} <= set(scene["targets"][0]["ours"])
    assert "PyAMG" in capsys.readouterr().out


def cycles(record: dict) -> dict[str, list[int]]:
    """Per model, to the tolerance, of every size."""
    return {model: [body["models"][model]["cycles"] for body in record["bodies"]] for model in scaling.MODELS}


@pytest.fixture
def smaller_bunny(tmp_path, monkeypatch):
    """Of 9,000 vertices instead of 28,000: sooner read and simplified."""
    path, meshes = tmp_path / "bunny.ply", pymeshlab.MeshSet()
    meshes.load_new_mesh(str(scaling.bunny_mesh()))
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=18_000, preservetopology=True)
    meshes.save_current_mesh(str(path))
    monkeypatch.setattr(scaling, "bunny_mesh", lambda: path)


@pytest.mark.long
def test_cycles_do_not_depend_on_the_size(smaller_bunny, tmp_path):
    made = bench(tmp_path, "--scaling", "--sizes", "500,1800,4800", "--bodies", str(tmp_path / "bodies"))
    assert {"scaling/sp3/4800/cycles", "scaling/diffusion/500/ms"} <= set(made["figures"])
    record = made["scaling"]
    assert len(list((tmp_path / "bodies").glob("*.qgraph"))) == 3
    sizes = [body["tets"] for body in record["bodies"]]
    assert sizes[0] < 4000
    assert sizes[-1] > 40_000
    for counts in cycles(record).values():
        assert max(counts) - min(counts) <= 2  # one more or less than a middle value


@pytest.mark.long
def test_cycles_do_not_depend_on_the_size_and_time_is_linear_up_to_two_million_tets(tmp_path):
    record = scaling.run(tmp_path, scaling.SURFACE_VERTICES, Device(), 3, print)
    assert record["bodies"][-1]["tets"] > 1.9e6
    for counts in cycles(record).values():
        assert max(counts) - min(counts) <= 2  # one more or less than a middle value
    for exponent in record["exponents"].values():
        assert exponent <= 1.05
