"""Scene files, volumes and images that are made to exhaust memory or the stack: refused by name, and nothing ends."""

from __future__ import annotations

import io
import json
import os
import re
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest

import tiny
from quadgraph import Engine
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_file

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

DEEP = "[" * 200_000 + "]" * 200_000


@pytest.mark.parametrize("key", ["material", "lights", "tracks", "unknown"])
@pytest.mark.parametrize("value", [DEEP, '{"lights":' * 100_000 + "1" + "}" * 100_000])
def test_deep_scenes_are_refused_with_their_place(tmp_path, key, value):
    path = tmp_path / "scene.json"
    path.write_text(f'{{"body": "a.qgraph",\n"{key}": {value}}}')
    with pytest.raises(Exception, match=r"scene\.json: JSON nested deeper than 64 levels at line 2, column \d+"):
        core.SceneFile(path)


@pytest.mark.parametrize(
    ("text", "place"), [('{"body": ]', "line 1, column 10"), ('{\n"a": 1,\n  x}', "line 3, column 3")]
)
def test_what_is_no_json_is_said_with_line_and_column(tmp_path, text, place):
    path = tmp_path / "scene.json"
    path.write_text(text)
    with pytest.raises(Exception, match=place):
        core.SceneFile(path)


def refusal(path: Path, document: dict | str) -> str:
    """What is said of a scene file."""
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    with pytest.raises(InputError) as error:
        core.SceneFile(path)
    assert len(str(error.value)) < 480
    return str(error.value)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("1e999", "beyond double precision at line 2, column 12: found 1e999"),
        ("-" + "9" * 5000, f"beyond double precision at line 2, column 12: found -{'9' * 39},"),
        ("123456789012345678901234567890", "/frames: found 1.2345678901234568e+29, allowed is a whole number from 1"),
        ("18446744073709551616", "/frames: found 1.8446744073709552e+19, allowed"),
        ("-9223372036854775809", "/frames: found -9.223372036854776e+18, allowed"),
    ],
)
def test_numbers_beyond_64_bits_are_said_with_their_place(tmp_path, value, message):
    assert message in refusal(tmp_path / "scene.json", f'{{"body": "a.qgraph",\n "frames": {value}}}')


def test_a_scene_without_a_body_is_refused(tmp_path):
    assert '/body: found "", allowed is the name of a .qgraph file' in refusal(tmp_path / "scene.json", {"body": ""})


LIGHT = {"type": "ambient", "irradiance": 1}


def tracked(path: str, keys: list, **more: object) -> dict:
    return {"body": "a.qgraph", "tracks": [{"path": path, "keys": keys}], **more}


def test_keys_are_checked_with_what_they_change_alone(tmp_path):
    """300,000 keys beside 1,000 lights: the whole scene at each of them would take minutes."""
    document = tracked("/camera/azimuth", [[i, i % 360] for i in range(300_000)], lights=[LIGHT] * 1000)
    (tmp_path / "scene.json").write_text(json.dumps(document))
    assert core.SceneFile(tmp_path / "scene.json").frames == 300_000
    document = tracked("/lights/999/irradiance", [[0, 1], [10, -1]], lights=[LIGHT] * 1000)
    assert "/lights/999: light 'ambient:-1', irradiance: found -1" in refusal(tmp_path / "scene.json", document)


def test_more_values_at_keys_than_are_checked_are_refused(tmp_path):
    edit = {"operation": "multiply", "sigma_a": 2, "stroke": [[i, 0, 0] for i in range(10_000)], "radius": 1}
    document = tracked("/edits/0/radius", [[i, 1] for i in range(10_000)], edits=[edit])
    assert "/tracks: found keys that change 400090000 values" in refusal(tmp_path / "scene.json", document)


@pytest.mark.parametrize(
    "content", [b"", b"\x76\x2f\x31\x01", b"\x76\x2f\x31\x01\2\0\0\0", b"\x76\x2f\x31\x01\2\0\0\0chan"]
)
def test_an_image_that_ends_in_its_header_is_named_with_a_reason(tmp_path, content):
    (tmp_path / "short.exr").write_bytes(content)
    placed = {"image": "short.exr", "placement": {"centre": [0, 0, 0], "size": [1, 1, 1]}}
    said = refusal(tmp_path / "scene.json", {"body": "a.qgraph", "picture": {"roughness_map": placed}})
    assert re.search(r"short\.exr: \w+", said)


