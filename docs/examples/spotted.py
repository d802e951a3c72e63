"""A material with a dark spot and a cloudy one, as a volume, and how near to it a recovered one comes.

`python spotted.py spotted.npz` writes it; `python spotted.py spotted.npz found.npz` holds found.npz against it.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
import trimesh
from scipy.interpolate import RegularGridInterpolator

import quadgraph

BODY = Path(__file__).parents[1] / "scenes/pebble.obj"
BOX = np.array([[-19.0, -15.0, -18.0], [19.0, 15.0, 18.0]])  # mm
DARK, CLOUDY = np.array([9.0, 1.0, 6.0]), np.array([-7.0, 0.0, 7.0])
RADIUS, CORE, BESIDE = 4.5, 3.0, 6.5  # mm; within CORE of a middle, or farther than BESIDE from both


def coefficients(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sigma_s_prime and sigma_a, 1/mm: four times as much absorption in one ball, twice the scattering in another."""
    dark, cloudy = (np.linalg.norm(points - place, axis=1)[:, None] < RADIUS for place in (DARK, CLOUDY))
    return np.where(cloudy, 2, 1) * [0.9, 0.8, 0.7], np.where(dark, 4, 1) * [0.01, 0.015, 0.02]


def judge(path: Path) -> None:
    """Print bias, RMS and contrast of a recovered volume, and how much of the truth its deviations hold."""
    points = np.random.default_rng(1).uniform(*BOX, (100_000, 3))
    points = points[trimesh.load_mesh(BODY).contains(points)]
    scattering, absorption = coefficients(points)
    dark, cloudy = (np.linalg.norm(points - place, axis=1) for place in (DARK, CLOUDY))
    beside = np.minimum(dark, cloudy) > BESIDE
    with np.load(path) as file:
        arrays = dict(file)
    axes = [arrays["origin"][k] + arrays["spacing"] * np.arange(arrays["sigma_a"].shape[2 - k]) for k in (2, 1, 0)]
    for name, true, more, own, other in (
        ("sigma_a", absorption, 4, dark, cloudy),
        ("sigma_s_prime", scattering, 2, cloudy, dark),
    ):
        found, deviation = (
            RegularGridInterpolator(axes, arrays[each])(points[:, ::-1]) for each in (name, f"{name}_deviation")
        )
        mean = found[beside].mean(axis=0)
        off = np.log(found / true)[beside]
        print(f"{name}: beside the balls off by {mean / true[beside][0] - 1}, RMS {np.sqrt((off**2).mean(axis=0))}")
        print(f"  contrast of the own ball, found over true {(found[own < CORE].mean(axis=0) / mean - 1) / (more - 1)}")
        print(f"  seen of the other ball {found[other < CORE].mean(axis=0) / mean - 1}")
        print(f"  beside the balls within two deviations {(np.abs(off) < 2 * deviation[beside]).mean():.3f}")


def main(path: Path | None = None) -> float:
    """Write the material, and return by how much the dark spot absorbs more."""
    material = quadgraph.VolumeMaterial.from_function(coefficients, BOX, spacing=0.5, eta=1.4)
    with tempfile.TemporaryDirectory() as folder:
        material.save(path or Path(folder) / "spotted.npz")
    return float(material.sigma_a.max() / material.sigma_a[0].max())


if __name__ == "__main__":
    np.set_printoptions(precision=3, suppress=True)
    main(Path(sys.argv[1]))
    if len(sys.argv) > 2:
        judge(Path(sys.argv[2]))
