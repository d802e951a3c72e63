"""The ChArUco board: a chessboard whose white squares hold markers that tell which square they are.

Its coordinates, mm: the origin in the lower left corner of the squares as they are read, x to the right, y up the page,
z out of the paper. So they are right-handed, and what stands on the board has positive z.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.base.optional_package import optional_package

EXTRA = "capture"
DICTIONARIES = ("4x4_50", "4x4_100", "4x4_250", "5x5_50", "5x5_100", "5x5_250", "6x6_250", "7x7_250")
RULER_MM = 150.0
MOST_SQUARES, SIZES_MM = 40, (1.0, 1000.0)
_SHARE = (0.4, 0.95)  # of a square, that a marker's side may be


def opencv() -> Any:
    """OpenCV with its ArUco module. Raises InputError naming the extra."""
    cv2 = optional_package("cv2", EXTRA)
    if not hasattr(cv2, "aruco") or not hasattr(cv2.aruco, "CharucoDetector"):
        raise InputError(
            f"cv2 {cv2.__version__} has no ChArUco detector, allowed is opencv-contrib-python-headless from 4.8 on: "
            f"pip install 'quadgraph[{EXTRA}]'"
        )
    return cv2


@dataclass(frozen=True)
class Board:
    """columns, rows: squares; square, marker: their sides, mm, as they were drawn; hollow: columns and rows of squares
    in the middle that are black, for the body; printed: what the two rulers of 150 mm, along x and y, measure on the
    paper, mm.
    """

    columns: int = 7
    rows: int = 9
    square: float = 25.0
    marker: float = 18.0
    dictionary: str = "5x5_50"
    hollow: tuple[int, int] = (0, 0)
    printed: tuple[float, float] = (RULER_MM, RULER_MM)

    def check(self) -> None:
        """Raise InputError naming the field, what was found and what is allowed."""
        for name, value in (("columns", self.columns), ("rows", self.rows)):
            if not 3 <= value <= MOST_SQUARES:
                raise InputError(f"board, {name}: found {value}, allowed are 3 to {MOST_SQUARES} squares")
        if not SIZES_MM[0] <= self.square <= SIZES_MM[1]:
            raise InputError(f"board, square: found {self.square:g}, allowed are {SIZES_MM[0]:g} to {SIZES_MM[1]:g} mm")
        low, high = (share * self.square for share in _SHARE)
        if not low <= self.marker <= high:
            raise InputError(f"board, marker: found {self.marker:g}, allowed are {low:g} to {high:g} mm of this square")
        if self.dictionary not in DICTIONARIES:
            raise InputError(f"board, dictionary: found {self.dictionary}, allowed are {', '.join(DICTIONARIES)}")
        markers, most = self.columns * self.rows // 2, int(self.dictionary.split("_")[1])
        if markers > most:
            raise InputError(
                f"board, dictionary: {markers} markers wanted, {self.dictionary} has {most}; take one with more"
            )
        for name, hole, whole in zip(("columns", "rows"), self.hollow, (self.columns, self.rows), strict=True):
            if hole and not (1 <= hole <= whole - 4 and (whole - hole) % 2 == 0):
                raise InputError(
                    f"board, hollow: found {hole} {name} of {whole}, allowed are two or more left on both sides, as "
                    "many on each"
                )
        if bool(self.hollow[0]) != bool(self.hollow[1]):
            raise InputError("board, hollow: found one of columns and rows, allowed are both or neither")

    @property
    def size(self) -> np.ndarray:
        """(2,) of all squares as they were drawn, mm."""
        return np.array([self.columns * self.square, self.rows * self.square])

    def is_hollow(self, column: int, row: int) -> bool:
        """Whether a square, counted from the upper left, is left out."""
        if not self.hollow[0]:
            return False
        first = (self.columns - self.hollow[0]) // 2, (self.rows - self.hollow[1]) // 2
        return 0 <= column - first[0] < self.hollow[0] and 0 <= row - first[1] < self.hollow[1]

    def markers(self) -> list[tuple[int, float, float]]:
        """Number, and x and y, mm, of the upper left corner as drawn from the upper left of the squares, down."""
        found = []
        for number, corners in zip(self.detected().getIds().ravel(), self.detected().getObjPoints(), strict=True):
            x, y = float(corners[0][0]), float(corners[0][1])
            if not self.is_hollow(int(x / self.square), int(y / self.square)):
                found.append((int(number), x, y))
        return found

    def detected(self) -> Any:
        """The same board as OpenCV has it."""
        cv2 = opencv()
        size = (self.columns, self.rows)
        return cv2.aruco.CharucoBoard(size, float(self.square), float(self.marker), self.patterns())

    def patterns(self) -> Any:
        """OpenCV's dictionary of the markers."""
        cv2 = opencv()
        return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{self.dictionary.upper()}"))

    def bits(self, number: int) -> np.ndarray:
        """(n, n) whether a cell of a marker is white, its black edge among them."""
        cv2 = opencv()
        side = int(self.dictionary.split("x", 1)[0]) + 2
        return np.asarray(cv2.aruco.generateImageMarker(self.patterns(), number, side)) > 0

    def corners(self) -> np.ndarray:
        """(n, 3) inner corners of the squares by their number in OpenCV, in the board's coordinates on paper, mm."""
        down = np.asarray(self.detected().getChessboardCorners(), np.float64)
        places = np.stack([down[:, 0], self.size[1] - down[:, 1], np.zeros(len(down))], axis=1)
        return places * [self.printed[0] / RULER_MM, self.printed[1] / RULER_MM, 1]
