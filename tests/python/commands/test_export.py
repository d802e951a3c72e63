"""Bodies as glTF: what is written is read again as what it was, and what cannot be written is named."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest

import nested_cubes
import tiny
import two_cubes
from quadgraph import Material
from quadgraph.cli import main
from quadgraph.mesh import gltf_file, mesh_io
from quadgraph.mesh.looks import gltf_media

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


def document_of(path) -> dict:
    return gltf_file.read(path, lambda file: file.document)


BY_NUMBERS = ("sigma_s_prime=0,sigma_a=.1/.2/.3,eta=1.5", "sigma_s=20,g=.9,sigma_a=.1")


@pytest.mark.parametrize("text", ["milk", "skin1", "honey", *BY_NUMBERS])
def test_a_material_is_read_as_it_was_written(tmp_path, text):
    out = tmp_path / "body.glb"
    assert main(["export", str(tiny.PATH), "--material", text, "-o", str(out)]) == 0
    wanted = Material.parse(text)
    material = document_of(out)["materials"][0]
    medium, said = gltf_media.medium_of("here", material["extensions"])
    assert medium is not None
    assert said == ""
    assert np.array(medium.sigma_s_prime) / 1000 == pytest.approx(np.broadcast_to(wanted.sigma_s_prime, 3), rel=1e-6)
    assert np.array(medium.sigma_a) / 1000 == pytest.approx(np.broadcast_to(wanted.sigma_a, 3), rel=1e-5, abs=1e-7)
    assert gltf_media.eta_of("here", material["extensions"]) == pytest.approx(wanted.eta)
    roughness = 0.3 if wanted.roughness is None else wanted.roughness
    assert material["pbrMetallicRoughness"]["roughnessFactor"] ** 2 == pytest.approx(roughness)


@pytest.mark.parametrize(("coat", "factor"), [("lacquer", 1), ("0.4", 0.4), ("water", (0.333 / 2.333) ** 2 / 0.04)])
def test_a_coat_is_written_as_one_that_mirrors_as_much(tmp_path, coat, factor):
    out = tmp_path / "body.glb"
    assert main(["export", str(tiny.PATH), "--material", f"milk,coat={coat}", "-o", str(out)]) == 0
    extensions = document_of(out)["materials"][0]["extensions"]
    written = extensions["KHR_materials_clearcoat"]
    assert written["clearcoatFactor"] == pytest.approx(factor, rel=1e-4)
    assert written["clearcoatRoughnessFactor"] ** 2 == pytest.approx(0.02 if coat == "water" else 0.03)
    (note,) = gltf_media.coat_note("here", extensions)
    said = note.partition(": a clear coat, which no volume has: ,")[2].partition(" behind")[0]
    assert Material.parse(f"milk,{said}").coat == pytest.approx(factor, abs=0.01)


def test_a_bare_material_is_written_without_a_coat(tmp_path):
    out = tmp_path / "body.glb"
    assert main(["export", str(tiny.PATH), "--material", "milk", "-o", str(out)]) == 0
    extensions = document_of(out)["materials"][0]["extensions"]
    assert "KHR_materials_clearcoat" not in extensions
    assert gltf_media.coat_note("here", extensions) == []


def test_the_mesh_is_the_display_s_in_metres(tmp_path):
    out = tmp_path / "body.glb"
    assert main(["export", str(tiny.PATH), "-o", str(out)]) == 0
    display = core.load(tiny.PATH).display
    surface = mesh_io.read_surface(out, unit="m").surface
    assert len(surface.triangles) == len(display["triangles"])
    low, high = (end(surface.vertices, axis=0) for end in (np.min, np.max))
    assert low == pytest.approx(display["vertices"].min(axis=0), abs=1e-4)
    assert high == pytest.approx(display["vertices"].max(axis=0), abs=1e-4)
    data = out.read_bytes()
    assert struct.unpack("<4sII", data[:12]) == (b"glTF", 2, len(data))
    accessors = document_of(out)["accessors"]
    assert accessors[0]["min"] == pytest.approx((low / 1000).tolist(), abs=1e-6)


def test_bodies_are_parts_with_their_materials(tmp_path, capsys):
    out = tmp_path / "two.glb"
    names = core.load(two_cubes.PATH).bodies
    materials = ["--material", "skin1", "--material-of", f"{names[1]}=milk"]
    assert main(["export", str(two_cubes.PATH), *materials, "-o", str(out)]) == 0
    document = document_of(out)
    assert [node["name"] for node in document["nodes"]] == list(names)
    assert [material["name"] for material in document["materials"]] == [f"{names[0]}: skin1", f"{names[1]}: milk"]
    assert "KHR_materials_volume_scatter" in document["extensionsUsed"]
    assert names[1] in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([str(tiny.PATH), "-o", "out.obj"], "out.obj: output must end in .glb"),
        ([str(tiny.PATH), "--material", "jade", "-o", "out.glb"], "pattern"),
        ([str(tiny.PATH), "--material", "some.npz", "-o", "out.glb"], "allowed is one throughout"),
        ([str(tiny.PATH), "--material-of", "lid=milk", "-o", "out.glb"], "found 'lid', the file has one body"),
        ([str(nested_cubes.PATH), "-o", "out.glb"], "inner: lies within another body"),
        (["nothing.qgraph", "-o", "out.glb"], "nothing.qgraph: cannot be read"),
    ],
)
def test_what_gltf_cannot_say_is_refused(tmp_path, monkeypatch, capsys, arguments, message):
    monkeypatch.chdir(tmp_path)
    assert main(["export", *arguments]) == 1
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_albedos_of_many_events_are_those_of_one_inverted():
    single = np.linspace(0, 1, 101)
    back = gltf_media.single_scatter_albedo(gltf_media.many_scatter_albedo(single), 0.0)
    assert back == pytest.approx(single, abs=1e-5)  # of the fit, which begins there
    clear = gltf_media.extensions_of(np.zeros(3), np.zeros(3), 1.5, 0.1)
    assert "Infinity" not in json.dumps(clear)
    assert "NaN" not in json.dumps(clear)
