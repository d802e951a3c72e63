"""Bodies that cases start from, baked once and kept by what they are baked from, and the answers of undamaged ones."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import trimesh

from attack.child import ROOT, program

DATA = ROOT / "tests" / "data"
BAKE = ("--unit", "mm", "--levels", "2", "--visibility-rays", "64")
OTHERS = {
    "surface": ("--unit", "mm", "--surface-only"),
    "single": ("--unit", "mm", "--levels", "1", "--surface-vertices", "100"),
}
SOLVED = ("--no-correction", "--light", "directional:0.3,-0.5,-1:1", "--light", "ambient:0.1")


@cache
def ring() -> trimesh.Trimesh:
    """A torus about z, R 10 and r 4 mm, of 576 triangles."""
    return trimesh.creation.torus(major_radius=10, minor_radius=4, major_sections=24, minor_sections=12)


class Bodies:
    """A folder of bodies. They are made when they are first asked for, by one thread at a time."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._lock = threading.RLock()

    def body(self, name: str = "ring") -> Path:
        """The .qgraph of a body: ring, single (one level), surface (no level), tiny or polygrid."""
        if name in ("tiny", "polygrid"):
            return DATA / f"{name}.qgraph"
        text = ring().export(file_type="ply", encoding="ascii")
        options = OTHERS.get(name, BAKE)

        def bake(path: Path) -> None:
            mesh = path.with_suffix(".ply")
            mesh.write_bytes(text)
            self._run("bake", str(mesh), "-o", str(path), *options)

        return self._kept(f"{text!r}{options}", ".qgraph", bake)

    def put(self, folder: Path, name: str = "ring", under: str = "body.qgraph") -> Path:
        """Copy a body into a folder."""
        return Path(shutil.copyfile(self.body(name), folder / under))

    def field(self, name: str, options: tuple[str, ...]) -> dict[str, np.ndarray]:
        """The surface field of an undamaged body, solved with these options."""

        def solve(path: Path) -> None:
            self._run("solve", str(self.body(name)), "--field", str(path), *options)

        self.body(name)
        with np.load(self._kept(f"{name}{options}", ".npz", solve)) as arrays:
            return dict(arrays)

    def picture(self, name: str, options: tuple[str, ...]) -> Path:
        """The picture of an undamaged body, rendered with these options: a PNG."""

        def render(path: Path) -> None:
            self._run("render", str(self.body(name)), "-o", str(path), *options)

        self.body(name)
        return self._kept(f"{name}{options}picture", ".png", render)

    def _kept(self, key: str, suffix: str, make: Callable[[Path], None]) -> Path:
        path = self.folder / f"{hashlib.sha256(key.encode()).hexdigest()[:16]}{suffix}"
        with self._lock:
            if not path.exists():
                make(path)
        return path

    @staticmethod
    def _run(*arguments: str) -> None:
        command = [program("quadgraph"), *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)}: exit code {done.returncode}: {done.stderr[-500:]}")
