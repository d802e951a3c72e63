"""Real meshes, baked and solved with the defaults: the balance, the sign, and what is reported."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

# shared/meshes/README.md: thin limbs are looked at in every run, beside the bunny
MESHES = ["spot"]
OTHERS = ["armadillo", "buddha", "bunny", "dragon", "fandisk", "fertility", "gargoyle", "heptoroid", "igea"]
OTHERS += ["lucy", "twirl"]


def check(path: Path) -> None:
    """Solve both models; every watt is accounted for, none comes out negative."""
    engine = _core.Engine(path, validation=True)
    for material, model in (("marble", "diffusion"), ("skin1", "sp3"), ("marble-veins", "sp3")):
        engine.set_material(material)
        engine.set_lights(["directional:0.2,-0.5,-1:1", "point:80,80,0:2000"])
        report = engine.solve(tolerance=1e-6)
        field = engine.surface_field()
        balance = np.abs(report["energy"]["balance"]).max()
        clipped, replaced = max(report["clipped"]), report["replaced"]
        print(f"{path.stem} {material}: balance {balance:.1e}, clipped {clipped:.1e} {replaced}")
        assert report["model"] == model
        assert all(level["converged"] for level in report["levels"])
        assert replaced == "" or replaced.startswith("fmg-pcg by dpcg: ")
        assert balance < 1e-5
        assert field["exitance"].min() >= 0
        assert np.isfinite(field["exitance"]).all()
        assert min(report["energy"]["scattered_out"]) > 0
        if model == "sp3":  # whatever the slivers did to the cycles, the answer is that of the plain solver
            engine.solve(tolerance=1e-6, solver="dpcg")
            plain = engine.surface_field()["exitance"]
            assert np.abs(field["exitance"] - plain).max() < 1e-4 * plain.max()
    assert engine.validation_messages == []


def test_the_bundled_bunny(small_bunny):
    check(small_bunny)


@pytest.mark.parametrize("name", [*MESHES, *(pytest.param(name, marks=pytest.mark.long) for name in OTHERS)])
def test_shared_meshes(small_body, name):
    check(small_body(name))
