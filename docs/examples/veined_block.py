"""A block of 16 x 16 x 8 mm with veins and two balls, and what is in it as a volume: to be carried onto other shapes.

`python veined_block.py block.obj block.npz` writes both.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import quadgraph

HALF = np.array([8.0, 8.0, 4.0])  # mm, of the block about its middle
DARK, RADIUS = np.array([[3.5, 0.5, 2.0], [-4.0, -3.5, -1.8]]), 1.8  # mm, middles of the balls


def coefficients(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sigma_s_prime and sigma_a, 1/mm: veins that absorb green and blue, two balls that absorb red."""
    x, y, z = points.T[:, :, None]
    bent = 0.6 * x + 0.8 * y + 1.1 * np.sin(0.7 * y - 0.5 * z) + 0.8 * np.sin(0.9 * x + 0.4 * z)
    veins = np.exp(-((np.mod(bent, 5.0) - 2.5) ** 2) / 0.6)
    balls = sum(1 / (1 + np.exp((np.linalg.norm(points - place, axis=1) - RADIUS) / 0.2)) for place in DARK)[:, None]
    absorption = np.array([0.004, 0.008, 0.02]) + veins * [0.05, 0.35, 0.5] + balls * [0.9, 0.25, 0.08]
    return np.array([1.3, 1.2, 1.1]) + veins * [0.5, 0.5, 0.5] + 0 * balls, absorption


def write_block(path: Path, per_mm: int) -> None:
    """The block's surface: on each of its six faces a grid of so many squares a millimetre, its corners shared."""
    cells = (2 * HALF * per_mm).astype(int)
    numbers: dict[tuple[int, ...], int] = {}
    triangles = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            for i, j in np.ndindex(cells[u], cells[v]):
                corners = []
                for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    place = [0, 0, 0]
                    place[axis], place[u], place[v] = side * int(cells[axis]), i + a, j + b
                    corners.append(numbers.setdefault(tuple(place), len(numbers) + 1))
                corners = corners if side else corners[::-1]
                triangles += [corners[:3], [corners[0], corners[2], corners[3]]]
    places = np.array(list(numbers)) / per_mm - HALF
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in places] + [f"f {a} {b} {c}" for a, b, c in triangles]
    path.write_text("\n".join(lines) + "\n")


def main(mesh: Path | None = None, volume: Path | None = None, per_mm: int = 1) -> float:
    """Write the block and its volume; return how far the volume is off when it is carried into the block itself."""
    material = quadgraph.VolumeMaterial.from_function(coefficients, np.array([-HALF, HALF]), spacing=0.4, eta=1.4)
    with tempfile.TemporaryDirectory() as folder:
        mesh, body = mesh or Path(folder) / "block.obj", Path(folder) / "block.qgraph"
        write_block(mesh, per_mm)
        material.save(volume or Path(folder) / "block.npz")
        quadgraph.bake(mesh, body, quadgraph.BakeOptions(unit="mm", levels=1))
        carried, _ = material.mapped(body, "shell")
    return float(np.abs(carried.sigma_a - material.sigma_a).max())


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), per_mm=2)
