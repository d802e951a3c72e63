"""Films as .gif: frames, delays, bounds, and nothing left of one that was not finished."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from quadgraph.base.errors import InputError
from quadgraph.file import film, gif_film


def frames(count: int) -> list[np.ndarray]:
    """Frames (8, 10, 3), each of another grey with a red corner."""
    made = []
    for number in range(count):
        frame = np.full((8, 10, 3), 40 * number, np.uint8)
        frame[:4, :5] = (250, 10 * number, 0)
        made.append(frame)
    return made


def test_a_gif_has_the_frames_and_lasts_as_long_as_they_should(tmp_path):
    path = tmp_path / "new" / "a.GIF"
    assert film.is_film(path)
    film.check(path)
    written = film.open_film(path, (10, 8), 24)
    for frame in frames(6):
        written.add(frame)
    written.finish()
    assert [found.name for found in path.parent.iterdir()] == ["a.GIF"]
    with Image.open(path) as image:
        assert (image.n_frames, image.size, image.info["loop"]) == (6, (10, 8), 0)
        durations = []
        for number, frame in enumerate(frames(6)):
            image.seek(number)
            durations.append(image.info["duration"])
            assert np.abs(np.asarray(image.convert("RGB"), int) - frame).max() <= 8
    assert sum(durations) == pytest.approx(1000 * 6 / 24, abs=10)
    assert set(durations) == {40, 50}


def test_one_that_is_given_up_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.gif"
    path.write_bytes(b"precious")
    written = film.open_film(path, (10, 8), 24)
    written.add(frames(1)[0])
    written.discard()
    assert path.read_bytes() == b"precious"
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_too_quick_or_too_much_is_refused(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"a\.gif: found 60 frames a second, a \.gif has at most 50"):
        film.open_film(tmp_path / "a.gif", (10, 8), 60)
    monkeypatch.setattr(gif_film, "_MOST_BYTES", 160)
    written = film.open_film(tmp_path / "a.gif", (10, 8), 24)
    for frame in frames(2):
        written.add(frame)
    with pytest.raises(InputError, match="room for 2 frames"):
        written.add(frames(1)[0])
    written.discard()
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "b.gif").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        film.open_film(tmp_path / "b.gif", (10, 8), 24)
