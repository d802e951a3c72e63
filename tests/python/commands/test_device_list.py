"""`quadgraph devices` names every device, what it lacks, and the one that is taken."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


def listed(*options: str, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "quadgraph.cli", "devices", *options]
    return subprocess.run(command, env=os.environ | environment, capture_output=True, text=True)


def test_every_device_is_named_and_the_processor_always():
    done = listed(QUADGRAPH_DEVICE="cpu")
    assert done.returncode == 0
    try:
        names = [each["name"] for each in _core.vulkan_devices()]
    except Exception as error:
        pytest.skip(f"Vulkan finds no device here: {error}")
    assert all(name in done.stdout for name in names)
    assert "cpu, the processor: always there" in done.stdout
    assert "QUADGRAPH_DEVICE=cpu of the environment names it" in done.stdout
    assert "that is no GPU" in done.stdout


def test_json_says_what_is_taken():
    found = json.loads(listed("--json", QUADGRAPH_DEVICE="cpu").stdout)
    assert found["works"] is True
    assert found["driver"].startswith("quadgraph cpu")
    assert {"name", "driver", "software", "lacks"} <= set(found["vulkan"][0]) if "vulkan" in found else found["error"]


def test_one_that_is_not_there_fails_with_a_cure():
    done = listed(QUADGRAPH_DEVICE="no such device")
    assert done.returncode == 1
    assert "no such device" in done.stdout
    assert "cure: unset QUADGRAPH_DEVICE" in done.stdout
