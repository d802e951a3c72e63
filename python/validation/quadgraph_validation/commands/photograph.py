"""`quadgraph photograph`: a capture of a scene that is known, to try `quadgraph acquire` on (docs/acquisition.md).

Each of the scene's lights alone, from each view, by random walks that share nothing with the engine, with the noise of
a camera. What is true is written beside the capture, for judging: `acquire` never reads it.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import Progress

from quadgraph.base import outputs
from quadgraph.base.arguments import positive_int, share
from quadgraph.base.errors import InputError
from quadgraph.work.schedulers import add_scheduler_argument

if TYPE_CHECKING:
    from quadgraph_validation.truth.photographed import PhotographOptions, Radiances, Subject

KINDS = ("walks", "engine")
_MOST_SIDE, _MOST_BITS = 4096, 24


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("photograph", help="a capture of a scene that is known", description=__doc__)
    parser.add_argument(
        "scene", metavar="SCENE", type=Path, help="a scene .json of one material throughout, or of a volume (.npz)"
    )
    parser.add_argument(
        "--capture", metavar="FILE", type=Path, required=True, help="the capture .json to write, photographs beside it"
    )
    parser.add_argument(
        "--by",
        choices=KINDS,
        default=KINDS[0],
        help="walks: random walks through the body's mesh, under rectangle and ambient lights; engine: the engine, "
        "under all lights, quickly (default: %(default)s)",
    )
    parser.add_argument(
        "--body",
        metavar="QGRAPH",
        type=Path,
        help="of --by engine: a finer bake of the same body. Without, predictions and photographs have one mesh, and "
        "agree better than they should (an inverse crime)",
    )
    parser.add_argument(
        "--azimuths", type=_azimuths, metavar="A,B,...", help="of the views, degrees (default: the scene's, and behind)"
    )
    parser.add_argument("--size", type=_size, metavar="WxH", help="pixels (default: the scene's)")
    parser.add_argument(
        "--walks", type=positive_int, default=256, metavar="N", help="of a pixel (default: %(default)s)"
    )
    camera = parser.add_argument_group("camera")
    camera.add_argument(
        "--noise",
        type=share,
        default=0.005,
        metavar="SHARE",
        help="shot and read-out noise of a white pixel (default: 0.5%%)",
    )
    camera.add_argument(
        "--bits", type=_bits, default=14, metavar="N", help="of a value, 0: float (default: %(default)s)"
    )
    camera.add_argument("--blur", type=_blur, default=0.0, metavar="PIXELS", help="standard deviation (default: none)")
    camera.add_argument(
        "--gains", type=share, metavar="SHARE", help="unknown gains, off by up to so much (default: they are known)"
    )
    parser.add_argument(
        "--seed", type=positive_int, default=1, metavar="N", help="of all chance (default: %(default)s)"
    )
    parser.add_argument("--device", default="", metavar="NAME", help="of --by engine")
    add_scheduler_argument(parser, "walks, each view in each channel,")


def run(args: argparse.Namespace) -> int:
    """Photograph and write; 0 on success."""
    from quadgraph_validation.truth import photographed

    if args.capture.suffix.lower() != ".json":
        raise InputError(f"{args.capture}: a capture must end in .json")
    if args.body and args.by != "engine":
        raise InputError("--body: found with --by walks, which go through the scene's own body; leave it out")
    if args.scheduler and args.by != "walks":
        raise InputError("--scheduler: found with --by engine, allowed with --by walks")
    found = photographed.subject(args.scene)
    options = photographed.PhotographOptions(
        args.azimuths, args.size, args.walks, args.noise, args.bits, args.blur, args.gains or 0.0, args.seed
    )
    cameras = photographed.views(found, options)
    names = [f"{camera}-{light}" for camera in cameras for light in found.lights]
    written = [photographed.photograph_path(args.capture, name) for name in names]
    written += [args.capture, photographed.truth_path(args.capture)]
    outputs.check_outputs(written, [args.scene, found.body, found.material.file, args.body])
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    radiances = _radiances(args, found, cameras, options, console)
    taken = photographed.taken(radiances, options)
    photographed.write(args.capture, found, cameras, taken, _how(args))
    if args.by == "engine" and not args.body:
        console.print("photographs and predictions have the same mesh: an inverse crime; --body gives a finer one")
    print(f"capture: {args.capture}, {len(taken)} photographs; truth: {photographed.truth_path(args.capture)}")
    return 0


def _radiances(
    args: argparse.Namespace,
    found: Subject,
    cameras: dict[str, dict[str, Any]],
    options: PhotographOptions,
    console: Console,
) -> Radiances:
    from quadgraph_validation.truth import photograph_tasks, photographed

    if args.scheduler:
        return photograph_tasks.by_walks(found, cameras, options, args.capture, args.scheduler)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("photograph", total=1.0)

        def advance(done: float) -> None:
            bar.update(task, completed=done)

        if args.by == "walks":
            return photographed.by_walks(found, cameras, options, advance)
        return photographed.by_engine(found, cameras, args.body or found.body, args.device, advance)


def _how(args: argparse.Namespace) -> dict[str, Any]:
    told = {name: getattr(args, name) for name in ("by", "noise", "bits", "blur", "seed")}
    return told | ({"walks": args.walks} if args.by == "walks" else {"finer_body": str(args.body or "")})


def _azimuths(text: str) -> tuple[float, ...]:
    values = tuple(float(part) for part in text.split(","))
    if not all(abs(value) <= 3600 for value in values):
        raise argparse.ArgumentTypeError(f"{text[:40]}: must be degrees joined by commas")
    return values


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and all(8 <= int(n) <= _MOST_SIDE for n in (width, height))):
        raise argparse.ArgumentTypeError(f"{text[:40]}: must be WIDTHxHEIGHT of 8 to {_MOST_SIDE} pixels")
    return int(width), int(height)


def _bits(text: str) -> int:
    value = int(text)
    if not 0 <= value <= _MOST_BITS or value in (1, 2, 3):
        raise argparse.ArgumentTypeError(f"{text[:40]}: must be 4 to {_MOST_BITS}, or 0")
    return value


def _blur(text: str) -> float:
    value = float(text)
    if not 0 <= value <= 20:
        raise argparse.ArgumentTypeError(f"{text[:40]}: must be 0 to 20")
    return value
