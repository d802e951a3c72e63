"""The record that `quadgraph capture import` leaves beside a capture, as `capture check` reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quadgraph.acquisition.capture.capture import MOST_PHOTOGRAPHS
from quadgraph.acquisition.capture.strict_json import Member
from quadgraph.acquisition.session import capture_writing
from quadgraph.base import json_text
from quadgraph.base.errors import InputError
from quadgraph.base.regular_file import read_bytes

_FAR = 1e9
_MOST_CORNERS = 10_000
_MEMBERS = ("photograph", "files", "exposures", "exposure_ratios", "moved", "samples", "size", "eye")


@dataclass(frozen=True, eq=False)
class Imported:
    """One photograph: size, pixels; corners: (n, 4), places and by how much they are off, pixels; the rest as
    `capture_writing.record` has it.
    """

    size: tuple[int, int]
    moved: float
    ratios: list[float]
    reprojection: float | None
    corners: np.ndarray


@dataclass(frozen=True)
class Record:
    """printed: what the two rulers measure, mm, None without a board; photographs: by the names of their cameras."""

    printed: tuple[float, float] | None
    photographs: Mapping[str, Imported]


def place_of(path: Path) -> Path:
    """Where the record of a capture would be."""
    return capture_writing.record_of(path)


def read(capture: Path) -> Record | None:
    """The record beside a capture, None where there is none. Raises InputError for one that cannot be read."""
    path = place_of(capture)
    if not path.is_file():
        return None
    try:
        document = Member(str(path), "", json_text.loads(read_bytes(path)))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except InputError as error:
        raise InputError(f"{path}: {error}; import again, or remove it") from None
    members = document.members(("quadgraph_import", "noise", "lenses", "board", "photographs"), ())
    members["quadgraph_import"].whole(1, 1, "the version of this format")
    printed = None
    if members["board"].value is not None:
        rulers = members["board"].members(("size", "printed"), ())["printed"].items(2)
        measured = [each.number(0, _FAR, "mm") for each in rulers]
        printed = (measured[0], measured[-1])
    found = {}
    for each in members["photographs"].items(MOST_PHOTOGRAPHS):
        own = each.members(_MEMBERS, ("reprojection", "left_out", "corners"))
        found[own["photograph"].text("its camera")] = _imported(own)
    return Record(printed, found)


def _imported(own: Mapping[str, Member]) -> Imported:
    size = [each.whole(1, 1 << 20, "pixels") for each in own["size"].items(2)]
    ratios = own["exposure_ratios"]
    corners = np.empty((0, 4))
    if "corners" in own:
        rows = [row.items(4) for row in own["corners"].items(_MOST_CORNERS)]
        if any(len(row) != 4 for row in rows):
            own["corners"].wrong("allowed are rows of four numbers")
        corners = np.array([[value.number(-_FAR, _FAR, "pixels") for value in row] for row in rows])
    return Imported(
        (size[0], size[-1]),
        own["moved"].number(0, _FAR, "pixels"),
        [each.number(-_FAR, _FAR, "ratio") for each in ratios.items(64)] if ratios.value else [],
        own["reprojection"].number(0, _FAR, "pixels") if "reprojection" in own else None,
        corners,
    )