@pytest.mark.parametrize("key", ["front", "unknown"])
def test_deep_metadata_is_refused_in_both_languages(tmp_path, key):
    path = tmp_path / "deep.qgraph"
    text = json.dumps(tiny.metadata(tiny.graphs()))[:-1] + f', "{key}": {DEEP}}}'
    everything = {"metadata": np.frombuffer(text.encode(), np.uint8), **tiny.all_sections()}
    header, table = qgraph_file._head(everything)
    pieces = [header.tobytes() + table.tobytes(), *(array.tobytes() for array in everything.values())]
    path.write_bytes(b"".join(piece.ljust(-(-len(piece) // 64) * 64, b"\0") for piece in pieces))
    with pytest.raises(Exception, match=r"metadata: JSON nested deeper than 64"):
        core.Engine(path, device="cpu")
    with pytest.raises(FormatError, match="metadata"):
        qgraph_file.read(path)


def npz(path: Path, **members: tuple[str, bytes]) -> Path:
    """Members as a header of .npy and data."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, (header, data) in members.items():
            text = header.encode() + b"\n"
            archive.writestr(f"{name}.npy", b"\x93NUMPY\x02\0" + struct.pack("<I", len(text)) + text + data)
    return path


def head(descr: str = "<f8", shape: str = "2, 2, 2", more: str = "") -> str:
    return f"{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}{more}"


GRID = (head(), np.ones(8).tobytes())
SPACING = (head(shape=""), np.ones(1).tobytes())


@pytest.mark.parametrize(
    ("header", "message"),
    [
        (head(descr="f" * 300_000), "header that is none"),
        (head(shape="1, " * 100_000), "more than 8 axes"),
        (head(shape="9" * 100), "header that is none"),
        (head(shape="2, x"), "header that is none"),
        ("", "header that is none"),
    ],
)
def test_headers_of_arrays_that_are_none_are_refused(tmp_path, header, message):
    path = npz(tmp_path / "v.npz", sigma_s_prime=(header, GRID[1]), sigma_a=GRID, spacing=SPACING)
    with pytest.raises(Exception, match=message) as error:
        core.Volume(path)
    assert len(str(error.value)) < 500


def test_good_volumes_are_read_as_before(tmp_path):
    padded = (head(more=" " * 2_000_000), GRID[1])
    path = npz(tmp_path / "v.npz", sigma_s_prime=padded, sigma_a=GRID, spacing=SPACING)
    assert core.Volume(path).eta > 1
    stored = io.BytesIO()
    np.savez(stored, sigma_s_prime=np.ones((3, 2, 2, 3), "f4"), sigma_a=np.ones((3, 2, 2)), spacing=[1.0, 2.0, 3.0])
    path.write_bytes(stored.getvalue())
    core.Volume(path)


def test_members_that_fill_memory_or_that_nobody_asks_for_are_not_read(tmp_path):
    path = tmp_path / "v.npz"
    for name, message in (("sigma_a", "packed in"), ("junk", "junk: not known")):
        deflated = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1)
        with deflated as archive, archive.open(f"{name}.npy", "w") as member:
            member.write(b"\x93NUMPY\x01\0" + struct.pack("<H", 118) + head(shape="400, 400, 400").ljust(118).encode())
            for _ in range(400):
                member.write(bytes(8 * 400 * 400))
        with pytest.raises(Exception, match=message):
            core.Volume(path)


def test_many_numbers_of_a_byte_each_are_refused_before_they_are_double_precision(tmp_path):
    path = tmp_path / "v.npz"
    np.savez_compressed(path, sigma_a=np.zeros((340, 340, 340), "u1"))
    with pytest.raises(InputError, match="39304000 numbers, a file of its size may have 33"):
        core.Volume(path)


def test_a_directory_that_says_more_than_the_file_has_is_not_believed(tmp_path):
    """Sizes of a member, packed and not, as the central directory of the archive has them."""
    path = npz(tmp_path / "v.npz", sigma_s_prime=GRID, sigma_a=GRID, spacing=SPACING)
    data = bytearray(path.read_bytes())
    struct.pack_into("<II", data, data.index(b"PK\1\2") + 20, 2_000_000_000, 4_000_000_000)
    path.write_bytes(data)
    with pytest.raises(InputError, match="has 4000000000 bytes, packed in"):
        core.Volume(path)


def test_images_that_fill_memory_are_refused_unread(tmp_path):
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    path, side = tmp_path / "big.png", 16384
    rows = zlib.compress(bytes((side // 8 + 1) * side), 9)
    kind = struct.pack(">IIBBBBB", side, side, 1, 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", kind) + chunk(b"IDAT", rows) + chunk(b"IEND", b""))
    engine = core.Engine(tiny.PATH, device="cpu")
    with pytest.raises(Exception, match="16384x16384 texels in a file of"):
        engine.set_lights([f"projector:0,0,9:0,0,-1:20:{path}:1"])


@pytest.mark.parametrize("kind", ["fifo", "link"])
def test_pictures_replace_no_pipe_and_no_link(tmp_path, kind):
    engine = core.Engine(tiny.PATH, device="cpu")
    engine.set_material("marble")
    engine.set_lights(["ambient:1"])
    engine.solve()
    picture = engine.render(width=16, height=16)
    path, target = tmp_path / "out.png", tmp_path / "target"
    target.write_text("precious")
    {"fifo": os.mkfifo, "link": lambda name: name.symlink_to(target)}[kind](path)
    for write in (lambda: picture.write_png(path, engine.metadata), lambda: picture.write_exr(path, engine.metadata)):
        with pytest.raises(Exception, match="allowed is a regular file or a new name"):
            write()
    assert target.read_text() == "precious"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.png", "target"]


def test_what_is_no_utf8_in_a_file_is_repeated_all_the_same(tmp_path):
    path = tmp_path / "sky.hdr"
    path.write_bytes(b"#?RADIANCE\nFORMAT=\xff\xfe\n\n-Y 1 +X 1\nabcd")
    with pytest.raises(Exception, match=r"sky\.hdr: found 'FORMAT=\\xff\\xfe', expected"):
        Engine(tiny.PATH, device="cpu").lights = [f"environment:{path}:0:1"]


def test_a_level_that_the_body_does_not_have_is_said_with_the_body(tmp_path):
    (tmp_path / "tiny.qgraph").write_bytes(tiny.PATH.read_bytes())
    scene = {"quadgraph_scene": 1, "body": "tiny.qgraph", "picture": {"width": 8, "height": 8, "show": "levels:9"}}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    stage = core.Stage(device="cpu")
    stage.show(core.SceneFile(tmp_path / "scene.json").at(0))
    stage.solve()
    with pytest.raises(InputError, match=r"tiny\.qgraph: show, level: found 9, expected 0 to 1"):
        stage.render()
