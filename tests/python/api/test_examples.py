"""The examples of the documents run, and give the physics that they tell of."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[3] / "docs/examples"
EXPECTED = {
    "energy_balance.py": pytest.approx(0, abs=1e-5),
    "fluence.py": pytest.approx(0, abs=1e-5),
    "inverse.py": pytest.approx(0, abs=0.1),
    "lights_and_materials.py": pytest.approx(2, rel=1e-5),
    "spotted.py": pytest.approx(4, rel=1e-5),
    "toadstool.py": pytest.approx(0, abs=1e-4),
    "torch_optimiser.py": pytest.approx(0, abs=1e-3),
    "veined_block.py": pytest.approx(0, abs=1e-6),
}


def run(name: str) -> float:
    return runpy.run_path(str(FOLDER / name))["main"]()


@pytest.mark.parametrize("name", EXPECTED)
def test_the_number_of_an_example(name):
    if name.startswith("torch"):
        pytest.importorskip("torch", reason="PyTorch is not installed: pip install 'quadgraph[torch]'")
    assert run(name) == EXPECTED[name]


def test_the_picture_shows_the_body():
    assert 0.1 < run("picture.py") < 0.9


def test_every_example_is_run():
    notebooks = {path.with_suffix(".py").name for path in FOLDER.glob("*.ipynb")}  # test_notebooks.py
    assert {path.name for path in FOLDER.glob("*.py")} == EXPECTED.keys() | {"picture.py"} | notebooks
