"""`quadgraph render`: a picture of a baked object, or pictures of a scene."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from rich.console import Console

from quadgraph.base import atomic_file
from quadgraph.base.arguments import positive_float
from quadgraph.base.errors import InputError
from quadgraph.commands import render_scene, scene_options
from quadgraph.commands import solve_report as text

WRITERS = (".png", ".exr")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("render", help="a picture of a baked object, or of a scene", description=__doc__)
    scene_options.add_scene_arguments(
        parser, "a baked .qgraph, a scene .json (docs/scene.md), or a mesh for --method shortest-path"
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        action="append",
        required=True,
        metavar="OUT",
        help="out.png (8-bit sRGB, tone mapped) or out.exr (float32 linear, with layers); several allowed",
    )
    parser.add_argument(
        "--view",
        default="",
        metavar="A,E[,D]",
        help="azimuth and elevation in degrees, distance in mm (default: fitted); without it elevation 10 from the "
        "front, as the bake found or was told it",
    )
    parser.add_argument("--up", choices=("y", "z"), default="y", help="axis that points up (default: %(default)s)")
    parser.add_argument("--fov", type=positive_float, default=30.0, help="vertical, degrees (default: %(default)s)")
    parser.add_argument(
        "--size", type=image_size, default=(1024, 1024), metavar="WxH", help="pixels (default: 1024x1024)"
    )
    parser.add_argument(
        "--roughness", type=positive_float, default=0.3, help="of the surface, GGX alpha (default: %(default)s)"
    )
    parser.add_argument(
        "--radiance",
        choices=("gathered", "lambertian", "single", "auto"),
        default="auto",
        help="gathered: one more step of transport along every view ray, scaled to the exitance; lambertian: the same "
        "from every side but for Fresnel; single: that, and light scattered once along the refracted view ray (Jensen "
        "et al. 2001, Eq. 6); auto: gathered where it can be (fem and polygrids, buried) (default: %(default)s)",
    )
    parser.add_argument(
        "--show",
        default="picture",
        metavar="WHAT",
        help="picture, or in false colour what is inside: q, exitance, error, difference[:METHOD], levels[:N], "
        "phi[:AXIS[,MM]], tets[:AXIS[,MM[,N]]] or links[:AXIS[,MM[,N]]]; AXIS x, y or z across a cutting plane MM from "
        "the object's centre, N a level (default: %(default)s)",
    )
    parser.add_argument("--ground", action="store_true", help="a shadow on the ground where the object stands")
    parser.add_argument("--surroundings", action="store_true", help="what environment lights show, behind the object")
    parser.add_argument("--exposure", default="auto", help="auto, or stops (default: %(default)s)")
    parser.add_argument("--background", default="studio", help="studio, black, white, or R/G/B (default: %(default)s)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the report here")
    render_scene.add_arguments(parser)


def image_size(value: str) -> tuple[int, int]:
    """Argument type: WIDTHxHEIGHT in pixels."""
    try:
        width, height = (int(part) for part in value.lower().split("x"))
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{value}: expected WIDTHxHEIGHT, e.g. 1024x1024") from error
    return width, height


def run(args: argparse.Namespace) -> int:
    """Render and write; 3 if a tolerance or an error was not met, else 0."""
    if render_scene.is_scene(args.file):
        return render_scene.run(args)
    render_scene.refuse(args)
    for path in args.output:
        if path.suffix.lower() not in WRITERS:
            raise InputError(f"{path}: output must end in {' or '.join(WRITERS)}")
    start = time.perf_counter()
    engine = scene_options.make_engine(args)
    report = scene_options.solve(engine, args)
    picture = engine.render(
        view=args.view,
        up=args.up,
        vertical_fov=args.fov,
        width=args.size[0],
        height=args.size[1],
        roughness=args.roughness,
        radiance=args.radiance,
        show=args.show,
        ground=args.ground,
        surroundings=args.surroundings,
    )
    scene_options.check_validation(engine)
    for path in args.output:
        if path.suffix.lower() == ".png":
            picture.write_png(path, engine.metadata, args.exposure, args.background)
        else:
            picture.write_exr(path, engine.metadata, args.exposure)
    report |= {"passes": engine.passes, "device": engine.device_name, "driver": engine.driver}
    report["seconds"] = time.perf_counter() - start
    if args.json:
        atomic_file.write_json(args.json, report)
    print_summary(engine, report, args.output)
    return 3 if report["unmet"] else 0


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
    for sentence in text.solver_texts(report) + report["unmet"]:
        console.print(sentence)
    for path in outputs:
        console.print(f"picture: {path}")
