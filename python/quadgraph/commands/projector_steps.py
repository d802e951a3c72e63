"""Steps of `quadgraph capture` for projectors: what one is to show, and where it stands by photographs of that."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quadgraph.base.arguments import up_to
from quadgraph.base.errors import InputError
from quadgraph.commands import board_arguments

if TYPE_CHECKING:
    import numpy as np

    from quadgraph.acquisition.board.board import Board
    from quadgraph.acquisition.board.corners import Corners

_LUMINANCE = (0.2126, 0.7152, 0.0722)
_STRIPE = 4


def add_parsers(below: Any) -> None:
    """Register both steps."""
    made = below.add_parser("patterns", help="what a projector is to show", description=run_patterns.__doc__)
    made.add_argument("-o", "--output", metavar="FOLDER", type=Path, required=True, help="a new folder for the .png")
    _add_size(made)
    found = below.add_parser("projector", help="where a projector stands", description=run_projector.__doc__)
    found.add_argument(
        "places",
        metavar="FOLDER",
        type=Path,
        nargs="+",
        help="photographs of all patterns in the order of their names, the board in one place; three folders or more, "
        "the first with the board where it stays",
    )
    found.add_argument("-o", "--output", metavar="OUT", type=Path, required=True, help="the .yml to write")
    _add_size(found)
    board_arguments.add(found)
    found.add_argument(
        "--printed",
        metavar="MM",
        type=up_to(600),
        nargs=2,
        help="what the board's two rulers of 150 mm measure, along x and along y",
    )


def _add_size(parser: argparse.ArgumentParser) -> None:
    size = board_arguments.pair
    parser.add_argument("--size", metavar="WxH", type=size, required=True, help="the projector's own pixels: 1280x720")
    parser.add_argument(
        "--stripe", metavar="PIXELS", type=int, default=_STRIPE, help=f"narrowest stripes (default: {_STRIPE})"
    )


def _say(text: str) -> None:
    from rich.console import Console

    Console(highlight=False, soft_wrap=True).print(text, markup=False)


def run_patterns(args: argparse.Namespace) -> int:
    """Write what a projector is to show onto the board, one after the other: white, black, and stripes in Gray code."""
    import numpy as np

    from quadgraph.acquisition.lighting import stripes
    from quadgraph.base import image_file

    stripes.check(args.size, args.stripe)
    if args.output.exists():
        raise InputError(f"{args.output}: is there already; give the name of a new folder")
    if not args.output.absolute().parent.is_dir():
        raise InputError(f"{args.output}: the folder {args.output.parent} does not exist; make it")
    args.output.mkdir()
    for number, pattern in enumerate(stripes.patterns(args.size, args.stripe)):
        image_file.write(args.output / f"pattern-{number:02d}.png", np.repeat(pattern[..., None], 3, axis=2))
    _say(
        f"patterns: {number + 1} in {args.output}; show them in their order, each all over the projector's picture, "
        "and photograph each; the board in three places or more"
    )
    return 0


def run_projector(args: argparse.Namespace) -> int:
    """Find lens and place of a projector by photographs of `capture patterns` on the board in three places or more."""
    from quadgraph.acquisition.lighting import projected_picture, projector, projector_file, stripes
    from quadgraph.base import outputs
    from quadgraph.commands.progress_bar import progress_bar

    if args.output.suffix.lower() not in (".yml", ".yaml"):
        raise InputError(f"{args.output}: output must end in .yml")
    stripes.check(args.size, args.stripe)
    board = board_arguments.board_of(args, tuple(args.printed) if args.printed else None)
    photographs = {str(place): _photographs(place, stripes.count(args.size, args.stripe)) for place in args.places}
    if len(photographs) < max(projector.LEAST_PLACES, len(args.places)):
        raise InputError(
            f"found {len(photographs)} different folders, allowed are {projector.LEAST_PLACES} or more: photographs of "
            "the board in as many places, each tilted in another way"
        )
    outputs.check_outputs([args.output], [each for paths in photographs.values() for each in paths])
    lit = {}
    with progress_bar() as bar:
        task = bar.add_task("decode", total=sum(map(len, photographs.values())))
        for name, paths in photographs.items():
            lit[name] = _lit_corners(name, paths, board, args, lambda: bar.advance(task))
    found = projector.calibrate(board, lit, args.size)
    pose = found.places[str(args.places[0])].pose
    projector_file.write(args.output, found.lens, pose, found.rms)
    lens = found.lens
    _say(
        f"projector of {lens.width} x {lens.height} pixels: focal lengths {lens.fx:.1f}, {lens.fy:.1f}, axis at "
        f"{lens.cx:.1f}, {lens.cy:.1f}, k1 {lens.radial[0]:.4f}, k2 {lens.radial[1]:.4f}; it stands at "
        + ", ".join(f"{each:.1f}" for each in pose.eye)
        + f" mm; {found.rms:.2f} of its pixels off (RMS)"
    )
    for name, each in found.places.items():
        _say(f"{name}: {len(each.corners.numbers)} corners, {each.rms:.2f} pixels off, {each.left_out} left out")
    _say(f'session.json: {{"type": "projector", "calibrated": "{args.output}", "shown": PICTURE, "power": W}}')
    light, radius = projected_picture.spot(lens, pose)
    if light:
        _say(f"or, showing a white disc about its axis, {radius:.0f} pixels in radius: {json.dumps(light)}")
    return 0


def _photographs(place: Path, wanted: int) -> list[Path]:
    """Those of a folder in the order of their names. Raises InputError unless there are as many as patterns."""
    from quadgraph.acquisition.session.frames import RAW

    if not place.is_dir():
        raise InputError(f"{place}: found no folder of this name; give one with photographs of all patterns")
    found = sorted(path for path in place.iterdir() if path.suffix.lower() in (".png", ".exr", *RAW))
    if len(found) != wanted:
        raise InputError(
            f"{place}: found {len(found)} photographs (.png of 16 bits, .exr or raw), allowed are {wanted}, one of "
            "each pattern; --size and --stripe have to be those of `capture patterns`"
        )
    return found


def _lit_corners(
    name: str, paths: list[Path], board: Board, args: argparse.Namespace, advance: Callable[[], None]
) -> Corners:
    """The projector's pixels at the corners of the board in one place. Raises InputError."""
    from quadgraph.acquisition.board import corners
    from quadgraph.acquisition.lighting import projector, stripes

    white, black = (_luminance(path) for path in paths[:2])
    seen = corners.find(board, white - black)
    if len(seen.numbers) < projector.LEAST_CORNERS:
        raise InputError(
            f"{paths[0]}: found {len(seen.numbers)} corners of the board, allowed are {projector.LEAST_CORNERS} or "
            "more: is it the board that the options say, lit by white all over, in focus, not too dark, and the second "
            "photograph that of black?"
        )

    def frames() -> Iterator[np.ndarray]:
        for path in paths:
            advance()
            values = _luminance(path)
            if values.shape != white.shape:
                raise InputError(f"{path}: found another size than {paths[0].name}, allowed is the same")
            yield values

    return projector.lit_corners(name, seen, stripes.decode(frames(), args.size, args.stripe), args.stripe)


def _luminance(path: Path) -> np.ndarray:
    import numpy as np

    from quadgraph.acquisition.session import frames

    return np.asarray(frames.read(str(path), path, None).values @ np.array(_LUMINANCE, np.float32))


STEPS: dict[str, Callable[[argparse.Namespace], int]] = {"patterns": run_patterns, "projector": run_projector}
