"""docs/tour.md: its pictures are there, and, in a long test, all of it runs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).resolve().parents[3]
TEXT = (ROOT / "docs" / "tour.md").read_text()
PICTURES = re.findall(r"\]\((images/[^)]+)\)", TEXT)


def commands() -> str:
    return subprocess.run([ROOT / "tools" / "tour", "--print"], capture_output=True, text=True, check=True).stdout


def test_every_picture_is_there_and_made_by_a_command_above_it():
    assert len(PICTURES) >= 8
    for picture in PICTURES:
        with Image.open(ROOT / "docs" / picture) as image:
            assert image.size[0] > 200
        if picture != "images/window.png":
            assert f"docs/{picture}" in TEXT[: TEXT.index(f"]({picture})")]


@pytest.mark.long
def test_the_tour_runs(tmp_path, small_bunny):
    """Every command, in a copy of the documents, on a coarser bunny."""
    if shutil.which("montage") is None:
        pytest.skip("ImageMagick is not installed (tools/packages.txt)")
    shutil.copytree(ROOT / "docs", tmp_path / "docs", ignore=shutil.ignore_patterns("benchmarks", "tour-*"))
    (tmp_path / "out" / "tour").mkdir(parents=True)
    shutil.copy(small_bunny, tmp_path / "out" / "bunny.qgraph")
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    subprocess.run(
        ["bash", "-euo", "pipefail", "-c", commands()], cwd=tmp_path, env=os.environ | {"PATH": path}, check=True
    )
    for picture in PICTURES:
        with Image.open(tmp_path / "docs" / picture) as image:
            assert max(high for _, high in image.convert("RGB").getextrema()) > 60
