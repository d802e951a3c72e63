"""Captures are read strictly: what is wrong is named by its path, with what was found and what is allowed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from PIL import Image
from referencing import Registry, Resource

import tiny
import twin_capture
from quadgraph.acquisition.capture import capture, photographs
from quadgraph.base.errors import InputError

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

DOCS = Path(__file__).resolve().parents[3] / "docs"
NOISE = {"read_out": 0.001, "shot": 0.0001}


@pytest.fixture
def folder(tmp_path) -> Path:
    """A folder with a body and two photographs."""
    (tmp_path / "potato.qgraph").write_bytes(tiny.PATH.read_bytes())
    generator = np.random.default_rng(1)
    for name in ("a", "b"):
        np.savez(tmp_path / f"{name}.npz", photograph=generator.uniform(0.1, 0.9, (40, 40, 3)))
    return tmp_path


def stated() -> dict[str, Any]:
    """A capture that is fine."""
    photograph = {"camera": "front", "lights": ["key"], "noise": NOISE}
    return twin_capture.document([{"file": "a.npz"} | photograph, {"file": "b.npz"} | photograph])


def put(document: dict[str, Any], path: str, value: object) -> None:
    """Set a member, `photographs.0.gain`, or take it away with None."""
    *parents, last = path.split(".")
    at: Any = document
    for name in parents:
        at = at[int(name)] if isinstance(at, list) else at[name]
    if value is None:
        del at[last]
    else:
        at[last] = value


def schema() -> jsonschema.Draft202012Validator:
    """The published schema, which leads to that of scenes."""
    scene = json.loads((DOCS / "scene.schema.json").read_text())
    registry = Registry().with_resource("scene.schema.json", Resource.from_contents(scene))
    return jsonschema.Draft202012Validator(json.loads((DOCS / "capture.schema.json").read_text()), registry=registry)


def read(folder: Path, document: dict[str, Any]) -> capture.Capture:
    """Write and read."""
    (folder / "capture.json").write_text(json.dumps(document))
    return capture.read(folder / "capture.json")


def test_a_capture_is_read_as_it_stands(folder):
    document = stated()
    put(document, "photographs.0.gain", "camera")
    put(document, "photographs.1.saturation", 0.8)
    schema().validate(document)
    found = read(folder, document)
    assert [each.gain for each in found.photographs] == ["camera", "photographs[1]"]
    assert found.sizes["front"] == (40, 40)
    assert found.photographs[0].noise == capture.NoiseModel(0.001, 0.0001)
    measured = photographs.read_all(found)
    np.testing.assert_array_equal(measured[1].usable, measured[1].values < 0.8)
    np.testing.assert_allclose(measured[0].variance_of(measured[0].values), 1e-6 + 1e-4 * measured[0].values)


def test_the_example_of_the_page_is_what_schema_and_program_take(folder):
    page = (DOCS / "acquisition.md").read_text()
    document = json.loads(page.split("```json\n")[1].split("```")[0])
    schema().validate(document)
    files = [document["body"]]
    files += [each[name] for each in document["photographs"] for name in ("file", "variance", "mask") if name in each]
    for name in files:
        (folder / name).write_bytes(b"")
    assert len(read(folder, document).photographs) == 2


WRONG = [
    ("photographs.0.camera", "left", 'photographs[0].camera: found "left", allowed are front, back'),
    ("photographs.1.lights", ["keys"], 'photographs[1].lights[0]: found "keys", allowed are key, sun (did you mean'),
    ("photographs.1.lights", ["key", "key"], "photographs[1].lights: found"),
    ("photographs.0.exposure", -1, "photographs[0].exposure: found -1, allowed is a number above 0"),
    ("photographs.0.gain", True, "photographs[0].gain: found true"),
    ("photographs.0.gains", 1, "photographs[0].gains: found 1, allowed is nothing of this name (did you mean 'gain'?)"),
    ("photographs.0.file", "c.npz", 'photographs[0].file: found "c.npz", allowed is the name of a file that is there'),
    ("photographs.0.noise", None, "photographs[0]: neither of variance and noise found, allowed is one"),
    ("photographs.0.noise.shot", -1, "photographs[0].noise.shot: found -1"),
    ("photographs.0.noise", {"read_out": 0, "shot": 0}, "photographs[0].noise: found"),
    ("photographs", [], "photographs: found 0 items, allowed is a list of 1 to 1024"),
    ("cameras.front.width", None, "cameras.front.width: is missing"),
    ("cameras.front.width", 100000, "cameras.front.width: found 100000, allowed is a whole number from 8 to 4096"),
    ("cameras.front.fow", 3, "cameras.front.fow: found 3"),
    ("cameras.front", 3, "cameras.front: found 3, allowed is an object"),
    ("lights.key.powr", 3, "lights.key.powr: found 3, allowed is nothing of this name"),
    ("lights.key.power", -3, "lights.key: light"),
    ("lights", {}, "lights: found {}, allowed is an object with at least one member"),
    ("eta", 0.5, "eta: found 0.5, allowed is a number from 1 to 3"),
    ("eta", None, "eta: is missing"),
    ("quadgraph_capture", 2, "quadgraph_capture: found 2"),
    ("polarised", 1, "polarised: found 1, allowed are true and false"),
    ("unit", "inch", 'unit: found "inch", allowed are mm, cm, m'),
    ("solver", {"correction": False}, "solver.correction: found false, allowed is nothing: acquire decides it"),
    ("solver", {"tolerance": 2}, "solver: tolerance: 2.0"),
    ("deformation", [{"type": "transfrom"}], "deformation.0.type: found"),
    ("material", "wax", 'material: found "wax", allowed is nothing of this name'),
]


@pytest.mark.parametrize(("path", "value", "said"), WRONG)
def test_what_is_wrong_is_named_by_its_path(folder, path, value, said):
    document = stated()
    put(document, path, value)
    with pytest.raises(InputError) as caught:
        read(folder, document)
    assert str(caught.value).startswith(f"{folder / 'capture.json'}: {said}")
    if path not in ("photographs.0.file", "photographs.0.camera", "photographs.1.lights", "photographs.0.noise"):
        assert not schema().is_valid(document)  # names and files are beyond a schema


@pytest.mark.parametrize("text", ["", "{", "[1]", '"a"', '{"quadgraph_capture": 1', "[" * 100])
def test_what_is_no_capture_is_refused(tmp_path, text):
    path = tmp_path / "capture.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"capture\.json: "):
        capture.read(path)


def spoilt(folder: Path, name: str) -> None:
    """Write a photograph that cannot be used in place of the first."""
    generator = np.random.default_rng(2)
    fine = generator.uniform(0.1, 0.9, (40, 40, 3))
    values = {
        "size": fine[:20],
        "dark": np.zeros((40, 40, 3)),
        "nan": np.where(fine > 0.5, np.nan, fine),
        "clipped": np.minimum(fine, 0.5),
    }
    if name in values:
        np.savez(folder / "a.npz", photograph=values[name])
    elif name == "name":
        np.savez(folder / "a.npz", picture=fine)
    else:
        (folder / "a.npz").write_bytes(b"PK no")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("size", "photographs[0].file: a.npz has 40 x 20 pixels, allowed are those of its camera, 40 x 40"),
        ("dark", "found no value above 0"),
        ("nan", "not finite somewhere"),
        ("clipped", "photographs[0].saturation: not stated, and"),
        ("name", "found no array photograph"),
        ("bytes", "cannot be read as .npz"),
    ],
)
def test_a_photograph_that_cannot_be_used_is_named(folder, name, said):
    found = read(folder, stated())
    spoilt(folder, name)
    with pytest.raises(InputError) as caught:
        photographs.read_all(found)
    assert said in str(caught.value)
    assert "photographs[0]" in str(caught.value)


@pytest.mark.parametrize(("most", "refused"), [(0.5, True), (1.0, False)])
def test_values_that_end_below_the_stated_saturation_are_told_from_steps_of_few_bits(folder, most, refused):
    steps = np.random.default_rng(3).uniform(0.1, 0.9, (40, 40, 3)) * 64 // 1 / 64
    np.savez(folder / "a.npz", photograph=np.minimum(steps, most))
    document = stated()
    put(document, "photographs.0.saturation", 0.95)
    if not refused:
        assert photographs.read_all(read(folder, document))[0].usable.all()
        return
    with pytest.raises(InputError, match=r"photographs\[0\]\.saturation: found 0\.95, but .* same largest value 0\.5 "):
        photographs.read_all(read(folder, document))


def test_pictures_for_displays_are_refused(folder):
    Image.fromarray(np.full((40, 40, 3), 99, np.uint8)).save(folder / "a.png")
    document = stated()
    put(document, "photographs.0.file", "a.png")
    with pytest.raises(InputError, match=r"8 bits a channel.*sRGB.*allowed are linear"):
        photographs.read_all(read(folder, document))
    put(document, "photographs.0.file", "a.npz")
    Image.fromarray(np.full((40, 40, 3), 255, np.uint8)).save(folder / "mask.png")
    put(document, "photographs.0.mask", "mask.png")  # of a mask nobody minds
    assert photographs.read_all(read(folder, document))[0].usable.all()
