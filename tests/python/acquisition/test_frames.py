"""Single exposures: linear files come in as they are, pictures for displays are refused, and so are files that lie."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import board_photographs
from quadgraph import core
from quadgraph.acquisition.session import exr_writer, frames
from quadgraph.base.errors import InputError

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

BLACK, WHITE = 512, 15000


def test_sixteen_bits_come_in_linear(tmp_path):
    pytest.importorskip("cv2", reason="OpenCV is not installed: pip install 'quadgraph[capture]'")
    values = np.random.default_rng(1).integers(0, 65536, (9, 11, 3)).astype(np.uint16)
    board_photographs.write_png(tmp_path / "a.png", values)
    found = frames.read("here", tmp_path / "a.png", None)
    np.testing.assert_allclose(found.values, values / 65535, atol=1e-7)
    np.testing.assert_array_equal(found.saturated, found.values >= 0.98)


def test_exr_comes_in_as_it_was_written(tmp_path):
    values = np.random.default_rng(2).gamma(0.3, 20, (37, 53, 3)).astype(np.float32)
    exr_writer.write(tmp_path / "a.exr", values)
    found = frames.read("here", tmp_path / "a.exr", None)
    np.testing.assert_array_equal(found.values, values)
    assert not found.saturated.any()
    np.testing.assert_array_equal(frames.read("here", tmp_path / "a.exr", 5.0).saturated, values >= 5)


def test_exr_is_what_openexr_reads(tmp_path):
    reader = pytest.importorskip("OpenEXR", reason="OpenEXR is not installed: run tools/setup")
    values = np.random.default_rng(3).normal(size=(31, 17, 3)).astype(np.float32)
    values[:16] = 0.25  # lines that shrink, and lines that do not
    exr_writer.write(tmp_path / "a.exr", values)
    np.testing.assert_array_equal(reader.File(str(tmp_path / "a.exr")).channels()["RGB"].pixels, values)
    assert core.read_image(tmp_path / "a.exr").shape == values.shape


def test_pictures_for_displays_are_refused_with_what_to_do(tmp_path):
    picture = Image.fromarray(np.full((20, 20, 3), 99, np.uint8))
    picture.save(tmp_path / "a.jpg")
    with pytest.raises(InputError, match=r"photographs\[0\]: found a\.jpg, jpg of 8 bits with a tone curve.*raw files"):
        frames.read("photographs[0]", tmp_path / "a.jpg", None)
    picture.save(tmp_path / "a.png")
    with pytest.raises(InputError, match=r"a\.png has 8 bits a channel.*not linear.*develop the raw file"):
        frames.read("photographs[0]", tmp_path / "a.png", None)
    (tmp_path / "a.tif").write_bytes(b"")
    with pytest.raises(InputError, match=r"found a\.tif, allowed are \.png of 16 bits, \.exr, and raw files"):
        frames.read("photographs[0]", tmp_path / "a.tif", None)


def test_a_png_that_states_a_huge_size_is_refused_before_it_is_read(tmp_path):
    head = struct.pack(">IIBBBBB", 60_000, 60_000, 16, 2, 0, 0, 0)
    chunk = b"IHDR" + head
    data = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk + struct.pack(">I", zlib.crc32(chunk))
    (tmp_path / "a.png").write_bytes(data)
    with pytest.raises(InputError, match="60000 x 60000 pixels, allowed are 60000000 in all"):
        frames.read("here", tmp_path / "a.png", None)
    (tmp_path / "a.png").write_bytes(data[:20])
    with pytest.raises(InputError, match="is no PNG"):
        frames.read("here", tmp_path / "a.png", None)


def write_dng(path: Path, mosaic: np.ndarray) -> None:
    """A raw file of (h, w) uint16, red in its upper left corner: the least of a DNG, without compression."""
    high, wide = mosaic.shape
    short, long, byte, text, rational, signed = 3, 4, 1, 2, 5, 10
    matrix = struct.pack("<18i", *(value for cell in np.eye(3, dtype=int).ravel().tolist() for value in (cell, 1)))
    entries = [
        (254, long, struct.pack("<I", 0)),
        (256, long, struct.pack("<I", wide)),
        (257, long, struct.pack("<I", high)),
        (258, short, struct.pack("<H", 16)),
        (259, short, struct.pack("<H", 1)),
        (262, short, struct.pack("<H", 32803)),  # a colour filter array
        (271, text, b"Test\0"),
        (272, text, b"Camera\0"),
        (273, long, b""),  # where the pixels are
        (277, short, struct.pack("<H", 1)),
        (278, long, struct.pack("<I", high)),
        (279, long, struct.pack("<I", 2 * wide * high)),
        (33421, short, struct.pack("<HH", 2, 2)),
        (33422, byte, bytes([0, 1, 1, 2])),
        (34665, long, b""),  # where shutter, f-number and speed are
        (50706, byte, bytes([1, 4, 0, 0])),
        (50708, text, b"Test Camera\0"),
        (50714, long, struct.pack("<I", BLACK)),
        (50717, long, struct.pack("<I", WHITE)),
        (50721, signed, matrix),
    ]
    exif = [
        (33434, rational, struct.pack("<II", 1, 50)),
        (33437, rational, struct.pack("<II", 4, 1)),
        (34855, short, struct.pack("<H", 200)),
    ]
    blank = [(tag, kind, data or bytes(4)) for tag, kind, data in entries]
    first = 8 + len(_table(blank, 8))
    places = {34665: struct.pack("<I", first), 273: struct.pack("<I", first + len(_table(exif, first)))}
    entries = [(tag, kind, places.get(tag, data)) for tag, kind, data in entries]
    tables = _table(entries, 8) + _table(exif, first)
    path.write_bytes(b"II*\0" + struct.pack("<I", 8) + tables + mosaic.astype("<u2").tobytes())


def _table(entries: list[tuple[int, int, bytes]], at: int) -> bytes:
    """A TIFF's table that begins at a byte, and behind it what has no room there."""
    byte, text, short, long, rational, signed = 1, 2, 3, 4, 5, 10
    sizes = {byte: 1, text: 1, short: 2, long: 4, rational: 8, signed: 8}
    place = at + 2 + 12 * len(entries) + 4
    table, more = struct.pack("<H", len(entries)), b""
    for tag, kind, data in entries:
        table += struct.pack("<HHI", tag, kind, len(data) // sizes[kind])
        if len(data) > 4:
            table += struct.pack("<I", place + len(more))
            more += data + b"\0" * (len(data) % 2)
        else:
            table += data.ljust(4, b"\0")
    return table + b"\0\0\0\0" + more


def test_four_pixels_of_a_raw_file_become_one_and_nothing_else_is_done(tmp_path):
    pytest.importorskip("rawpy", reason="rawpy is not installed: pip install 'quadgraph[capture]'")
    mosaic = np.random.default_rng(4).integers(BLACK - 20, 16000, (64, 96)).astype(np.uint16)
    write_dng(tmp_path / "a.dng", mosaic)
    found = frames.read("here", tmp_path / "a.dng", None)
    share = (mosaic.astype(float) - BLACK) / (WHITE - BLACK)
    green = (share[::2, 1::2] + share[1::2, ::2]) / 2
    wanted = np.stack([share[::2, ::2], green, share[1::2, 1::2]], axis=2)
    np.testing.assert_allclose(found.values, wanted, atol=1e-6)
    np.testing.assert_array_equal(found.shares, [1, 0.5, 1])
    saturated = np.maximum(share[::2, 1::2], share[1::2, ::2]) >= 0.98
    np.testing.assert_array_equal(found.saturated[..., 1], saturated)
    assert found.exposure == pytest.approx(200 / 100 / 50 / 16)


def test_what_is_no_raw_file_is_refused(tmp_path):
    pytest.importorskip("rawpy", reason="rawpy is not installed: pip install 'quadgraph[capture]'")
    (tmp_path / "a.dng").write_bytes(b"II*\0" + bytes(200))
    with pytest.raises(InputError, match=r"a\.dng cannot be read as a raw file"):
        frames.read("here", tmp_path / "a.dng", None)


def test_without_rawpy_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "rawpy", None)
    (tmp_path / "a.dng").write_bytes(b"")
    with pytest.raises(InputError, match=r"pip install 'quadgraph\[capture\]'"):
        frames.read("here", tmp_path / "a.dng", None)
