"""Random walks through meshes against walks that know the shape in closed form, and against what must hold of any."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh

from quadgraph.api.lights import AmbientLight, DirectionalLight, PointLight, RectangleLight, SpotLight
from quadgraph.mesh.patches import patches_of
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.bodies.smooth_sky import SmoothSky, directions, drawn_sky
from quadgraph_validation.bodies.unseen_cases import UnseenMedium
from quadgraph_validation.truth import light_rays, monte_carlo
from quadgraph_validation.truth.fresnel import entering_share

pytest.importorskip("numba", reason="the extra `walks` is not installed: run tools/setup")

from quadgraph_validation.truth import mesh_walk

RADIUS = 10.0
ZONES = 8
AXIS = np.array([2.0, 3.0, 6.0]) / 7  # the sun's place: in no plane of the icosahedron
SUN = DirectionalLight(tuple(-AXIS), 1.0)


def even(scattering: float, absorption: float, eta: float) -> UnseenMedium:
    return UnseenMedium("even", eta, *(np.full((1, 1, 1), c, np.float32) for c in (scattering, absorption)))


@cache
def ball(detail: int) -> Surface:
    mesh = trimesh.creation.icosphere(subdivisions=detail, radius=RADIUS)
    return Surface(np.asarray(mesh.vertices), np.asarray(mesh.faces))


@cache
def waisted() -> Surface:
    """A flattened ball drawn in at its waist, across which it sees itself."""
    body = ball(4)
    height = body.vertices[:, 2:] / RADIUS
    waist = 0.2 + 0.8 * height**2
    return Surface(body.vertices * np.hstack([waist, waist, np.full_like(waist, 0.35)]), body.triangles)


def zones(surface: Surface) -> np.ndarray:
    height = surface.corners.mean(axis=1) @ AXIS
    return np.clip(((height / RADIUS + 1) / 2 * ZONES).astype(int), 0, ZONES - 1)


def areas(surface: Surface, patch: np.ndarray) -> np.ndarray:
    return np.bincount(patch, np.linalg.norm(surface.doubled_normals, axis=1) / 2)


def walked(surface, medium, light, patch, batches: int = 10, walks: int = 10_000, again: bool = True):
    walker = mesh_walk.MeshWalker(surface, medium, light, patch, again)
    return [walker.batch(walks, k, seed=3) for k in range(batches)]


def mean_and_error(values: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    found = np.array(values)
    return found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(len(found))


@pytest.mark.parametrize(("scattering", "absorption", "eta"), [(0.4, 0.02, 1.3), (0.1, 0.1, 1.1), (1.0, 0.001, 1.0)])
def test_walks_through_a_ball_of_triangles_agree_with_those_through_a_sphere(scattering, absorption, eta):
    surface = ball(4)
    patch = zones(surface)
    found = walked(surface, even(scattering, absorption, eta), SUN, patch, walks=10_000)
    mean, error = mean_and_error([batch.scattered / areas(surface, patch) for batch in found])
    truth = monte_carlo.sphere(Medium(scattering, absorption), RADIUS, eta, ZONES, 200_000, seed=5)
    # Four standard errors, and half a percent for flat faces and zones with edges of triangles.
    assert (np.abs(mean - truth.mean) < 4 * np.hypot(error, truth.error) + 0.005 * truth.mean).all()


def test_a_volume_of_equal_cells_is_walked_as_what_is_even():
    """A volume whose scattering differs in places that no walk can reach has delta tracking at work everywhere."""
    surface = ball(3)
    patch = zones(surface)
    scattering, absorption = (np.full((9, 9, 9), c, np.float32) for c in (0.3, 0.05))
    scattering[:, :, 8] = 0.6  # beyond x = 14 mm
    volume = UnseenMedium("veins", 1.2, scattering, absorption, (-14.0, -14.0, -14.0), 3.5)
    first, noise = mean_and_error([b.scattered for b in walked(surface, volume, SUN, patch)])
    other, more = mean_and_error([b.scattered for b in walked(surface, even(0.3, 0.05, 1.2), SUN, patch)])
    assert (np.abs(first - other) < 4 * np.hypot(noise, more)).all()


def test_half_a_volume_scatters_where_its_cells_say():
    """All that scatters lies at x > 0: light from +x leaves there, and a ball without absorption keeps nothing."""
    surface = ball(3)
    patch = (surface.corners.mean(axis=1)[:, 0] > 0).astype(int)
    scattering = np.zeros((2, 2, 3), np.float32)
    scattering[:, :, 2] = 1.0
    volume = UnseenMedium("veins", 1.0, scattering, np.zeros_like(scattering), (-10.0, -10.0, -10.0), 10.0)
    found = walked(surface, volume, DirectionalLight((-1, 0, 0), 1.0), patch)
    far, near = np.mean([b.scattered for b in found], axis=0)
    assert near > 3 * far > 0


@pytest.mark.parametrize("eta", [pytest.param(1.0, marks=pytest.mark.long), 1.4])
def test_in_a_furnace_every_patch_sends_out_what_it_takes_in(eta):
    """Uniform light and no absorption: light is the same everywhere, whatever the shape sees of itself."""
    body = waisted()
    patch = patches_of(body, 16)
    found = walked(body, even(0.2, 0.0, eta), AmbientLight(1.0), patch, batches=30, walks=10_000)
    mean, error = mean_and_error([(b.scattered + b.unscattered) / areas(body, patch) for b in found])
    assert error.max() < 0.012
    assert (np.abs(mean - entering_share(True, eta)) < 4 * error).all()
    assert sum(b.lost for b in found) == 0
    # What first enters is less in the waist, which the body hides from the lights.
    entered = np.mean([b.entered.sum() for b in found])
    assert 0.8 * entering_share(True, eta) * body.area < entered < 0.97 * entering_share(True, eta) * body.area


def test_what_enters_is_absorbed_or_goes_away():
    body = waisted()
    found = walked(body, even(0.3, 0.05, 1.3), SUN, patches_of(body, 16))
    missing, error = mean_and_error([1 - (b.absorbed + b.gone) / b.entered.sum() for b in found])
    assert error < 1e-3  # Russian roulette's
    assert abs(missing) < 4 * error
    assert 0.1 < np.mean([b.absorbed / b.entered.sum() for b in found]) < 0.9


@pytest.mark.parametrize("shape", ["ball", "waisted"])
def test_light_that_left_is_let_go_where_that_is_asked_for(shape):
    """On a ball, which no light comes back to, it makes no difference; a waist is darker without it."""
    body = ball(3) if shape == "ball" else waisted()
    medium, patch = even(0.3, 0.01, 1.3), patches_of(body, 16)
    followed, let_go = (walked(body, medium, AmbientLight(1.0), patch, again=again) for again in (True, False))
    whole, error = mean_and_error([b.scattered.sum() for b in followed])
    less, other = mean_and_error([b.scattered.sum() for b in let_go])
    if shape == "ball":
        assert abs(whole - less) < 4 * np.hypot(error, other)
    else:
        assert whole > 1.03 * less
    for batch in let_go:  # no walk is light enough for Russian roulette
        assert batch.absorbed + batch.gone == pytest.approx(batch.entered.sum(), rel=1e-9)


@pytest.mark.parametrize(
    "light",
    [
        SUN,
        PointLight((0, 0, 40), 5000.0),
        SpotLight((0, 30, 40), (0, -3, -4), 8, 4000.0, 0.5),
        RectangleLight((0, 0, 30), (15, 0, 0), (0, -25, 0), 4000.0),
        AmbientLight(2.0),
        drawn_sky(np.random.default_rng(6)),
    ],
    ids=lambda light: light.type,
)
def test_light_arrives_as_its_definition_says(light):
    """Irradiance of a small disc at the origin that faces AXIS, from rays towards a sphere around it."""
    middle, radius, disc = np.zeros(3), 3.0, 0.5
    drawn = light_rays.rays(light, middle, radius, 1_000_000, np.random.default_rng(4))
    along = drawn.ways @ AXIS
    at = drawn.origins - (drawn.origins @ AXIS / along)[:, None] * drawn.ways
    hits = (along < 0) & (np.linalg.norm(at, axis=1) < disc)
    unit = drawn.power / drawn.drawn / (np.pi * disc**2)
    assert unit * hits.sum() == pytest.approx(irradiance(light), abs=4 * unit * np.sqrt(hits.sum()))
    assert hits.sum() > 2000


def irradiance(light) -> float:
    """W/mm^2 on a plane at the origin that faces AXIS."""
    if isinstance(light, SmoothSky):
        rows, columns = light.radiance.shape
        solid = np.sin(np.pi * (np.arange(rows) + 0.5) / rows)[:, None] * 2 * np.pi**2 / rows / columns
        return float((light.radiance * solid * np.clip(directions(rows, columns) @ AXIS, 0, None)).sum())
    if isinstance(light, DirectionalLight):
        return light.irradiance
    if isinstance(light, AmbientLight):
        return light.irradiance
    if isinstance(light, RectangleLight):
        u, v = (np.array(edge, float) for edge in (light.u, light.v))
        shares = (np.arange(200) + 0.5) / 200 - 0.5
        places = np.array(light.centre) + shares[:, None, None] * u + shares[:, None] * v
        normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        far = np.linalg.norm(places, axis=-1)
        return light.power / np.pi * np.mean(-(places @ normal) * np.clip(places @ AXIS, 0, None) / far**4)
    place = np.array(light.position, float)
    cosine = place @ AXIS / np.linalg.norm(place)
    if isinstance(light, PointLight):
        return light.power / (4 * np.pi * place @ place) * cosine
    begin, end = np.cos(np.radians([light.angle * (1 - light.edge), light.angle]))
    return light.power / (np.pi * (2 - begin - end)) / (place @ place) * cosine  # the disc is on the axis
