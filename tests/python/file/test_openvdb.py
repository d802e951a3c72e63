"""Volumes from OpenVDB files. Where OpenVDB's Python module is not installed only what is said then is tested."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from quadgraph import cli
from quadgraph.base.errors import ToolError
from quadgraph.file import openvdb

SHAPE = (5, 4, 6)  # z, y, x


@pytest.fixture(scope="module")
def python() -> Path:
    """A Python that has OpenVDB."""
    try:
        return openvdb.OPENVDB.path()
    except ToolError as error:
        pytest.skip(str(error))


def made(python: Path, path: Path, script: str) -> Path:
    """Write a .vdb by a script that fills `grids`."""
    either = "try:\n    import openvdb as vdb\nexcept ImportError:\n    import pyopenvdb as vdb\n"
    text = f"import sys, numpy as np\n{either}grids = []\n{script}\nvdb.write(sys.argv[1], grids)\n"
    subprocess.run([python, "-c", text, str(path)], check=True, capture_output=True)
    return path


DENSITY = """
values = np.arange(24, dtype=np.float32).reshape(2, 3, 4) + 1
grid = vdb.FloatGrid()
grid.copyFromArray(values, ijk=(-1, 2, 0))
grid.name = "density"
grid.transform = vdb.createLinearTransform([[.2, 0, 0, 0], [0, .2, 0, 0], [0, 0, .3, 0], [1, 0, 0, 1]])
grids.append(grid)
"""


@pytest.mark.parametrize("colours", [False, True])
def test_a_volume_goes_there_and_back(python, tmp_path, colours):
    random = np.random.default_rng(1)
    scattering = random.uniform(0, 3, (*SHAPE, 3) if colours else SHAPE).astype(np.float32)
    absorption = random.uniform(0, 0.1, SHAPE).astype(np.float32)
    absorption[:, 0] = 0  # a side that is like the outside
    fields = {"sigma_s_prime": scattering, "sigma_a": absorption, "spacing": np.array([0.5, 1, 2])}
    np.savez(tmp_path / "a.npz", **fields, origin=np.array([-3.0, 4, 5]), eta=1.45)
    assert cli.main(["volume", str(tmp_path / "a.npz"), "-o", str(tmp_path / "a.vdb")]) == 0
    assert cli.main(["volume", str(tmp_path / "a.vdb"), "-o", str(tmp_path / "b.npz")]) == 0
    with np.load(tmp_path / "b.npz") as found:
        assert np.array_equal(found["sigma_s_prime"], scattering)
        assert np.array_equal(found["sigma_a"], absorption)
        assert np.allclose(found["spacing"], fields["spacing"])
        assert np.allclose(found["origin"], [-3, 4, 5])
        assert float(found["eta"]) == pytest.approx(1.45)


def test_without_an_origin_the_grid_is_centred_on_zero(python, tmp_path):
    np.savez(tmp_path / "a.npz", sigma_s_prime=np.ones(SHAPE), sigma_a=np.ones(SHAPE), spacing=2.0)
    assert cli.main(["volume", str(tmp_path / "a.npz"), "-o", str(tmp_path / "a.vdb")]) == 0
    assert cli.main(["volume", str(tmp_path / "a.vdb"), "-o", str(tmp_path / "b.npz")]) == 0
    with np.load(tmp_path / "b.npz") as found:
        assert np.allclose(found["origin"], [-5, -3, -4])


def test_what_is_known_goes_there_and_back(python, tmp_path, capsys):
    """Deviations and lengths of both coefficients, or of one; where a coefficient has colours, so have these."""
    random = np.random.default_rng(2)
    kept = {
        "sigma_s_prime": random.uniform(0, 3, SHAPE),
        "sigma_a": random.uniform(0, 0.1, (*SHAPE, 3)),
        "sigma_a_deviation": random.uniform(0, 2, (*SHAPE, 3)),
        "sigma_a_resolution": random.uniform(1, 9, (*SHAPE, 3)),
    }
    kept["sigma_a_deviation"][0] = np.inf  # not known at all
    kept["sigma_a_deviation"][-1] = 0
    for more in ({}, {"sigma_s_prime_deviation": random.uniform(0, 0.2, SHAPE)}):
        arrays = {name: values.astype(np.float32) for name, values in (kept | more).items()}
        np.savez(tmp_path / "a.npz", **arrays, spacing=1.5)
        assert cli.main(["volume", str(tmp_path / "a.npz"), "-o", str(tmp_path / "a.vdb")]) == 0
        assert all(name in capsys.readouterr().out for name in more)
        assert cli.main(["volume", str(tmp_path / "a.vdb"), "-o", str(tmp_path / "b.npz")]) == 0
        assert "with sigma_a_deviation" in capsys.readouterr().out
        with np.load(tmp_path / "b.npz") as found:
            assert set(found) == {*arrays, "spacing", "origin", "eta"}
            assert all(np.array_equal(found[name], values) for name, values in arrays.items())


def test_a_factor_leaves_the_deviations_of_a_logarithm_as_they_are(python, tmp_path):
    spread = DENSITY.replace('"density"', '"density_deviation"').replace("+ 1", "/ 10")
    vdb = made(python, tmp_path / "a.vdb", DENSITY + spread)
    options = ["--sigma-s-prime", "density*2", "--sigma-a", "density*.1/.2/.4"]
    assert cli.main(["volume", str(vdb), *options, "-o", str(tmp_path / "a.npz")]) == 0
    wanted = np.arange(24, dtype=np.float32).reshape(2, 3, 4).transpose(2, 1, 0) / 10
    with np.load(tmp_path / "a.npz") as found:
        assert np.allclose(found["sigma_s_prime_deviation"], wanted)
        assert np.allclose(found["sigma_a_deviation"], wanted[..., None])
        assert found["sigma_a_deviation"].shape == found["sigma_a"].shape
    options = ["--sigma-s-prime", "density", "--sigma-a", ".03"]
    assert cli.main(["volume", str(vdb), *options, "-o", str(tmp_path / "a.npz")]) == 0
    with np.load(tmp_path / "a.npz") as found:
        assert "sigma_a_deviation" not in found


def test_a_density_times_numbers_is_what_a_body_is_made_of(python, tmp_path, capsys):
    vdb = made(python, tmp_path / "smoke.vdb", DENSITY)
    output = tmp_path / "smoke.npz"
    options = ["--sigma-s-prime", "density*2", "--sigma-a", "density*.1/.2/.4", "--unit", "cm", "--eta", "1"]
    assert cli.main(["volume", str(vdb), *options, "-o", str(output)]) == 0
    assert "2 x 3 x 4 cells of 2 x 2 x 3 mm" in capsys.readouterr().out
    density = (np.arange(24).reshape(2, 3, 4) + 1).transpose(2, 1, 0)
    with np.load(output) as found:
        assert np.allclose(found["sigma_s_prime"], 2 * density)
        assert np.allclose(found["sigma_a"], density[..., None] * [0.1, 0.2, 0.4])
        assert np.allclose(found["origin"], [10 * (1 - 0.2), 10 * 0.4, 0])
        assert float(found["eta"]) == 1
    options = ["--sigma-s-prime", "density*2", "--sigma-a", ".03"]
    assert cli.main(["volume", str(vdb), *options, "-o", str(output)]) == 0
    with np.load(output) as found:
        assert np.all(found["sigma_a"] == np.float32(0.03))
    core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    at = core.Volume(output).at(np.array([[1 - 0.2, 0.4, 0.9]]), np.zeros(3))
    assert np.allclose(at[0], 2 * density[3, 0, 0])


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("", "grid 'density' not found, there are none"),
        (DENSITY.replace('"density"', '"fog"'), "grid 'density' not found, there are fog"),
        (DENSITY + "grid.transform.rotate(.3, vdb.Axis.Z)", "turned or mirrored"),
        (DENSITY + "grid.fill((0, 0, 0), (1, 1, 1), -1.0)", "negative"),
        ("grids.append(vdb.createLevelSetSphere(3.0))\ngrids[0].name = 'density'", "level set"),
        ("grids.append(vdb.FloatGrid())\ngrids[0].name = 'density'", "is empty"),
        ("grids.append(vdb.BoolGrid())\ngrids[0].name = 'density'", "values of type bool"),
        (DENSITY + "grids.append(grid.deepCopy())\ngrids[1].name = 'density_deviation'\n"
         "grids[1].fill((0, 0, 0), (1, 1, 1), -1)",
         "grid 'density_deviation' is negative"),
        (DENSITY + "grids.append(vdb.Vec3SGrid())\ngrids[1].copyFromArray(np.ones((2, 3, 4, 3), 'f4'))\n"
         "grids[1].transform = grid.transform\ngrids[1].name = 'density_deviation'",
         "grid 'density_deviation': vec3s found, float is wanted"),
        (DENSITY + "grid.getAccessor().setValueOn((9999, 9999, 9999))", "allowed in all"),
    ],
)  # fmt: skip
def test_a_file_that_does_not_serve_is_named_and_nothing_written(python, tmp_path, capsys, script, said):
    vdb = made(python, tmp_path / "odd.vdb", script)
    output = tmp_path / "odd.npz"
    asked = ["volume", str(vdb), "--sigma-s-prime", "density", "--sigma-a", "density*.1", "-o", str(output)]
    assert cli.main(asked) == 1
    error = capsys.readouterr().err
    assert "odd.vdb: " in error
    assert said in error
    assert "Traceback" not in error
    assert not output.exists()


def test_damaged_files_are_refused(python, tmp_path, capsys):
    vdb = made(python, tmp_path / "a.vdb", DENSITY)
    whole = vdb.read_bytes()
    for spoiled in (b"", b"no volume at all", whole[: len(whole) // 2]):
        vdb.write_bytes(spoiled)
        asked = ["volume", str(vdb), "--sigma-s-prime", "density", "--sigma-a", ".1", "-o", str(tmp_path / "a.npz")]
        assert cli.main(asked) == 1
        assert "a.vdb: " in capsys.readouterr().err
    assert cli.main(["volume", str(tmp_path / "none.vdb"), "-o", str(tmp_path / "a.npz")]) == 1
    assert "none.vdb: cannot be read" in capsys.readouterr().err
    (tmp_path / "b.npz").write_bytes(b"nothing")
    assert cli.main(["volume", str(tmp_path / "b.npz"), "-o", str(tmp_path / "b.vdb")]) == 1
    assert "b.npz: cannot be read as .npz" in capsys.readouterr().err
    assert list(tmp_path.glob("*.npz")) == [tmp_path / "b.npz"]


def test_without_the_library_it_is_said_what_to_install(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(openvdb, "_has_module", lambda python: False)
    (tmp_path / "a.vdb").write_bytes(b"")
    assert cli.main(["volume", str(tmp_path / "a.vdb"), "-o", str(tmp_path / "a.npz")]) == 1
    error = capsys.readouterr().err
    assert "apt install python3-openvdb" in error
    assert "QUADGRAPH_OPENVDB_PYTHON" in error


@pytest.mark.parametrize("option", ["density*-1", "density*1/2", "density*x"])
def test_a_factor_that_is_none_is_wrong_usage(tmp_path, option):
    with pytest.raises(SystemExit) as ended:
        cli.main(["volume", "a.vdb", "--sigma-a", option, "-o", "a.npz"])
    assert ended.value.code == 2
