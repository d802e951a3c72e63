"""Random smooth closed bodies that nobody has looked at before: smooth blends of simple shapes, from a seed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh

from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.implicit import Field, box, capsule, least, meshed, valid

LENGTH = (10.0, 100.0)  # mm, longest side
TRIANGLES = (8_000, 30_000)
_CELLS = 112  # along the box in which a body is blended
_HALF = 1.7  # of that box; bodies are about 1 in radius
_TRIES = 20  # bodies drawn until one has a valid surface


def surface_of(seed: int) -> Surface:
    """The body of a seed, mm: one closed piece, no crossing triangles. Raises InputError without scikit-image."""
    for attempt in range(_TRIES):
        generator = np.random.default_rng([seed, 0, attempt])
        field = _drawn(generator)
        triangles = int(np.exp(generator.uniform(*np.log(TRIANGLES))))
        length = float(np.exp(generator.uniform(*np.log(LENGTH))))
        found = valid(meshed(field, _HALF, _CELLS), triangles)
        if found is not None:
            return Surface(found.vertices * length / np.ptp(found.vertices, axis=0).max(), found.triangles).rounded()
    raise InputError(f"seed {seed}: no valid body in {_TRIES} tries; take another seed")


def write(path: Path, surface: Surface) -> None:
    """Write a PLY file in mm."""
    trimesh.Trimesh(surface.vertices, surface.triangles, process=False).export(path, file_type="ply")


def _drawn(generator: np.random.Generator) -> Field:
    """A core with limbs, perhaps a handle, a wall and pockets."""
    parts: list[tuple[Field, bool]] = [(_core(generator), True)]
    parts += [(_limb(generator), True) for _ in range(generator.integers(1, 6))]
    parts += [(_handle(generator), True)] * int(generator.random() < 0.4)
    parts += [(_wall(generator), True)] * int(generator.random() < 0.4)
    parts += [(_pocket(generator), False) for _ in range(generator.integers(0, 4))]
    blend = float(np.exp(generator.uniform(np.log(0.03), np.log(0.25))))

    def field(points: np.ndarray) -> np.ndarray:
        value = parts[0][0](points)
        for part, added in parts[1:]:
            other = part(points)
            value = least(value, other, blend) if added else -least(-value, other, blend)
        return value

    return field


def _way(generator: np.random.Generator) -> np.ndarray:
    way = generator.normal(size=3)
    return way / np.linalg.norm(way)


def _turn(generator: np.random.Generator) -> np.ndarray:
    """(3, 3) a random rotation."""
    q, r = np.linalg.qr(generator.normal(size=(3, 3)))
    return q * np.sign(np.diag(r))


def _core(generator: np.random.Generator) -> Field:
    if generator.random() < 0.5:
        return box(generator.uniform(0.25, 0.6, 3), generator.uniform(0.05, 0.2), _turn(generator))
    radii, turn = generator.uniform(0.3, 0.7, 3), _turn(generator)
    return lambda p: (np.linalg.norm(p @ turn / radii, axis=-1) - 1) * radii.min()


def _limb(generator: np.random.Generator) -> Field:
    """A capsule that grows from near the middle, of one thickness here and another there."""
    start, way = generator.uniform(-0.3, 0.3, 3), _way(generator)
    length = generator.uniform(0.4, 1.1)
    thick, thin = np.exp(generator.uniform(np.log(0.06), np.log(0.35), 2))
    return capsule(start, way, length, thick, thin)


def _handle(generator: np.random.Generator) -> Field:
    """A torus whose middle lies near the core's surface."""
    middle, turn = _way(generator) * generator.uniform(0.4, 0.7), _turn(generator)
    ring, tube = generator.uniform(0.3, 0.5), generator.uniform(0.06, 0.14)

    def field(p: np.ndarray) -> np.ndarray:
        q = (p - middle) @ turn
        return np.hypot(np.hypot(q[..., 0], q[..., 1]) - ring, q[..., 2]) - tube

    return field


def _wall(generator: np.random.Generator) -> Field:
    """A thin rounded plate that stands out of the core."""
    size = np.array([generator.uniform(0.03, 0.08), *generator.uniform(0.3, 0.6, 2)])
    plate = box(size, 0.02, _turn(generator))
    middle = _way(generator) * generator.uniform(0.3, 0.7)
    return lambda p: plate(p - middle)


def _pocket(generator: np.random.Generator) -> Field:
    middle, radius = _way(generator) * generator.uniform(0.3, 0.8), generator.uniform(0.1, 0.35)
    return lambda p: np.linalg.norm(p - middle, axis=-1) - radius
