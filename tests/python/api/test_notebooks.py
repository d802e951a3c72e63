"""The notebooks of the documents are what their programs show, and run."""

from __future__ import annotations

import importlib.util
import re
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

import pytest

nbformat = pytest.importorskip("nbformat", reason="the extra notebook is not installed: tools/setup --tests")
pytest.importorskip("jupytext", reason="the extra notebook is not installed: tools/setup --tests")

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = ROOT / "docs/examples/first_light.py"
NOTEBOOK = PROGRAM.with_suffix(".ipynb")


@pytest.fixture(scope="module")
def tool() -> ModuleType:
    """tools/notebooks as a module."""
    loader = SourceFileLoader("notebooks", str(ROOT / "tools/notebooks"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("notebooks", loader))
    loader.exec_module(module)
    return module


def texts(notebook: Path) -> str:
    """What the cells of a notebook print."""
    cells = nbformat.read(notebook, as_version=4).cells
    return "".join(output.get("text", "") for cell in cells for output in cell.get("outputs", ()))


def agree(text: str) -> bool:
    """Whether the power by the tets is that of the solve, less the few per cent that never scattered."""
    by_tets, by_solve = map(float, re.search(r"by the tets (\S+) W, by the solve (\S+) W", text).groups())
    return 0.9 * by_solve < by_tets < by_solve


def test_every_notebook_is_of_its_program_and_was_run(tool):
    assert tool.programs() == [PROGRAM]
    assert sorted(NOTEBOOK.parent.glob("*.ipynb")) == [NOTEBOOK]
    assert tool.faults(PROGRAM, NOTEBOOK) == []
    assert agree(texts(NOTEBOOK))


def test_a_notebook_that_is_behind_is_seen(tool, tmp_path):
    """A program that changed, a cell that was not run, one that failed, and none."""
    program = tmp_path / PROGRAM.name
    program.write_text(PROGRAM.read_text().replace("skimmilk", "ketchup"))
    assert [fault.rpartition(": ")[2] for fault in tool.faults(program, NOTEBOOK)] == ["not of first_light.py"]
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    code[1].execution_count = None
    code[2].outputs = [nbformat.v4.new_output("error", ename="ValueError", evalue="", traceback=[])]
    nbformat.write(notebook, tmp_path / "wrong.ipynb")
    found = tool.faults(PROGRAM, tmp_path / "wrong.ipynb")
    assert [fault.rpartition(": ")[2] for fault in found] == ["not run from top to bottom", "has errors or warnings"]
    assert tool.faults(PROGRAM, tmp_path / "none.ipynb") == [f"{tmp_path / 'none.ipynb'}: not there"]


@pytest.mark.long
def test_a_notebook_runs(tool, tmp_path, monkeypatch):
    monkeypatch.setenv("MPLCONFIGDIR", str(tmp_path / "matplotlib"))  # it complains where it has none to write to
    tool.run(PROGRAM, tmp_path / "again.ipynb")
    assert tool.faults(PROGRAM, tmp_path / "again.ipynb") == []
    assert agree(texts(tmp_path / "again.ipynb"))
