"""The options that say which board it is, shared by the steps of `quadgraph capture`."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING

from quadgraph.base.arguments import up_to

if TYPE_CHECKING:
    from quadgraph.acquisition.board.board import Board


def pair(text: str) -> tuple[int, int]:
    """Argument type: two whole numbers, as 7x9."""
    found = re.fullmatch(r"(\d{1,4})x(\d{1,4})", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text[:40]}: must be columns and rows, like 7x9")
    return int(found[1]), int(found[2])


def add(parser: argparse.ArgumentParser) -> None:
    """Add them; those of the usual board are the defaults."""
    parser.add_argument("--squares", metavar="CxR", type=pair, default=(7, 9), help="columns and rows (default: 7x9)")
    parser.add_argument("--square", metavar="MM", type=up_to(1000), default=25.0, help="side of a square (default: 25)")
    parser.add_argument("--marker", metavar="MM", type=up_to(1000), default=18.0, help="side of a marker (default: 18)")
    parser.add_argument(
        "--dictionary", metavar="NAME", default="5x5_50", help="of the markers, as OpenCV has them (default: 5x5_50)"
    )
    parser.add_argument(
        "--hollow",
        metavar="CxR",
        type=pair,
        default=(0, 0),
        help="squares in the middle that are black, for the body, so that less light comes from the paper below it",
    )


def board_of(args: argparse.Namespace, printed: tuple[float, float] | None = None) -> Board:
    """The board of the options; printed: what its rulers measure, mm, None: as drawn. Raises InputError."""
    from quadgraph.acquisition.board.board import RULER_MM, Board

    (columns, rows), rulers = args.squares, printed or (RULER_MM, RULER_MM)
    board = Board(columns, rows, args.square, args.marker, args.dictionary, args.hollow, rulers)
    board.check()
    return board
