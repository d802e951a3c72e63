"""`quadgraph render` of a scene file: one of its frames, or all as pictures or as a film (docs/scene.md)."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from quadgraph.base import atomic_file, image_file, json_text, outputs
from quadgraph.base.arguments import positive_int
from quadgraph.base.errors import InputError
from quadgraph.commands import (
    converging,
    frame_output,
    frame_progress,
    picture_output,
    scene_file,
    scene_options,
    scene_overrides,
)
from quadgraph.commands import solve_report as text
from quadgraph.commands.progress_bar import progress_bar
from quadgraph.core import load_core
from quadgraph.file import film
from quadgraph.work.schedulers import add_scheduler_argument, check_several

if TYPE_CHECKING:
    from quadgraph.api.colour_config import ColourConfig
    from quadgraph.core import SceneFile


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that only a scene file takes; to be called after all others."""
    group = parser.add_argument_group("of a scene file")
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="PATH=VALUE",
        help="change anything that the scene says, e.g. /lights/0/power=2, after all other options; several allowed",
    )
    group.add_argument("--frame", type=float, default=0.0, metavar="F", help="the one to render (default: 0)")
    group.add_argument(
        "--frames",
        type=positive_int,
        nargs="?",
        const=0,
        metavar="N",
        help="render the first N, without N all of the scene, into a numbered OUT, e.g. frames/%%04d.png, .jpg or "
        ".exr, or a film, e.g. turn.mp4 or turn.gif",
    )
    frame_progress.add_argument(group)
    add_scheduler_argument(group, "frames")


def refuse(args: argparse.Namespace) -> None:
    """Raise InputError if an option is given that only a scene file takes."""
    typed = "scheduler" in args.given
    for name, given in (
        ("set", args.set),
        ("frame", args.frame),
        ("frames", args.frames is not None),
        ("progress", args.progress),
        ("scheduler", typed),
    ):
        if given:
            raise InputError(f"--{name}: only with a scene file (.json), found {args.file}")


def run(args: argparse.Namespace) -> int:
    """Render and write; 3 as `scene_options.exit_status` says of all frames."""
    with scene_file.opened(args.file) as (file, document):
        scene_overrides.apply(file, document, args)
        return _run(args, file)


def _run(args: argparse.Namespace, file: SceneFile) -> int:
    config = picture_output.colour_config(args)
    if config and args.scheduler:
        raise InputError("--ocio: found with --scheduler, allowed is one of them")
    if args.progress and args.scheduler:
        raise InputError("--progress: found with --scheduler, allowed is one of them")
    for change in args.set:
        pointer, equals, value = change.partition("=")
        if not equals:
            raise InputError(f"--set {change}: allowed is PATH=VALUE, e.g. /camera/fov=40")
        try:
            file.set(pointer, value)
        except InputError as error:
            raise InputError(f"--set {pointer}: {error}") from None
    check_frames(args, file.frames)
    check_several(args, args.frames is not None, "--frames is wanted")
    frames = [args.frame] if args.frames is None else range(args.frames or file.frames)
    with_numbers = args.frames is not None
    transparent = json.loads(file.at(0).json())["picture"]["background"] == "transparent"
    for path in args.output:
        frame_output.check(path, with_numbers)
        if transparent:
            image_file.check_transparent(path)
    read = [*scene_options.inputs(args), *named_files(args.file), *args.set]
    outputs.check_outputs([*args.output, args.json, args.progress], read, made=args.output if with_numbers else ())
    reports = _by_tasks(args, file) if args.scheduler and with_numbers else _in_turn(args, file, frames, config)
    if args.json:
        atomic_file.write_json(args.json, reports if with_numbers else reports[0])
    return scene_options.exit_status(reports, args.strict)


def _in_turn(args: argparse.Namespace, file, frames: Sequence[float], config: ColourConfig | None) -> list[dict]:
    stage = load_core().Stage(device=args.device, validation=args.validation)
    told = frame_progress.FrameProgress(args.progress, len(frames))
    reports = render(stage, file, frames, args.output, config, told)
    summarise(text.size_text(stage.engine), reports, args.output)
    return reports


