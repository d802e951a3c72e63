"""The PDE truth: nested faces, irradiance by rays, a closed form within the stated noise, refusals and resuming."""

from __future__ import annotations

import shutil
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from rich.console import Console
from scipy.spatial import Delaunay

from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph.file import qgraph_file
from quadgraph.tets import exchange, refine
from quadgraph_validation.bodies import meshes, scenes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.bodies.scenes import StudyScene
from quadgraph_validation.truth import pde_solve, pde_truth, round_bodies
from quadgraph_validation.truth.fresnel import entering_share
from quadgraph_validation.truth.irradiance import Occluder, entering
from quadgraph_validation.truth.nested import nested
from quadgraph_validation.truth.pde_truth import PdeTruth
from quadgraph_validation.truth.round_bodies import Shell
from quadgraph_validation.truth.schemes import Scheme

MEDIUM = Medium(1.0, 0.1)
RADIUS, ETA = 10.0, 1.3
QUIET = Console(quiet=True)


def ball_scene(direction=None) -> StudyScene:
    """A small even ball; its mesh is `ball.ply` of 162 vertices."""
    coefficients = scenes.of_medium([MEDIUM.sigma_s_prime] * 3, [MEDIUM.sigma_a] * 3)
    return StudyScene("ball", "ball.ply", ETA, coefficients, 4.0, direction, {}, height=2 * RADIUS, coloured=True)


def write_ball(folder):
    trimesh.creation.icosphere(subdivisions=2, radius=RADIUS).export(folder / "ball.ply")
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    return write_ball(tmp_path_factory.mktemp("pde"))


@pytest.fixture(scope="module")
def truth(folder):
    return pde_truth.make(ball_scene(), "sp3", folder, folder, QUIET, "diffuse")


def test_faces_are_found_in_those_they_were_cut_from():
    coarse = meshes.ball(RADIUS, 0, subdivisions=2)
    fine = refine.refined(coarse)
    found = nested(coarse.vertices, coarse.faces, fine.vertices, fine.faces)
    assert (np.bincount(found.parent, minlength=len(coarse.faces)) == 4).all()
    # Rounded to single precision, the middles of the fine faces lie where the coarse ones say.
    centre, _, area = meshes.face_frames(fine)
    np.testing.assert_allclose(found.at_middles(coarse.faces, coarse.vertices), centre, atol=3e-6)
    expected = meshes.face_frames(coarse)[0]
    np.testing.assert_allclose(found.means(area, centre, len(coarse.faces)), expected, atol=3e-6)
    with pytest.raises(ValueError, match="not cut out"):
        nested(fine.vertices, fine.faces, coarse.vertices, coarse.faces)


def plates(edge: float, gap: float):
    return meshes.facing_plates(edge, 1.0, gap, 8)


@pytest.mark.parametrize("direction", [(0.0, 0.0, -1.0), (0.3, 0.1, -0.7), (-0.8, 0.2, -0.3)])
def test_light_that_enters_is_what_the_outline_takes_in(direction):
    """At eta 1 all of it enters: the power is the area of the body's shadow on a plane across the beam."""
    body = plates(10.0, 3.0)
    scene = replace(ball_scene(direction), eta=1.0)
    q = entering(scene, body, Occluder(body.boundary), 8, 0)[:, 0]
    way = np.array(direction) / np.linalg.norm(direction)
    across = np.linalg.svd(way[None])[2][1:]
    generator = np.random.default_rng(1)
    points = generator.uniform(-12, 12, (400_000, 2))
    shadow = np.zeros(len(points), bool)
    for side in (body.vertices[:, 2] > 0, body.vertices[:, 2] < 0):
        shadow |= Delaunay(body.vertices[side] @ across.T).find_simplex(points) >= 0
    expected = shadow.mean() * 24**2
    error = 24**2 * np.sqrt(shadow.mean() * (1 - shadow.mean()) / len(points))
    area = meshes.face_frames(body)[2]
    print(f"power {area @ q:.3f} W, outline {expected:.3f} +- {error:.3f} mm^2")
    # A shadow's edge is sampled at 64 points a face.
    assert area @ q == pytest.approx(expected, abs=3 * error + 0.004 * expected)
    lower = (body.vertices[body.faces].mean(axis=1)[:, 2] < 0) & (meshes.face_frames(body)[1][:, 2] > 0.5)
    assert (q[lower] == 0).all() == (direction[0] == 0)


def test_even_light_is_hidden_as_much_as_faces_see_of_the_body():
    body = plates(10.0, 3.0)
    scene = replace(ball_scene(), eta=ETA)
    q = entering(scene, body, Occluder(body.boundary), 1, 256)
    seen = exchange.Seen(0, 256, exchange.table(body, 256))
    np.testing.assert_allclose(q[:, 1], entering_share(True, ETA) * (1 - seen.share), atol=1e-12)
    assert seen.share.max() > 0.5


def test_a_ball_is_as_the_closed_form_says_within_the_noise(truth):
    scheme = Scheme("fem", "diffuse", "sp3")
    boundary, q = scheme.boundary(ETA), entering_share(True, ETA)
    # In uniform light the exitance hangs on the volume per area, which the faceted ball has less of.
    level = pde_solve.Ladder(ball_scene(), truth.chain).first
    radius = 3 * level.volume / truth.area.sum()
    assert 0.98 < radius / RADIUS < 0.99
    ends = np.array([radius]), np.array([1.0])
    moments = round_bodies.sphere([Shell(MEDIUM, radius)], [q], scheme.model_of, boundary, *ends)
    expected = boundary.matrix[0] @ moments[:, 0] - boundary.reflected * q
    error = np.sqrt(truth.area @ (truth.exitance[:, 0] / expected - 1) ** 2 / truth.area.sum())
    print(f"error {error:.3%}, noise {truth.noise['whole']:.3%}, steps {truth.steps}")
    assert truth.noise["whole"] / 3 < error < truth.noise["whole"]
    assert truth.noise["whole"] < 0.05
    assert "unlit" not in truth.noise


