"""Random walks that are kept, and transport by other programs beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium, media
from quadgraph_validation.bodies.scenes import SCENES
from quadgraph_validation.truth import cross_checks, monte_carlo, path_tracing, pmmc_walk, truth_run, walk_truth
from quadgraph_validation.truth.slab_transport import discrete_ordinates
from quadgraph_validation.truth.truth_run import TracedSubject, stored
from quadgraph_validation.truth.walk_truth import BATCH

QUIET = Console(quiet=True)
SPHERE = SCENES["sphere"]


def thin(scene):
    """The body with thin material, so that walks are short."""
    return replace(scene, coefficients=lambda at: (np.full(at.shape[:-1], 0.1), np.full(at.shape[:-1], 0.05)))


@pytest.fixture(scope="module")
def walks(tmp_path_factory):
    folder = tmp_path_factory.mktemp("walks")
    return walk_truth.make(thin(SPHERE), 4 * BATCH, folder, QUIET), folder


def test_walks_are_those_of_the_plain_function(walks):
    found, _ = walks
    medium, radius = walk_truth.medium_of(found.scene), walk_truth.radius_of(found.scene)
    plain = monte_carlo.sphere(medium, radius, 1.0, walk_truth.ZONES, 100_000, seed=9)
    apart = (found.exitance.mean - plain.mean) / np.hypot(found.exitance.error, plain.error)
    assert np.sqrt(np.mean(apart**2)) < 1.5
    assert np.abs(apart).max() < 4


def test_eyes_all_around_receive_what_left(walks):
    found, _ = walks
    view, eyes = SPHERE.views["A"], 20
    cosines = (np.arange(eyes) + 0.5) * 2 / eyes - 1
    azimuths = np.degrees(np.arccos(cosines))
    views = {f"{n}": replace(view, azimuth=float(azimuth), elevation=0.0) for n, azimuth in enumerate(azimuths)}
    sums = walk_truth.WalkTruth({}, replace(found.scene, views=views), 0, 0 * found.zones, np.zeros(eyes, np.int64), 0)
    sums.add()
    power = 4 * np.pi * view.distance**2 * sums.at_eyes.mean.mean()
    left = sums.exitance.mean.mean() * 4 * np.pi * walk_truth.radius_of(SPHERE) ** 2
    print(f"{power:.3f} W pass the eyes, {left:.3f} W left")
    # The bands cover three fifths of the sphere of eyes.
    assert power == pytest.approx(left, rel=0.02)


def test_interrupted_walks_go_on_to_the_same_sums(walks, tmp_path, monkeypatch):
    found, _ = walks
    add = walk_truth.WalkTruth.add

    def interrupted(self):
        if self.batches == 2:
            monkeypatch.setattr(walk_truth.WalkTruth, "add", add)
            raise KeyboardInterrupt
        add(self)

    monkeypatch.setattr(walk_truth.WalkTruth, "add", interrupted)
    with pytest.raises(KeyboardInterrupt):
        walk_truth.make(thin(SPHERE), 4 * BATCH, tmp_path, QUIET)
    assert walk_truth.stored(thin(SPHERE), tmp_path).batches == 2
    resumed = walk_truth.make(thin(SPHERE), 4 * BATCH, tmp_path, QUIET)
    assert (resumed.zones == found.zones).all()
    assert (resumed.eyes == found.eyes).all()
    assert (resumed.absorbed, resumed.walks) == (found.absorbed, found.walks)


def test_walks_through_another_body_are_refused(walks):
    _, folder = walks
    for stale, name in ((SPHERE, "medium"), (replace(thin(SPHERE), eta=1.3), "eta: 1.0 found, 1.3 wanted")):
        with pytest.raises(InputError, match=name):
            walk_truth.stored(stale, folder)


def test_an_interrupted_picture_goes_on_to_the_same_picture(tmp_path, monkeypatch):
    pytest.importorskip("mitsuba", reason="Mitsuba is not installed: pip install './python/validation[truth]'")
    scene = replace(thin(SPHERE), views={"A": SPHERE.views["A"]})
    body = meshes.ball(10.0, 0).boundary
    subject = TracedSubject(scene, None, body, (walk_truth.scenes.grid_of(scene, body),), "")
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    truth_run.render([subject], whole, 4 * path_tracing.BATCH, QUIET)
    batch = path_tracing.Tracer.batch

    def interrupted(self, number):
        if number == 3:
            raise KeyboardInterrupt
        return batch(self, number)

    with monkeypatch.context() as patch:
        patch.setattr(path_tracing.Tracer, "batch", interrupted)
        with pytest.raises(KeyboardInterrupt):
            truth_run.render([subject], broken, 4 * path_tracing.BATCH, QUIET)
    assert stored(subject, broken, "A").batches == 3
    truth_run.render([subject], broken, 4 * path_tracing.BATCH, QUIET)
    one, other = (stored(subject, folder, "A") for folder in (whole, broken))
    assert one.batches == other.batches == 4
    # Kept in single precision.
    np.testing.assert_allclose(one.mean, other.mean, rtol=1e-6)
    np.testing.assert_allclose(one.error, other.error, rtol=1e-3, atol=1e-9)
    assert one.mean.max() > 0


def test_the_committed_pictures_of_the_sphere_are_what_walks_say(request, tmp_path):
    found = walk_truth.make(SPHERE, 300_000, tmp_path, QUIET)
    pictures = request.config.rootpath / "docs" / "benchmarks" / "truth"
    rows = cross_checks.sphere(300_000, tmp_path, pictures, QUIET)
    eyes = [row for row in rows if "path tracing" in row.others]
    assert len(eyes) == len(SPHERE.views)
    for row in eyes:
        print(row.quantity, row.ours, row.others, row.deviations())
        # The body of path tracing has 20,480 facets and takes in .1% less.
        assert abs(row.deviations()["path tracing"]) < 3.5
        assert row.ours[1] < 0.05 * row.ours[0]
    assert found.walks == 300_000


def pmmc_there():
    missing = cross_checks.why_no_pmmc()
    if missing:
        pytest.skip(missing)


def test_pmmc_s_slab_is_that_of_discrete_ordinates():
    pmmc_there()
    medium = media("skin1")[0]
    found, exact = pmmc_walk.slab(medium, 5.0, 1.0, 200_000, 3), discrete_ordinates(medium, 5.0, 1.0, False)
    expected = np.array([exact.reflectance, exact.transmittance, exact.absorbed, exact.unscattered])
    print("standard errors apart:", (found.mean - expected) / found.error)
    assert (np.abs(found.mean - expected) < 4 * found.error).all()
    assert found.mean.sum() == pytest.approx(1, abs=1e-9)


def test_pmmc_s_ball_is_that_of_our_walks():
    pmmc_there()
    medium = Medium(0.5, 0.05)
    found = pmmc_walk.sphere(meshes.ball(10.0, 1), medium, 1.0, 10, 24, 240_000, 3)
    ours = monte_carlo.sphere(medium, 10.0, 1.0, 10, 240_000, 4)
    apart = (found.mean - ours.mean) / np.hypot(found.error, ours.error)
    print("standard errors apart:", apart)
    # The facets take in .4% less light, at the rim for the most part.
    assert (np.abs(found.mean - ours.mean) < 4 * np.hypot(found.error, ours.error) + 0.01 * ours.mean).all()


def test_the_command_says_what_is_left_out(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(cross_checks, "SLABS", (("ketchup", 2, 1.0),))

    def absent():
        raise InputError("pmmc is not there; pip install 'validation[truth]'")

    monkeypatch.setattr(pmmc_walk, "load", absent)
    base = ["reference", "--kind", "walk", "--walks", "20000", "--truth", str(tmp_path)]
    assert cli.main([*base, "slab"]) == 0
    said = capsys.readouterr()
    assert "left out: pmmc is not there; pip install 'validation[truth]'" in said.err
    assert "ordinates" in said.out
    assert cli.main([*base, "bunny"]) == 1
    assert "scene 'bunny': allowed with --kind walk are sphere, slab" in capsys.readouterr().err
