"""tools/gpu: what it makes of the files of its steps, and what it says of wrong usage."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from quadgraph_validation.benchmark import gpu_record

ROOT = Path(__file__).parents[3]
FIGURES = {
    "frame/light/ms": {"value": 14.0, "unit": "ms", "spread": 0.1, "runs": 20},
    "frame/light/source-walk/ms": {"value": 2.5, "unit": "ms", "spread": 0.1, "runs": 20},
    "frame/light/resolve/ms": {"value": 1.25, "unit": "ms", "spread": 0.1, "runs": 20},
    "frame/light-and-material/ms": {"value": 16.0, "unit": "ms", "spread": 0.1, "runs": 20},
}


@pytest.fixture
def steps(tmp_path):
    """What two rooms of tests, a picture on both devices and a benchmark leave."""
    (tmp_path / "tests-vk.status").write_text("0 2.4\n")
    (tmp_path / "tests-vk.log").write_text("[doctest] test cases:   15 |   15 passed | 0 failed | 0 skipped\n")
    (tmp_path / "tests-solve.status").write_text("1 79.1\n")
    (tmp_path / "tests-solve.log").write_text("[doctest] test cases:   80 |   79 passed | 1 failed | 0 skipped\n")
    (tmp_path / "tests-path.status").write_text("124 240.0\n")
    (tmp_path / "tests-path.log").write_text("killed\n")
    grey = np.full((4, 4, 3), 100, np.uint8)
    Image.fromarray(grey).save(tmp_path / "cpu.png")
    grey[0, 0, 0] = 104
    Image.fromarray(grey).save(tmp_path / "gpu.png")
    live = {"device": "Card", "driver": "1.2", "copy": {"gb_per_s": 500.0}, "commit": "abc", "figures": FIGURES}
    (tmp_path / "live.json").write_text(json.dumps(live))
    return tmp_path


def test_the_record_has_all_steps_and_says_what_failed(steps):
    found = gpu_record.record(steps)
    assert found["schema"] == "quadgraph-gpu/1"
    assert found["device"] == "Card"
    assert found["tests"]["tests-vk"] == {"exit_status": 0, "seconds": 2.4, "cases": 15, "passed": 15, "failed": 0}
    assert found["tests"]["tests-solve"]["failed"] == 1
    assert found["tests"]["tests-path"] == {"exit_status": 124, "seconds": 240.0}
    assert found["picture"]["most"] == 4
    assert found["picture"]["rms"] == pytest.approx(4 / 100 / np.sqrt(48))
    assert found["figures"]["live"] == FIGURES


def test_the_summary_adds_up_the_passes_of_a_frame(steps):
    lines = gpu_record.summary(gpu_record.record(steps))
    assert "tests-solve: exit status 1, 79 of 80" in lines
    assert "tests-path: exit status 124, 0 of 0" in lines
    assert "live: frame/light/ms: 14 ms by the clock, 3.75 ms of passes" in lines
    assert "live: frame/light-and-material/ms: 16 ms by the clock, 0 ms of passes" in lines


def test_a_failed_test_fails_the_record(steps, monkeypatch):
    monkeypatch.setattr("sys.argv", ["gpu_record", "summary", str(steps)])
    assert gpu_record.main() == 1
    (steps / "tests-solve.status").write_text("0 79.1\n")
    (steps / "tests-path.status").write_text("0 1.0\n")
    assert gpu_record.main() == 0
    assert json.loads((steps / "gpu.json").read_text())["tests"]["tests-solve"]["exit_status"] == 0


@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (["--what"], 2, "usage: tools/gpu"),
        (["--device"], 2, "usage: tools/gpu"),
        (["pack"], 2, "usage: tools/gpu"),
        (["--bodies", "nowhere"], 1, "nowhere/bunny.qgraph: no such file: tools/demo bakes"),
    ],
)
def test_wrong_usage_is_said(arguments, status, said):
    run = subprocess.run([ROOT / "tools" / "gpu", *arguments], capture_output=True, text=True, check=False)
    assert run.returncode == status
    assert said in run.stderr
