"""A material with a dark spot and a cloudy one, as a volume: `python spotted.py spotted.npz`."""

import sys
import tempfile
from pathlib import Path

import numpy as np

import quadgraph

BOX = np.array([[-19.0, -15.0, -18.0], [19.0, 15.0, 18.0]])  # mm
DARK, CLOUDY = np.array([9.0, 1.0, 6.0]), np.array([-7.0, 0.0, 7.0])
RADIUS = 4.5


def coefficients(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sigma_s_prime and sigma_a, 1/mm: four times as much absorption in one ball, twice the scattering in another."""
    dark, cloudy = (np.linalg.norm(points - place, axis=1)[:, None] < RADIUS for place in (DARK, CLOUDY))
    return np.where(cloudy, 2, 1) * [0.9, 0.8, 0.7], np.where(dark, 4, 1) * [0.01, 0.015, 0.02]


def main(path: Path | None = None) -> float:
    """Write it, and return by how much the dark spot absorbs more."""
    material = quadgraph.VolumeMaterial.from_function(coefficients, BOX, spacing=0.5, eta=1.4)
    with tempfile.TemporaryDirectory() as folder:
        material.save(path or Path(folder) / "spotted.npz")
    return float(material.sigma_a.max() / material.sigma_a[0].max())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
