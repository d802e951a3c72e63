"""The study of `quadgraph acquire` beside Mitsuba's derivatives: its pictures, and what both find."""

from __future__ import annotations

import json

import numpy as np
import pytest

from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph_validation.accuracy import inverse_study
from quadgraph_validation.accuracy.inverse_study import SIDES, TRUE, InverseRun
from quadgraph_validation.truth import path_tracing, photographed
from quadgraph_validation.truth.traced_block import DescentStep, TracedBlock

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


def needs_mitsuba():
    try:
        path_tracing.load_mitsuba(path_tracing.COMPILED)
    except InputError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def subject(tmp_path_factory):
    """The block's scene, beside its bake."""
    folder = tmp_path_factory.mktemp("inverse")
    inverse_study.write_body(folder)
    (folder / "scene.json").write_text(json.dumps(inverse_study.scene()))
    return photographed.subject(folder / "scene.json")


def test_steps_are_shown_with_the_mean_of_the_last_of_them():
    steps = [DescentStep(number, 2 * number, np.full((2, 3), 2.0**number)) for number in range(1, 21)]
    shown = inverse_study.means(steps)
    assert [step.seconds for step in shown] == [5, 10, 20]
    assert [step.processor_s for step in shown] == [10, 20, 40]
    # The logarithms of the 16th to the 20th step.
    np.testing.assert_allclose(shown[-1].coefficients, 2.0**18)


def test_both_lights_shine_towards_the_block():
    for light in inverse_study.scene()["lights"]:
        centre, u, v = (np.array(light[name]) for name in ("centre", "u", "v"))
        np.testing.assert_allclose([np.linalg.norm(u), np.linalg.norm(v)], 40)
        np.testing.assert_allclose(np.cross(u, v) / 1600, -centre / np.linalg.norm(centre), atol=1e-12)


def test_mitsuba_sees_of_the_block_what_walks_through_its_mesh_see(subject):
    needs_mitsuba()
    pytest.importorskip("numba", reason="numba is not installed: pip install './python/validation[walks]'")
    options = photographed.PhotographOptions(size=(6, 6), walks=1024, seed=4)
    cameras = photographed.views(subject, options)
    walks = photographed.by_walks(subject, cameras, options, lambda share: None)
    block = TracedBlock(SIDES, 1)
    for (eye, light), (radiance, noise) in walks.items():
        seen, error = block.seen(block.scene(cameras[eye], subject.lights[light], TRUE), 512, 4)
        off = (seen - radiance).mean(axis=(0, 1))
        spread = np.sqrt((noise**2 + error**2).sum(axis=(0, 1))) / radiance[..., 0].size
        assert (np.abs(off) < 4.5 * spread).all(), (eye, light, off / spread)


@pytest.mark.long
def test_both_find_the_coefficients_and_the_engine_relights_better(tmp_path):
    needs_mitsuba()
    record = inverse_study.run(InverseRun("cpu", samples=(16,), steps=80, photographed=512), lambda what: None)
    rows = {row["name"]: row["trace"][-1] for row in record["rows"]}
    assert rows["acquire"]["sigma_s_prime"] < 0.03 > rows["acquire"]["relighting"]
    assert rows["acquire"]["sigma_a"] < 0.15
    assert rows["prbvolpath, 16 samples a pixel"]["sigma_s_prime"] < 0.1
    assert inverse_study.tables(record)[0].row_count == 3


@pytest.mark.parametrize("study", ["wide-field", "inverse"])
def test_studies_that_time_programs_are_not_spread(study, capsys):
    assert cli.main(["accuracy", study, "--scheduler", "local:2"]) != 0
    assert "one machine" in capsys.readouterr().err