def _by_tasks(args: argparse.Namespace, file) -> list[dict]:
    from quadgraph.commands import frame_tasks

    reports = frame_tasks.render(args, file, range(args.frames or file.frames), args.output)
    scene_options.tell_map(reports[0]["map"])
    summarise(reports[0]["size"], reports, args.output)
    return reports


def check_frames(args: argparse.Namespace, most: int) -> None:
    """Raise InputError unless --frame and --frames are within what a scene may have."""
    bound = load_core().MOST_FRAMES
    if not abs(args.frame) <= bound:
        raise InputError(f"--frame: found {args.frame:g}, allowed are finite numbers of at most {bound}")
    if (args.frames or 0) > bound:
        raise InputError(f"--frames: found {str(args.frames)[:40]}, allowed are 1 to {bound}; the scene has {most}")


def named_files(path: Path) -> list[Path]:
    """Files that the texts of a scene file name, as far as they are there."""
    texts, waiting = [], [json_text.loads(path.read_bytes())]
    while waiting:
        value = waiting.pop()
        if isinstance(value, (dict, list)):
            waiting += value.values() if isinstance(value, dict) else value
        elif isinstance(value, str) and "\0" not in value and len(value) < 4096:
            texts.append(path.parent / value)
    return [found for found in texts if found.is_file()]


def render(
    stage,
    file,
    frames: Sequence[float],
    outputs: list[Path],
    config: ColourConfig | None = None,
    told: frame_progress.FrameProgress | None = None,
) -> list[dict]:
    """Render frames and write each to all outputs; one report per frame. config: in place of the scene's tone; told:
    counts the frames.
    """
    by_tone = picture_output.Shown(stage.srgb, stage.write_png, stage.write_exr, lambda: stage.engine.metadata)
    reports: list[dict] = []
    with (
        frame_output.Frames(outputs, file.at(0).size, file.frames_per_second) as written,
        progress_bar() as progress,
    ):
        for frame in progress.track(frames, description="frames"):
            start = time.perf_counter()
            stage.show(file.at(frame))
            shown = picture_output.by_config(by_tone, config, _shown_as(file, frame)) if config else by_tone
            if not reports:
                scene_options.tell_map(stage.map_report)
            report = stage.solve()
            picture = stage.render(told=converging.tell)
            report = converging.report_of(picture, report)
            scene_options.check_validation(stage.engine)
            written.add(picture, frame, shown)
            if told:
                told.add()
            report |= {"frame": frame, "seconds": time.perf_counter() - start}
            reports.append(report | {"picture_error": picture.error, "passes": stage.engine.passes})
        written.finish()
    return reports


def _shown_as(file, frame: float) -> str:
    return json.dumps({"picture": json.loads(file.at(frame).json())["picture"]})


def badness(report: dict) -> tuple[bool, float]:
    """Larger for a report that did not converge, and then for one with a larger error."""
    return bool(report["stopped"]), (report["error"] or {"whole": 0.0})["whole"]


def summarise(size: str, reports: list[dict], outputs: list[Path]) -> None:
    """Say what was made, of a frame that did not converge or else of the one with the largest error. size: in words."""
    console = Console(highlight=False, soft_wrap=True)
    worst = max(reports, key=badness)
    seconds = sum(report["seconds"] for report in reports)
    console.print(size)
    if len(reports) == 1:
        console.print(f"frame: {sum(p['time_ms'] for p in worst['passes']):.0f} ms on the device, {seconds:.1f} s")
    else:
        console.print(f"frames: {len(reports)} in {seconds:.1f} s; the worst of them is number {worst['frame']:g}")
    print_answer(console, worst, outputs)


def print_answer(console: Console, report: dict, outputs: list[Path]) -> None:
    """Say how good an answer is, and what was written."""
    console.print(text.error_text(report))
    for sentence in text.solver_texts(report):
        console.print(sentence)
    for path in outputs:
        console.print(f"{'film' if film.is_film(path) else 'picture'}: {path}")
