"""What is on devices is counted, and a test that leaves something there fails."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from leaks import left_behind
from quadgraph.base import errors

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

HERE = Path(__file__).resolve().parent
TINY = HERE.parent / "data" / "tiny.qgraph"
TESTS = """
import pytest
from quadgraph import _core

kept = []

@pytest.fixture(scope="module")
def shared():
    return _core.Engine({tiny!r})

@pytest.fixture
def own():
    yield _core.Engine({tiny!r})

def test_uses_a_shared_one(shared):
    shared.set_material("marble")

def test_drops_its_own(shared):
    _core.Engine({tiny!r})

def test_has_one_from_a_fixture(own):
    own.set_material("marble")

def test_drops_a_circle(shared):
    circle = [_core.Engine({tiny!r})]
    circle.append(circle)

def test_keeps_its_own(shared):
    kept.append(_core.Engine({tiny!r}))

def test_that_comes_after(shared):
    _core.Engine({tiny!r})
"""


@pytest.mark.parametrize("device", ["cpu", "llvmpipe"])
def test_an_engine_is_counted_while_it_is_there(device):
    first = _core.devices_opened()
    engine = _core.Engine(TINY, device=device, validation=True)
    engine.set_material("marble")
    engine.set_lights(["ambient:1"])
    engine.solve()
    engine.render(width=8, height=8)
    live = _core.live_objects(first)
    assert engine.validation_messages == []
    assert live["allocated byte"] == engine.device_bytes
    if device == "cpu":
        assert live == {"device": 1, "allocation": live["allocation"], "allocated byte": live["allocated byte"]}
    else:
        assert live["device"] == 1
        assert live["allocation"] == live["buffer"] + live["image"]
        assert live["image"] == live["image view"]
        assert live["pipeline"] >= live["pipeline layout"] > 0
        assert "shader module" not in live
        assert live["fence"] == live["command pool"] <= 4  # of recordings, which are used again
    assert _core.live_objects(first + 1) == {}
    del engine
    assert _core.live_objects(first) == {}


def test_an_engine_that_cannot_be_made_leaves_nothing(tmp_path):
    first = _core.devices_opened()
    (tmp_path / "no.qgraph").write_bytes(b"QGRAPH")
    with pytest.raises(errors.FormatError):
        _core.Engine(tmp_path / "no.qgraph")
    with pytest.raises(errors.DeviceError):
        _core.Engine(TINY, device="no such device")
    assert left_behind(first) == {}


def test_a_test_that_keeps_an_engine_fails_and_no_other(tmp_path):
    path = tmp_path / "test_kept.py"
    path.write_text(TESTS.format(tiny=str(TINY)))
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "leaks", "-p", "no:cacheprovider", "-rE", "-q", str(path)],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(HERE)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert "6 passed, 1 error" in run.stdout, run.stdout + run.stderr
    assert "ERROR test_kept.py::test_keeps_its_own" in run.stdout
    assert "left behind on devices: {'allocat" in run.stdout
