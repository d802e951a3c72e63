"""Inter-reflection as a user meets it: options, reports, metadata, and a ring that lights itself."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from engine_program import ENGINE
from quadgraph import cli
from quadgraph.baking import pipeline
from shapes import torus, write_obj

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

LIGHT = ["--light", "directional:1,0,0:1", "--material", "sigma_s_prime=1,sigma_a=0.01,eta=1.3"]


@pytest.fixture(scope="module")
def ring(tmp_path_factory) -> dict[str, str]:
    """A ring of two levels with what its faces see, and without."""
    folder = tmp_path_factory.mktemp("ring")
    mesh = write_obj(torus(), folder / "ring.obj")
    paths = {"seeing": folder / "seeing.qgraph", "blind": folder / "blind.qgraph"}
    for name, rays in (("seeing", 64), ("blind", 0)):
        pipeline.bake(mesh, paths[name], pipeline.BakeOptions(unit="mm", levels=2, visibility_rays=rays))
    return {name: str(path) for name, path in paths.items()}


def solved(path: str, tmp_path: Path, *options: str) -> dict:
    """Without the correction, whose rays find for themselves what enters again."""
    report, exactly = tmp_path / "report.json", ["--tolerance", "1e-5", "--no-correction"]
    assert cli.main(["solve", path, *LIGHT, *options, *exactly, "--json", str(report)]) == 0
    return json.loads(report.read_text())


def test_a_ring_lights_itself_and_the_table_says_how_much(ring, tmp_path, capsys):
    report = solved(ring["seeing"], tmp_path, "--validation")
    printed = capsys.readouterr().out
    energy, bounces = report["energy"], np.array(report["bounces"])
    assert report["inter_reflection"]
    assert len(bounces) >= 3
    assert (np.diff(bounces, axis=0) < 0).all()
    assert np.allclose(bounces.sum(axis=0), energy["re_entered"], rtol=1e-4)
    share = np.array(energy["re_entered"]) / energy["entered"]
    assert (share > 0.02).all()
    assert (share < 0.5).all()
    assert np.abs(energy["balance"]).max() < 1e-4
    for words in ("entered again", "bounce 1", f"inter-reflection: {len(bounces)} bounces"):
        assert words in printed


def test_the_options_leave_it_out_or_count_it(ring, tmp_path, capsys):
    off = solved(ring["seeing"], tmp_path, "--no-inter-reflection")
    assert not off["inter_reflection"]
    assert off["bounces"] == []
    assert off["energy"]["re_entered"] == [0, 0, 0]
    assert "inter-reflection: left out\n" in capsys.readouterr().out
    blind = solved(ring["blind"], tmp_path)
    assert not blind["inter_reflection"]
    assert "the file does not say what the faces see" in capsys.readouterr().out
    # Nothing but the light that enters again is different.
    for name in ("entered", "scattered_out", "absorbed", "unscattered_out"):
        assert np.allclose(off["energy"][name], blind["energy"][name], rtol=1e-6)
    assert len(solved(ring["seeing"], tmp_path, "--bounces", "2")["bounces"]) == 2
    published = solved(ring["seeing"], tmp_path, "--method", "quadgraph-fdm", "--source", "diffuse")
    assert not published["inter_reflection"]
    assert "inter-reflection: left out\n" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        cli.main(["solve", ring["seeing"], "--bounces", "-1"])


def test_the_sky_is_hidden_behind_the_ring(ring, tmp_path):
    fields = {}
    for name, path in ring.items():
        fields[name] = tmp_path / f"{name}.npz"
        arguments = ["solve", path, "--light", "ambient:1", "--field", str(fields[name])]
        assert cli.main([*arguments, "--no-inter-reflection"]) == 0
    with np.load(fields["seeing"]) as seeing, np.load(fields["blind"]) as blind:
        share = seeing["q"][:, 0] / blind["q"][:, 0]
        position, normal = blind["position"], blind["normal"]
    inward = (position[:, :2] * normal[:, :2]).sum(axis=1) < 0
    assert share[~inward].min() > 0.8
    assert share[inward].mean() < 0.9
    assert 0.4 < share.min() < share.max() <= 1 + 1e-6


def test_it_is_most_where_no_other_light_comes(ring):
    engine = _core.Engine(ring["seeing"])
    engine.set_material(LIGHT[3])
    engine.set_lights([LIGHT[1]])
    lit = engine.solve(tolerance=1e-5)
    field = engine.surface_field()
    dark = engine.solve(tolerance=1e-5, inter_reflection=False)
    before = engine.surface_field()["exitance"]
    assert lit["inter_reflection"]
    assert not dark["inter_reflection"]
    more = field["exitance"] - before
    assert more.min() > -1e-3 * before.max()
    unlit = field["q"][:, 0] == 0
    gains = [more[part].sum(axis=0) / before[part].sum(axis=0) for part in (unlit, ~unlit)]
    assert (gains[0] > 0.05).all()
    assert (gains[0] > 2 * gains[1]).all()
    again = engine.solve(tolerance=1e-5, bounces=1)
    assert len(again["bounces"]) == 1


def test_the_executable_takes_the_same_options(ring, tmp_path):
    if ENGINE is None:
        pytest.skip("quadgraph-engine is not built: run tools/setup")
    picture = tmp_path / "a.png"
    common = [ENGINE, ring["seeing"], "--headless", "-o", str(picture), "--size", "16x16", *LIGHT, "--json"]
    reports = [
        json.loads(subprocess.run([*common, *more], check=True, capture_output=True, text=True).stdout)
        for more in ([], ["--no-inter-reflection"], ["--bounces", "1"])
    ]
    assert [report["solve"]["inter_reflection"] for report in reports] == [True, False, True]
    assert len(reports[0]["solve"]["bounces_W"]) > 1
    assert len(reports[2]["solve"]["bounces_W"]) == 1
    assert reports[0]["solve"]["energy"]["re_entered_W"][0] > 0
    with Image.open(picture) as image:
        assert "inter-reflection" in image.text
