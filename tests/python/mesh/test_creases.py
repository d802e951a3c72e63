"""The displayed surface has a vertex for each side of a crease, and smooth normals elsewhere."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from quadgraph.mesh.creases import CREASE_DEGREES, parted
from quadgraph.mesh.subdivide import subdivide
from shapes import cube, icosphere

CREASES = Path(__file__).parents[3] / "shaders" / "shared" / "creases.h"


def test_a_ball_keeps_its_vertices_and_has_the_normals_of_the_sphere():
    ball = icosphere(2, radius=3.0)
    vertex, triangles, normals = parted(ball)
    assert np.array_equal(vertex, np.arange(len(ball.vertices)))
    assert np.array_equal(triangles, ball.triangles)
    radial = ball.vertices / np.linalg.norm(ball.vertices, axis=1, keepdims=True)
    assert np.abs(normals - radial).max() < 1e-6  # its coordinates are single precision


def test_a_box_is_parted_at_its_edges_and_stays_flat():
    box = cube()
    vertex, triangles, normals = parted(box)
    assert len(vertex) == 24
    assert np.array_equal(vertex[: len(box.vertices)], np.arange(len(box.vertices)))
    assert np.array_equal(vertex[triangles], box.triangles)
    own = box.doubled_normals / np.linalg.norm(box.doubled_normals, axis=1, keepdims=True)
    assert np.abs(normals[triangles] - own[:, None]).max() < 1e-12


def test_vertices_within_a_flat_side_are_not_parted():
    box = subdivide(cube(), 2)
    vertex = parted(box)[0]
    # 5 x 5 places on each side: of the 12 edges all between corners are on two, the corners on three.
    assert len(vertex) == 6 * 25


def test_the_engine_smooths_on_both_sides_of_the_bakes_angle():
    found = dict(re.findall(r"const float (CREASE_COSINE|SMOOTH_COSINE) = ([\d.]+)f;", CREASES.read_text()))
    sharp, smooth = (np.degrees(np.arccos(float(found[name]))) for name in ("CREASE_COSINE", "SMOOTH_COSINE"))
    assert smooth < CREASE_DEGREES < sharp
    assert abs((smooth + sharp) / 2 - CREASE_DEGREES) < 1e-3
