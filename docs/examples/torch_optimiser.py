"""Absorption found again from the light that leaves a body, by an optimiser of PyTorch (extra `torch`)."""

import tempfile
from pathlib import Path

import numpy as np
import torch
import trimesh

import quadgraph

SIGMA_S_PRIME = 1.2  # 1/mm, known
TRUE = torch.tensor([0.02, 0.05, 0.12], dtype=torch.float64)  # sigma_a of red, green, blue, 1/mm


def sides(surface: quadgraph.SurfaceField) -> torch.Tensor:
    """Rows (2, n): areas of the faces, mm^2, of the side that is lit, and of the other."""
    lit = surface.q[:, 0] > 0
    return torch.tensor(np.stack([lit, ~lit]) * surface.area, dtype=torch.float64)


def main() -> float:
    """Return the largest relative error of the three coefficients."""
    with tempfile.TemporaryDirectory() as folder:
        mesh, body = Path(folder) / "ball.ply", Path(folder) / "ball.qgraph"
        trimesh.creation.icosphere(subdivisions=2, radius=8).export(mesh)
        quadgraph.bake(mesh, body, quadgraph.BakeOptions(unit="mm", levels=1))
        with quadgraph.Engine(body) as engine:
            engine.lights = [quadgraph.DirectionalLight(direction=(0.4, -0.3, -0.9), irradiance=1)]
            engine.set_coefficients(lambda points: (SIGMA_S_PRIME, TRUE.numpy()))
            engine.solve(correction=False)
            surface = engine.surface()
            power = sides(surface)
            measured = power @ torch.tensor(surface.exitance, dtype=torch.float64)  # (2, 3) W

            tets = len(engine.forward_model().tets)
            logarithm = torch.full((3,), 0.3, dtype=torch.float64).log().requires_grad_()
            optimiser = torch.optim.LBFGS([logarithm], max_iter=20, line_search_fn="strong_wolfe")

            def loss() -> torch.Tensor:
                optimiser.zero_grad()
                light = quadgraph.outgoing_tensors(engine, sigma_a=logarithm.exp().expand(tets, 3))
                error = (power @ light.exitance / measured).log().square().sum()
                error.backward()
                found = ", ".join(f"{each:.4f}" for each in logarithm.exp().tolist())
                print(f"loss {error.item():.1e}, sigma_a {found} 1/mm")
                return error

            optimiser.step(loss)
    return (logarithm.exp() / TRUE - 1).abs().max().item()


if __name__ == "__main__":
    print(main())
