"""The CPU reference against closed forms, over refinements of a sphere."""

from __future__ import annotations

import numpy as np
import pytest

from baked import face_frames, refined_sphere, write_graphs
from closed_forms import sphere_surface_fluence
from quadgraph import graph
from quadgraph.tetrahedralise import tetrahedralise
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS = 10.0  # mm
ETA = 1.3
KAPPA, SIGMA_A = 0.2, 0.002  # mm, 1/mm: diffusion length 10 mm
SIGMA_S_PRIME = 1 / (3 * KAPPA) - SIGMA_A  # 1/mm
SOURCE = [0.5, 0.6, 0.4, 0.3]  # Legendre coefficients of Q, W/mm^2


@pytest.fixture(scope="module")
def spheres(tmp_path_factory):
    """Three spheres, the edge length halved each time."""
    folder = tmp_path_factory.mktemp("spheres")
    graphs = [graph.build(tetrahedralise(icosphere(3, RADIUS), mesher="tetgen"))]
    for _ in range(2):
        graphs.append(refined_sphere(graphs[-1], RADIUS))
    return [_core.load(write_graphs(folder / f"sphere{n}.qgraph", [g])) for n, g in enumerate(graphs)]


def fluence_error(sphere, method: str) -> tuple[float, float]:
    """Relative area-weighted L2 error of phi on the surface, and the mean edge length in mm."""
    level = sphere.levels[0]
    centre, _, area = face_frames(level)
    cos_theta = centre[:, 2] / np.linalg.norm(centre, axis=1)
    f_dr = _core.internal_diffuse_reflectance(ETA)
    source = np.polynomial.legendre.legval(cos_theta, SOURCE)
    q = np.repeat((source * (1 - f_dr) / 4)[:, None], 3, axis=1)
    nodes = len(level.nodes)
    solution = _core.solve_reference(
        sphere, 0, np.full((nodes, 3), SIGMA_S_PRIME), np.full((nodes, 3), SIGMA_A), ETA, q, method=method
    )
    assert solution["report"]["converged"]
    exact = sphere_surface_fluence(cos_theta, SOURCE, RADIUS, KAPPA, SIGMA_A, _core.mismatch(ETA))
    difference = solution["phi_face"][:, 0] - exact
    return np.sqrt((area * difference**2).sum() / (area * exact**2).sum()), np.sqrt(area.mean())


def test_fem_converges_with_second_order(spheres):
    errors, sizes = zip(*(fluence_error(sphere, "fem") for sphere in spheres), strict=True)
    order = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    print(f"fem errors {[f'{e:.3%}' for e in errors]}, order {order:.2f}")
    assert order >= 1.9
    assert errors[-1] < 0.005


def test_fv_is_between_fem_and_the_published_differences(spheres):
    """Two-point flux is conservative but not consistent on general tets (physics.md): a plateau, lower than FDM's."""
    errors = [fluence_error(sphere, "quadgraph-fv")[0] for sphere in spheres]
    print(f"quadgraph-fv errors {[f'{e:.3%}' for e in errors]}")
    for sphere, error in zip(spheres, errors, strict=True):
        assert fluence_error(sphere, "quadgraph-fdm")[0] > error
    assert errors[0] > errors[-1] > fluence_error(spheres[-1], "fem")[0]


def test_fdm_error_on_the_sphere_is_bounded_but_does_not_vanish(spheres, record_property):
    """The published differences are inconsistent on irregular tets (physics.md): reported, not hidden."""
    errors = [fluence_error(sphere, "quadgraph-fdm")[0] for sphere in spheres]
    print(f"quadgraph-fdm errors {[f'{e:.3%}' for e in errors]}")
    record_property("quadgraph-fdm errors", errors)
    assert max(errors) < 0.5
    assert errors[-1] > fluence_error(spheres[-1], "fem")[0]
