"""`quadgraph render`: a picture of a baked object, or pictures of a scene."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from rich.console import Console

from quadgraph.base import atomic_file, outputs
from quadgraph.commands import converging, picture_output, render_scene, scene_file, scene_options
from quadgraph.commands import solve_report as text


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("render", help="a picture of a baked object, or of a scene", description=__doc__)
    parser.declare = add_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add all arguments, which follow from the engine's options of a scene_options."""
    scene_options.add_scene_arguments(
        parser, "a mesh, a baked .qgraph, or a scene .json (docs/scene.md)", scene_options.RENDER_GROUPS
    )
    files = "out.png or out.jpg (8-bit sRGB, tone mapped) or out.exr (float32 linear, with layers)"
    picture_output.add_arguments(parser, files, "the report")
    picture_output.add_colour_arguments(parser)
    render_scene.add_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Render and write; 3 as `scene_options.exit_status` says."""
    if scene_file.is_scene(args.file):
        return render_scene.run(args)
    render_scene.refuse(args)
    config = picture_output.colour_config(args)
    for path in args.output:
        picture_output.check(path, args.background)
    outputs.check_outputs([*args.output, args.json], scene_options.inputs(args))
    start = time.perf_counter()
    engine = scene_options.make_engine(args)
    report = scene_options.solve(engine, args)
    options = scene_options.keywords(args, scene_options.PICTURE_GROUPS)
    picture = engine.render(told=converging.tell, **options)
    report = converging.report_of(picture, report)
    scene_options.check_validation(engine)
    how = picture_output.tone(args)
    shown = picture_output.shown(engine, how)
    if config:
        shown = picture_output.by_config(shown, config, how)
    for path in args.output:
        picture_output.write(picture, path, shown)
    report |= {"passes": engine.passes, "device": engine.device_name, "driver": engine.driver}
    report["picture_error"] = picture.error
    report["seconds"] = time.perf_counter() - start
    if args.json:
        atomic_file.write_json(args.json, report)
    print_summary(engine, report, args.output)
    return scene_options.exit_status([report], args.strict)


def print_summary(engine, report: dict, outputs: list[Path]) -> None:
    """Say what was made and what it took."""
    console = Console(highlight=False, soft_wrap=True)
    frame_ms = sum(entry["time_ms"] for entry in report["passes"])
    worst = max(report["energy"]["balance"], key=abs)
    console.print(text.size_text(engine))
    console.print(
        f"frame: {frame_ms:.0f} ms on the device, {report['seconds']:.1f} s all told with loading and start-up"
    )
    balance = "energy is not conserved" if report["path"] else f"energy balance {100 * worst:+.3f}%"
    console.print(f"{text.error_text(report)}, {balance}")
    for sentence in text.solver_texts(report):
        console.print(sentence)
    for path in outputs:
        console.print(f"picture: {path}")
