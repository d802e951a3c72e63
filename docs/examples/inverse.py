"""Coefficients found again from the light that leaves a body, by exact derivatives."""

import tempfile
from pathlib import Path

import numpy as np
import trimesh

import quadgraph

TRUE = np.array([1.2, 0.03])  # sigma_s_prime and sigma_a, 1/mm
GUESS = np.array([0.6, 0.1])


def octants(normal: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Rows (8, n): areas of the faces whose normals point into each octant."""
    number = (normal > 0) @ np.array([1, 2, 4])
    return (number == np.arange(8)[:, None]) * area


def power_by_octant(model: quadgraph.ForwardModel) -> np.ndarray:
    """What sums the exitance of faces up to the power, W, that leaves by each octant: (8, n_f)."""
    a, b, c = np.moveaxis(model.vertices[model.faces], 1, 0).astype(float)
    normal = np.cross(b - a, c - a)
    return octants(normal, np.linalg.norm(normal, axis=1) / 2)


def main() -> float:
    """Return the larger relative error of both, found on another mesh than the light was made on."""
    with tempfile.TemporaryDirectory() as folder:
        mesh, body = Path(folder) / "ball.ply", Path(folder) / "ball.qgraph"
        trimesh.creation.icosphere(subdivisions=3, radius=8).export(mesh)
        quadgraph.bake(mesh, body, quadgraph.BakeOptions(unit="mm", levels=2))
        with quadgraph.Engine(body) as engine:
            engine.lights = [quadgraph.DirectionalLight(direction=(0.4, -0.3, -0.9), irradiance=1)]
            engine.set_coefficients(lambda points: (TRUE[0], TRUE[1]))
            engine.solve(correction=False)
            surface = engine.surface()
            measured = octants(surface.normal, surface.area) @ surface.exitance[:, 0]

            found, tets = GUESS, (len(engine.forward_model(level=1).tets), 3)
            for _ in range(5):  # Gauss-Newton in the logarithms
                model = engine.forward_model(
                    level=1, sigma_s_prime=np.full(tets, found[0]), sigma_a=np.full(tets, found[1])
                )
                sums = power_by_octant(model)
                changes = model.jvp(sigma_s_prime=model.sigma_s_prime), model.jvp(sigma_a=model.sigma_a)
                jacobian = np.stack([sums @ change.exitance[:, 0] for change in changes], axis=1)
                missing = measured - sums @ model.outgoing.exitance[:, 0]
                step = np.linalg.lstsq(jacobian, missing, rcond=None)[0]
                found = found * np.exp(np.clip(step, -1, 1))
                print(f"sigma_s_prime {found[0]:.4f}, sigma_a {found[1]:.4f} 1/mm")
    return float(np.abs(found / TRUE - 1).max())


if __name__ == "__main__":
    print(main())
