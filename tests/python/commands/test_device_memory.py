"""Device memory: `info` tells what a solve and its picture allocate, and later frames allocate nothing."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from quadgraph import cli
from quadgraph.baking import pipeline
from quadgraph.commands import device_memory, scene_options
from shapes import icosphere, torus, write_obj

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, Path]:
    """A ring that sees itself, and a ball that does not know."""
    folder = tmp_path_factory.mktemp("memory")
    paths = {}
    for name, surface, rays in (("ring", torus(), 64), ("ball", icosphere(3, 10), 0)):
        mesh = write_obj(surface, folder / f"{name}.obj")
        paths[name] = folder / f"{name}.qgraph"
        pipeline.bake(mesh, paths[name], pipeline.BakeOptions(unit="mm", levels=2, visibility_rays=rays))
    return paths


def engine_on(path: Path, material: str):
    engine = _core.Engine(path, validation=True)
    engine.set_material(material)
    engine.set_lights(_core.default_lights())
    return engine


@pytest.mark.parametrize("name", ["ring", "ball"])
def test_info_tells_what_is_allocated_to_the_byte(files, name, capsys):
    assert cli.main(["info", str(files[name]), "--json"]) == 0
    entries = json.loads(capsys.readouterr().out)["device_memory"]["entries"]
    assert {entry["model"] for entry in entries} == {"diffusion", "sp3"}
    for entry in entries:
        engine = engine_on(files[name], entry["material"])
        engine.solve(model=entry["model"])
        engine.render(width=16, height=16)
        used = {use["purpose"]: use["bytes"] for use in engine.memory()}
        picture = used.pop("picture")  # its targets, which are as large as it is and are kept for the next one
        assert used == entry["purposes"]
        assert engine.device_bytes - picture == entry["total"] == sum(entry["purposes"].values())
        assert not engine.validation_messages
    by_way = {(entry["model"], entry["material"]): entry["solve"] for entry in entries}
    for model in ("diffusion", "sp3"):
        uneven, even = by_way[model, device_memory.VARIED_MATERIAL], by_way[model, scene_options.default_of("material")]
        assert even < uneven
    assert by_way["diffusion", "marble"] < by_way["sp3", "marble"]


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
def test_frames_with_other_light_and_material_allocate_nothing(files, model):
    engine = engine_on(files["ring"], "marble-veins")
    allocated = []
    for frame in range(6):
        engine.set_material(("marble-veins", "skin1", "marble")[frame % 3])
        engine.set_lights(
            [f"directional:{frame},1,-2:1/{frame}/2", f"ambient:0.{frame}1", f"directional:1,{frame},2:1"]
        )
        engine.solve(model=model)
        allocated.append(engine.allocation_count)
    assert allocated[0] < allocated[2] == allocated[-1]


def test_info_says_so_where_there_is_no_device(files, monkeypatch, capsys):
    def fails(_path: Path) -> None:
        raise device_memory.QuadGraphError("no device")

    monkeypatch.setattr(device_memory, "measure", fails)
    assert cli.main(["info", str(files["ball"])]) == 0
    assert "device memory: unknown, no device" in capsys.readouterr().out