def test_errors_of_an_exitance_are_told_on_every_level(tmp_path):
    pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    scene = ball_scene()
    trimesh.creation.icosphere(subdivisions=4, radius=RADIUS).export(tmp_path / "ball.ply")
    chain = pde_truth.chain(scene, tmp_path, tmp_path)
    ladder = pde_solve.Ladder(scene, chain)

    def linear(points):
        return np.repeat(2 + points[:, 2:] / RADIUS, 3, axis=1)

    file = qgraph_file.read(chain).sections
    middles = np.einsum("ij,ijk->ik", ladder.weight, file["level0/vertices"][ladder.corner])
    known = np.repeat(linear(middles)[None], pde_truth.MESHES, axis=0)
    truth = PdeTruth({}, chain, ladder.area, ladder.q, ladder.corner, ladder.weight, known)
    assert "level1/faces" in file
    for level, bound in ((0, 1e-6), (1, 0.02)):
        faces = file[f"level{level}/faces"]
        values = linear(file[f"level{level}/vertices"][faces].mean(axis=1))
        # A coarse level is a ball of fewer facets.
        assert truth.error(level, values)["whole"] < bound
        assert truth.error(level, 1.1 * values)["whole"] == pytest.approx(0.1, abs=bound)
    with pytest.raises(InputError, match=r"level 9 found"):
        truth.error(9, values)
    with pytest.raises(InputError, match=r"shape \(3, 3\) found"):
        truth.error(0, np.zeros((3, 3)))


def test_the_chain_s_own_answer_is_off_by_the_steps(truth):
    ladder = pde_solve.Ladder(ball_scene(), truth.chain)
    scheme = Scheme("fem", "diffuse", "sp3")
    np.testing.assert_allclose(ladder.exitance(0, scheme), truth.solutions[0], rtol=1e-9)
    direct = np.sqrt(truth.area @ (truth.solutions[0][:, 0] - truth.exitance[:, 0]) ** 2 / truth.area.sum())
    assert direct / truth.exitance.mean() <= truth.steps[0]["whole"] + truth.steps[1]["whole"]


def test_what_was_made_of_anything_else_is_refused(truth, folder, tmp_path):
    assert (pde_truth.stored(ball_scene(), "sp3", folder, folder, "diffuse").exitance == truth.exitance).all()
    with pytest.raises(InputError, match=r"ball-diffusion-diffuse\.npz: not there; 'quadgraph reference ball"):
        pde_truth.stored(ball_scene(), "diffusion", folder, folder, "diffuse")
    with pytest.raises(InputError, match=r"model 'auto': allowed are sp3, diffusion"):
        pde_truth.stored(ball_scene(), "auto", folder, folder)
    denser = replace(ball_scene(), coefficients=scenes.of_medium([1.1] * 3, [0.1] * 3))
    for stale, name in ((denser, "coefficients"), (replace(ball_scene(), eta=1.5), "eta: 1.3 found, 1.5 wanted")):
        with pytest.raises(InputError, match=name):
            pde_truth.stored(stale, "sp3", folder, folder, "diffuse")
        with pytest.raises(InputError, match=name):
            pde_truth.make(stale, "sp3", folder, folder, QUIET, "diffuse")
    trimesh.creation.icosphere(subdivisions=2, radius=9.0).export(tmp_path / "ball.ply")
    with pytest.raises(InputError, match=r"qgraph: not there"):
        pde_truth.stored(ball_scene(), "sp3", tmp_path, folder, "diffuse")


def test_an_interrupted_run_goes_on_to_the_same_truth(truth, folder, tmp_path, monkeypatch):
    shutil.copy(truth.chain, tmp_path)
    solve, solved = pde_solve.Ladder.exitance, []

    def interrupted(ladder, number, scheme):
        if number == 1 and len(solved) == 1:
            solved.append("interrupted")
            raise KeyboardInterrupt
        solved.append(number)
        return solve(ladder, number, scheme)

    monkeypatch.setattr(pde_solve.Ladder, "exitance", interrupted)
    with pytest.raises(KeyboardInterrupt):
        pde_truth.make(ball_scene(), "sp3", folder, tmp_path, QUIET, "diffuse")
    with pytest.raises(InputError, match="1 of 3 meshes solved"):
        pde_truth.stored(ball_scene(), "sp3", folder, tmp_path, "diffuse")
    resumed = pde_truth.make(ball_scene(), "sp3", folder, tmp_path, QUIET, "diffuse")
    assert solved == [0, "interrupted", 1, 2]
    np.testing.assert_array_equal(resumed.solutions, truth.solutions)


def test_the_command_line_names_what_is_wrong(tmp_path, capsys):
    pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    base = ["--truth", str(tmp_path), "--meshes", str(tmp_path)]
    assert cli.main(["reference", "teapot", "--kind", "pde", *base]) == 1
    assert "scene 'teapot': allowed are bunny" in capsys.readouterr().err
    assert cli.main(["reference", "bunny", "--kind", "pde", *base]) == 1
    assert "bunny.ply" in capsys.readouterr().err
    assert cli.main(["reference", "sphere", "--kind", "transport", *base]) == 1
    assert "--samples: not given" in capsys.readouterr().err
    for wrong in (["--kind", "exact"], ["--kind", "pde", "--model", "auto"], []):
        with pytest.raises(SystemExit) as stop:
            cli.main(["reference", "sphere", *wrong, *base])
        assert stop.value.code == 2
        capsys.readouterr()
    assert list(tmp_path.iterdir()) == []
