"""`quadgraph turntable`: a body from all sides, as a film or as numbered pictures.

The camera goes around the body once, counter-clockwise seen from above, and the lights stay; or the body turns, or the
lights.
"""

from __future__ import annotations

import argparse
import statistics
import time

from rich.console import Console

from quadgraph.base import atomic_file, image_file, outputs
from quadgraph.base.arguments import positive_float, positive_int
from quadgraph.base.errors import InputError
from quadgraph.commands import (
    converging,
    frame_output,
    picture_output,
    render_scene,
    scene_file,
    scene_options,
    turning,
)
from quadgraph.commands import solve_report as text
from quadgraph.commands.progress_bar import progress_bar
from quadgraph.core import load_core

_FRAMES = 48
_RATE = 24.0  # frames a second
_SLOWEST, _QUICKEST = 0.1, 1000.0  # frames a second
_SEEN = 6  # of all frames, from which the exposure follows


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("turntable", help="a body from all sides, as a film", description=__doc__)
    parser.declare = add_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add all arguments, those of a render among them."""
    scene_options.add_scene_arguments(parser, "a mesh, or a baked .qgraph", scene_options.RENDER_GROUPS)
    files = "turn.mp4, turn.webm, turn.gif, or numbered pictures like turn/%%03d.png, .jpg or .exr"
    picture_output.add_arguments(parser, files, "a report of each frame")
    group = parser.add_argument_group("of the turn")
    group.add_argument("--turn", choices=tuple(turning.kinds()), default="camera", help="what turns (default: camera)")
    group.add_argument(
        "--frames", type=positive_int, default=_FRAMES, metavar="N", help="of the whole turn (default: %(default)s)"
    )
    group.add_argument(
        "--seconds", type=positive_float, metavar="S", help=f"that it takes (default: {_RATE:g} frames a second)"
    )


def run(args: argparse.Namespace) -> int:
    """Render and write; 3 as `scene_options.exit_status` says of all frames."""
    if scene_file.is_scene(args.file):
        raise InputError(
            f"{args.file}: a scene turns by a track of /camera/azimuth (docs/scene.md); here a body is wanted"
        )
    if args.frames > (most := load_core().MOST_FRAMES):
        raise InputError(f"--frames: found {str(args.frames)[:40]}, allowed are 1 to {most}")
    for path in args.output:
        frame_output.check(path, with_numbers=True)
        if args.background == "transparent":
            image_file.check_transparent(path)
    outputs.check_outputs([*args.output, args.json], scene_options.inputs(args), made=args.output)
    rate = args.frames / args.seconds if args.seconds else _RATE
    if not _SLOWEST <= rate <= _QUICKEST:
        raise InputError(
            f"--seconds: found {args.seconds:g} for {args.frames} frames, which is {rate:.3g} a second; allowed are "
            f"{_SLOWEST:g} to {_QUICKEST:g}"
        )
    with frame_output.Frames(args.output, scene_options.size_of(args), rate) as written:
        reports = render(args, written)
    if args.json:
        atomic_file.write_json(args.json, reports)
    return scene_options.exit_status(reports, args.strict)


def render(args: argparse.Namespace, written: frame_output.Frames) -> list[dict]:
    """Render all frames into the outputs, and say what was made; one report per frame."""
    engine = scene_options.make_engine(args)
    turn = Turn(args, engine)
    start = time.perf_counter()
    reports = []
    with progress_bar() as progress:
        if args.exposure == "auto":
            count = min(_SEEN, args.frames)
            seen = [
                turn.at(360 * k / count, 0.25).auto_exposure(picture_output.tone(args))
                for k in progress.track(range(count), description="exposure")
            ]
            turn.exposure = str(statistics.fmean(seen))
        for frame in progress.track(range(args.frames), description="frames"):
            picture = turn.at(360 * frame / args.frames)
            written.add(picture, frame, turn.shown())
            report = converging.report_of(picture, turn.report)
            reports.append(report | {"frame": frame, "picture_error": picture.error, "passes": engine.passes})
        written.finish()
    console = Console(highlight=False, soft_wrap=True)
    console.print(text.size_text(engine))
    console.print(f"frames: {args.frames}, made in {time.perf_counter() - start:.1f} s")
    render_scene.print_answer(console, max(reports, key=render_scene.badness), args.output)
    return reports


class Turn:
    """An engine that shows a body from any side of a turn, and solves only where the light has changed."""

    def __init__(self, args: argparse.Namespace, engine) -> None:
        """engine: with the arguments' material and lights."""
        self.report: dict = {}
        self.exposure = str(args.exposure)
        self._args = args
        self._engine = engine
        self._angles = turning.kinds()[args.turn]
        self._lights = scene_options.lights(engine, args)
        self._centre = turning.middle(engine)
        self._solved: float | None = None

    def at(self, degrees: float, share: float = 1.0):
        """The picture when it has turned so far, with a share of its width and height."""
        of_camera, of_lights = self._angles(degrees)
        if self._solved != of_lights:
            self._engine.set_lights(turning.lights(self._lights, self._args.up, of_lights, self._centre))
            self.report = scene_options.solve(self._engine, self._args)
            self._solved = of_lights
        options = scene_options.keywords(self._args, scene_options.PICTURE_GROUPS)
        options |= turning.view(self._args, self._engine, of_camera)
        if self._args.turn != "light" and options["framing"] == "auto":
            options["framing"] = "turned"
        if share != 1:
            options["size"] = "x".join(str(max(16, int(share * side))) for side in scene_options.size_of(self._args))
        picture = self._engine.render(**options)
        scene_options.check_validation(self._engine)
        return picture

    def shown(self) -> picture_output.Shown:
        """How its pictures become files."""
        return picture_output.shown(self._engine, picture_output.tone(self._args, exposure=self.exposure))
