"""Single exposures: linear files come in as they are, pictures for displays are refused, and so are files that lie."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest
from PIL import Image

import board_photographs
from dng_file import BLACK, WHITE, write_dng
from quadgraph import core
from quadgraph.acquisition.session import exr_writer, frames
from quadgraph.base.errors import InputError

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


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
