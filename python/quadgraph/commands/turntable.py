"""`quadgraph turntable`: a body from all sides, as a film or as numbered pictures.

The camera goes around the body once, counter-clockwise seen from above, and the lights stay; or the body turns, or the
lights. A scene file turns as its first frame shows it.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time

from rich.console import Console

from quadgraph.base import atomic_file, image_file, outputs
from quadgraph.base.arguments import positive_float, positive_int
from quadgraph.base.errors import InputError
from quadgraph.commands import (
    converging,
    frame_output,
    frame_progress,
    picture_output,
    render_scene,
    scene_file,
    scene_options,
    scene_overrides,
    scene_turn,
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
    scene_options.add_scene_arguments(
        parser, "a mesh, a baked .qgraph, or a scene .json (docs/scene.md)", scene_options.RENDER_GROUPS
    )
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
    frame_progress.add_argument(group)


def run(args: argparse.Namespace) -> int:
    """Render and write; 3 as `scene_options.exit_status` says of all frames."""
    if args.frames > (most := load_core().MOST_FRAMES):
        raise InputError(f"--frames: found {str(args.frames)[:40]}, allowed are 1 to {most}")
    for path in args.output:
        frame_output.check(path, with_numbers=True)
    rate = args.frames / args.seconds if args.seconds else _RATE
    if not _SLOWEST <= rate <= _QUICKEST:
        raise InputError(
            f"--seconds: found {args.seconds:g} for {args.frames} frames, which is {rate:.3g} a second; allowed are "
            f"{_SLOWEST:g} to {_QUICKEST:g}"
        )
    reports = (_of_scene if scene_file.is_scene(args.file) else _of_body)(args, rate)
    if args.json:
        atomic_file.write_json(args.json, reports)
    return scene_options.exit_status(reports, args.strict)


def _of_body(args: argparse.Namespace, rate: float) -> list[dict]:
    _check_outputs(args, scene_options.inputs(args), args.background == "transparent")
    with frame_output.Frames(args.output, scene_options.size_of(args), rate) as written:
        return render(args, Turn(args, scene_options.make_engine(args)), written)


def _of_scene(args: argparse.Namespace, rate: float) -> list[dict]:
    with scene_file.opened(args.file) as (file, document):
        scene_overrides.apply(file, document, args)
        transparent = json.loads(file.at(0).json())["picture"]["background"] == "transparent"
        _check_outputs(args, [*scene_options.inputs(args), *render_scene.named_files(args.file)], transparent)
        with frame_output.Frames(args.output, file.at(0).size, rate) as written:
            stage = load_core().Stage(device=args.device, validation=args.validation)
            return render(args, scene_turn.SceneTurn(stage, file, args.turn), written)


def _check_outputs(args: argparse.Namespace, read: list, transparent: bool) -> None:
    if transparent:
        for path in args.output:
            image_file.check_transparent(path)
    outputs.check_outputs([*args.output, args.json, args.progress], read, made=args.output)


def render(args: argparse.Namespace, turn: Turn | scene_turn.SceneTurn, written: frame_output.Frames) -> list[dict]:
    """Render all frames into the outputs, and say what was made; one report per frame."""
    start = time.perf_counter()
    reports = []
    told = frame_progress.FrameProgress(args.progress, args.frames)
    with progress_bar() as progress:
        if turn.wants_exposure:
            count = min(_SEEN, args.frames)
            angles = [360 * k / count for k in range(count)]
            seen = [turn.auto_exposure(turn.at(at, 0.25)) for at in progress.track(angles, description="exposure")]
            turn.expose(statistics.fmean(seen))
        for frame in progress.track(range(args.frames), description="frames"):
            picture = turn.at(360 * frame / args.frames)
            written.add(picture, frame, turn.shown())
            told.add()
            report = converging.report_of(picture, turn.report)
            reports.append(report | {"frame": frame, "picture_error": picture.error, "passes": turn.engine.passes})
        written.finish()
    console = Console(highlight=False, soft_wrap=True)
    console.print(text.size_text(turn.engine))
    console.print(f"frames: {args.frames}, made in {time.perf_counter() - start:.1f} s")
    render_scene.print_answer(console, max(reports, key=render_scene.badness), args.output)
    return reports


class Turn:
    """An engine that shows a body from any side of a turn, and solves only where the light has changed."""

    def __init__(self, args: argparse.Namespace, engine) -> None:
        """engine: with the arguments' material and lights."""
        self.report: dict = {}
        self.engine = engine
        self._exposure = str(args.exposure)
        self._args = args
        self._angles = turning.kinds()[args.turn]
        self._lights = scene_options.lights(engine, args)
        self._centre = turning.middle(engine)
        self._solved: float | None = None

    @property
    def wants_exposure(self) -> bool:
        """Whether the exposure is to be found from pictures."""
        return self._exposure == "auto"

    def expose(self, stops: float) -> None:
        """Show all pictures by one exposure."""
        self._exposure = str(stops)

    def auto_exposure(self, picture) -> float:
        """The exposure that a picture would have by itself, stops."""
        return picture.auto_exposure(picture_output.tone(self._args))

    def at(self, degrees: float, share: float = 1.0):
        """The picture when it has turned so far, with a share of its width and height."""
        of_camera, of_lights = self._angles(degrees)
        if self._solved != of_lights:
            self.engine.set_lights(turning.lights(self._lights, self._args.up, of_lights, self._centre))
            self.report = scene_options.solve(self.engine, self._args)
            self._solved = of_lights
        options = scene_options.keywords(self._args, scene_options.PICTURE_GROUPS)
        options |= turning.view(self._args, self.engine, of_camera)
        if self._args.turn != "light" and options["framing"] == "auto":
            options["framing"] = "turned"
        if share != 1:
            options["size"] = "x".join(str(max(16, int(share * side))) for side in scene_options.size_of(self._args))
        picture = self.engine.render(**options)
        scene_options.check_validation(self.engine)
        return picture

    def shown(self) -> picture_output.Shown:
        """How its pictures become files."""
        return picture_output.shown(self.engine, picture_output.tone(self._args, exposure=self._exposure))
