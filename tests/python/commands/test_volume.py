"""Volumes of coefficients: where they lie, what is between their cells, and files that are none."""

from __future__ import annotations

import numpy as np
import pytest

from baked import write_levels
from quadgraph import cli
from quadgraph.base.errors import InputError
from shapes import icosphere

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SHAPE = (5, 6, 7)  # z, y, x


def fields(**changed):
    """A file's fields: coefficients that are linear in space."""
    z, y, x = np.meshgrid(*(np.arange(n, dtype=float) for n in SHAPE), indexing="ij")
    found = {"sigma_s_prime": 1 + x + 2 * y + 3 * z, "sigma_a": 0.1 * x, "spacing": 2.0, "origin": [-6.0, -5.0, -4.0]}
    return {name: value for name, value in (found | changed).items() if value is not None}


def written(path, **changed):
    np.savez(path, **fields(**changed))
    return path


def test_between_cells_it_is_linear_and_beside_them_the_nearest(tmp_path):
    found = core.Volume(written(tmp_path / "v.npz", eta=1.5))
    assert found.eta == 1.5
    points = np.random.default_rng(1).uniform([-6, -5, -4], [6, 5, 4], (200, 3))
    x, y, z = ((points - [-6, -5, -4]) / 2).T
    scattering, absorption = found.at(points, np.zeros(3))
    assert np.allclose(scattering, (1 + x + 2 * y + 3 * z)[:, None], rtol=1e-5)
    assert np.allclose(absorption, 0.1 * x[:, None], atol=1e-6)
    assert found.at(np.array([[99.0, -5, -4]]), np.zeros(3))[1][0, 0] == pytest.approx(0.6)


def test_without_an_origin_the_grid_is_centred_on_the_body(tmp_path):
    found = core.Volume(written(tmp_path / "v.npz", origin=None))
    centre = np.array([10.0, 20.0, 30.0])
    assert found.at(centre[None], centre)[1][0, 0] == pytest.approx(0.3)


def test_a_volume_of_one_value_is_the_material_of_that_value(tmp_path):
    """Through the command line, colours apart."""
    body = write_levels(tmp_path / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])
    colours = np.broadcast_to([0.01, 0.05, 0.2], (*SHAPE, 3))
    path = written(tmp_path / "even.npz", sigma_s_prime=np.ones(SHAPE), sigma_a=colours)
    exitance = []
    for name, material in (("volume", str(path)), ("same", "sigma_s_prime=1,sigma_a=0.01/0.05/0.2")):
        field = tmp_path / f"{name}.npz"
        options = ["--model", "sp3", "--tolerance", "1e-5", "--field", str(field)]
        assert cli.main(["solve", str(body), "--material", material, *options]) == 0
        exitance.append(np.load(field)["exitance"])
    assert exitance[0] == pytest.approx(exitance[1], rel=1e-3, abs=1e-6)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sigma_a": None}, "sigma_a: not there"),
        ({"spacing": None}, "spacing: not there"),
        ({"sigma_a": np.zeros((5, 6))}, r"sigma_a: shape \(5, 6\) found"),
        ({"sigma_a": np.zeros((5, 6, 8))}, r"shapes \(5, 6, 7\) and \(5, 6, 8\) found"),
        ({"sigma_a": np.full(SHAPE, -1.0)}, "sigma_a: -1 found in number 0, allowed are"),
        ({"sigma_a": np.full(SHAPE, np.nan)}, "sigma_a: nan found in number 0"),
        ({"sigma_s_prime": np.linspace(0, 1e39, np.prod(SHAPE)).reshape(SHAPE)}, "sigma_s_prime: 4.78.*e.36 found"),
        ({"spacing": 1e300}, r"spacing: \[1e.300\] found, more than 0 and at most 1e.0?9 mm"),
        ({"spacing": np.ones(1000)}, "spacing: 1000 numbers found, 1 or 3 finite"),
        ({"origin": [0.0, 1e10, 0.0]}, r"origin: \[0, 1e.10, 0\] found, at most 1e.0?9 mm from 0"),
        ({"sigma_a": np.full(SHAPE, "x")}, "sigma_a: <U1 found, numbers wanted"),
        ({"spacing": 0.0}, r"spacing: \[0\] found"),
        ({"spacing": [1.0, 2.0]}, "1 or 3 finite"),
        ({"origin": [1.0]}, r"origin: \[1\] found, 3 finite"),
        ({"eta": 0.5}, "eta: 0.5 found, 1 to 3 allowed"),
        ({"colour": 1.0}, "colour: not known"),
    ],
)
def test_what_is_no_volume_is_refused_with_its_field(tmp_path, changed, message):
    with pytest.raises(InputError, match=message) as refused:
        core.Volume(written(tmp_path / "wrong.npz", **changed))
    assert "wrong.npz" in str(refused.value)


@pytest.mark.parametrize("kind", ["f4", "f8", "i2", "u1", "i8"])
def test_every_kind_of_number_compressed_or_not(tmp_path, kind):
    grid = np.arange(np.prod(SHAPE)).reshape(SHAPE) % 100
    for save in (np.savez, np.savez_compressed):
        save(tmp_path / "v.npz", sigma_s_prime=grid.astype(kind), sigma_a=0 * grid, spacing=1, origin=np.zeros(3))
        points = np.argwhere(grid >= 0)[:, ::-1]
        assert np.array_equal(core.Volume(tmp_path / "v.npz").at(points, (0, 0, 0))[0][:, 1], grid.ravel())


def test_a_file_that_is_cut_off_or_changed_is_refused_or_read(tmp_path):
    """Nothing else: no crash, no endless memory."""
    whole = written(tmp_path / "v.npz").read_bytes()
    random = np.random.default_rng(3)
    refused = 0
    for k in range(300):
        broken = bytearray(whole)
        for at in random.integers(0, len(whole), 4):
            broken[at] = random.integers(256)
        (tmp_path / "b.npz").write_bytes(broken if k % 2 else whole[: random.integers(len(whole))])
        try:
            core.Volume(tmp_path / "b.npz")
        except InputError as error:
            refused += "b.npz" in str(error)
    assert refused > 150


def test_what_is_no_file_is_refused(tmp_path, capsys):
    text = tmp_path / "text.npz"
    text.write_text("no zip")
    for path, said in ((text, r"cannot be read as \.npz"), (tmp_path / "absent.npz", "No such file")):
        with pytest.raises(InputError, match=said):
            core.Volume(path)
    body = write_levels(tmp_path / "ball.qgraph", [icosphere(2, 10)])
    assert cli.main(["solve", str(body), "--material", str(text)]) == 1
    assert "text.npz: cannot be read as .npz" in " ".join(capsys.readouterr().err.split()).replace("- ", "-")
