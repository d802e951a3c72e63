"""`--converge` on both command lines: what is told, written and reported, and how the programs end."""

from __future__ import annotations

import contextlib
import io
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import tiny
from engine_program import ENGINE
from quadgraph import cli

LOOK = ["--material", "sigma_s_prime=.4,sigma_a=.05,eta=1.3", "--light", "directional:-1,0,0:3", "--size", "32x32"]
QUICK = ["--sweep-points", "300", "--samples", "4"]


def rendered(folder, *arguments: str) -> tuple[int, dict]:
    report = folder / "report.json"
    status = cli.main(["render", str(tiny.PATH), *LOOK, *QUICK, *arguments, "--json", str(report)])
    return status, json.loads(report.read_text())


def test_what_is_reached_ends_well_and_is_told_step_by_step(tmp_path, capsys):
    _, plain = rendered(tmp_path, "-o", str(tmp_path / "plain.png"))
    assert plain["convergence"] is None
    status, report = rendered(tmp_path, "-o", str(tmp_path / "once.png"), "--converge", "90%")
    assert status == 0
    assert report["convergence"]["reached"]
    assert "converge: 1 solve of" in capsys.readouterr().err


@pytest.fixture(scope="module")
def not_reached(tmp_path_factory) -> tuple[Path, int, dict, str, str]:
    """The picture of an error that cannot be reached, exit code, report, and what was printed, out and err."""
    folder = tmp_path_factory.mktemp("mean")
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status, report = rendered(folder, "-o", str(folder / "mean.exr"), "--converge", "0.1%", "--device", "cpu")
    return folder / "mean.exr", status, report, out.getvalue(), err.getvalue()


def test_what_is_not_reached_ends_with_3_and_is_written_with_its_noise(not_reached):
    picture, status, report, out, err = not_reached
    assert status == 3
    found = report["convergence"]
    assert not found["reached"]
    assert report["picture_error"] == found["steps"][-1]["error"]
    assert err.count("converge: ") == len(found["steps"])
    assert f"warning: converge 0.1%: {found['limit']}" in out
    written = picture.read_bytes()
    assert all(f"standard_error.{channel}\0".encode() in written for channel in "RGB")
    assert f"mean of {found['steps'][-1]['solves']} solves".encode() in written


@pytest.mark.skipif(ENGINE is None, reason="quadgraph-engine is not built: run tools/setup")
def test_the_engine_without_python_does_the_same(tmp_path, not_reached):
    report = not_reached[2]
    command = [str(ENGINE), str(tiny.PATH), "--headless", "--json", "--device", "cpu", *LOOK, *QUICK]
    done = subprocess.run(
        [*command, "--converge", "0.1%", "-o", str(tmp_path / "other.exr")], capture_output=True, text=True
    )
    assert done.returncode == 3
    theirs = json.loads(done.stdout)["convergence"]
    errors, others = ([step["error"]["whole"] for step in each["steps"]] for each in (report["convergence"], theirs))
    assert np.allclose(errors, others, rtol=1e-3)
    assert done.stderr.count("samples: error") == len(errors)
    assert theirs["limit"] == report["convergence"]["limit"]
