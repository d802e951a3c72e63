"""The transport correction against random walks, on balls that SP3's boundary condition gets wrong."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pymeshlab
import pytest

import quadgraph
from quadgraph.base.relative_error import relative_rms
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import monte_carlo

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS = 12.0  # mm
ZONES = 10
WALKS = 1_000_000
# Ketchup in red; a body of a third of a mean free path that hardly absorbs; one of equal scattering and absorption.
MEDIA = {"ketchup": (0.18, 0.061, 1.3), "thin": (0.03, 0.001, 1.4), "absorbing": (0.1, 0.1, 1.1)}


@pytest.fixture(scope="module")
def ball(tmp_path_factory, request):
    """A ball whose triangles were cut in four so many times."""
    folder = tmp_path_factory.mktemp("ball")
    meshes = pymeshlab.MeshSet()
    meshes.create_sphere(radius=RADIUS, subdiv=request.param)
    meshes.save_current_mesh(str(folder / "ball.ply"))
    quadgraph.bake(folder / "ball.ply", folder / "ball.qgraph", quadgraph.BakeOptions(unit="mm"))
    with quadgraph.Engine(folder / "ball.qgraph") as engine:
        engine.lights = ["directional:0,0,-1:1"]
        yield engine


@lru_cache
def walked(medium: str) -> np.ndarray:
    scattering, absorption, eta = MEDIA[medium]
    return monte_carlo.sphere(Medium(scattering, absorption), RADIUS, eta, ZONES, WALKS, seed=7).mean


def errors(engine: quadgraph.Engine, medium: str, sweeps: int) -> tuple[np.ndarray, quadgraph.Solution]:
    """Relative RMS error of the exitance over all zones, and over those of the lit and of the dark half."""
    scattering, absorption, eta = MEDIA[medium]
    engine.material = f"sigma_s_prime={scattering},sigma_a={absorption},eta={eta}"
    solution = engine.solve(model="sp3", correction=sweeps > 0, sweeps=sweeps)
    field = engine.surface()
    height = field.position[:, 2] / np.linalg.norm(field.position, axis=1)
    zone = np.clip(((height + 1) / 2 * ZONES).astype(int), 0, ZONES - 1)
    power = np.bincount(zone, field.area * field.exitance[:, 0], ZONES)
    found, truth = power / np.bincount(zone, field.area, ZONES), walked(medium)
    lit = np.arange(ZONES) >= ZONES // 2
    parts = (np.ones(ZONES, bool), lit, ~lit)
    return np.array([relative_rms(part, (found - truth)[:, None], truth[:, None]) for part in parts]), solution


# In the thin medium the flat faces of a coarser ball alone leave 1.1% inside; a finer one takes half a minute.
@pytest.mark.parametrize(
    ("medium", "ball"),
    [("ketchup", 4), *(pytest.param(*case, marks=pytest.mark.long) for case in (("absorbing", 4), ("thin", 5)))],
    indirect=["ball"],
)
def test_sweeps_bring_moments_to_transport(medium, ball):
    moments, plain = errors(ball, medium, 0)
    once, first = errors(ball, medium, 1)
    twice, second = errors(ball, medium, 2)
    print(f"{medium}: {moments} {once} {twice}; {plain.error} {first.error} {second.error} {first.correction}")
    assert plain.correction is None
    assert max(once) < 0.015
    assert max(twice) < 0.012
    assert max(once) < 0.35 * max(moments)
    # What the sweep changed is how wrong the moments were.
    change = first.correction.sweeps[0].change
    assert change.whole == pytest.approx(moments[0], rel=0.25)
    assert second.correction.sweeps[1].change.whole < 0.3 * change.whole
    assert abs(second.energy.balance).max() < 0.005
