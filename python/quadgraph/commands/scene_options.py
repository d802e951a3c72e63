"""What `render`, `solve` and `bench` share: options that describe a scene, and the engine set up from them."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from quadgraph.base.arguments import add_device_arguments, add_strict_argument
from quadgraph.base.errors import InputError
from quadgraph.commands import converging, own_material, own_mesh
from quadgraph.core import load_core

if TYPE_CHECKING:
    from quadgraph.core import Engine, Picture, SceneOption


# Groups of the engine's scene options: what a solve takes, and a picture besides.
SOLVE_GROUPS = ("Scene", "Solver", "Method shortest-path")
PICTURE_GROUPS = ("Camera", "Picture")
RENDER_GROUPS = (*SOLVE_GROUPS, *PICTURE_GROUPS)


def options(groups: Collection[str]) -> list[SceneOption]:
    """The engine's scene options of these groups that command lines have."""
    return [option for option in load_core().scene_options() if option.on_command_line and option.group in groups]


def default_of(name: str) -> Any:
    """The default of a scene option."""
    return next(option.default for option in load_core().scene_options() if option.name == name)


def destination(option: SceneOption) -> str:
    """The attribute of parsed arguments that holds an option."""
    return option.name.replace("-", "_")


def keywords(args: argparse.Namespace, groups: Collection[str]) -> dict[str, Any]:
    """Keyword arguments of Engine.solve or Engine.render that the arguments say."""
    given = {option.keyword: getattr(args, destination(option)) for option in options(groups) if option.keyword}
    if "ground" in given:
        _, given["ground"] = load_core().picture_light(args.light or [], args.ground)
    return {keyword: value for keyword, value in given.items() if value is not None}


def add_scene_arguments(
    parser: argparse.ArgumentParser,
    file_help: str = "a mesh, or a baked .qgraph",
    groups: Collection[str] = SOLVE_GROUPS,
) -> None:
    """Add FILE and what `add_run_arguments` adds."""
    parser.add_argument("file", metavar="FILE", type=Path, help=file_help)
    add_run_arguments(parser, groups)


def add_run_arguments(parser: argparse.ArgumentParser, groups: Collection[str], without: Collection[str] = ()) -> None:
    """Add the options of a run, and the engine's scene options of these groups but those named `without`."""
    add_device_arguments(parser)
    add_strict_argument(parser)
    for name in groups:
        group = parser.add_argument_group(name)
        for option in options((name,)):
            if option.name not in without:
                add_option(group, option)
    own_mesh.add_size_arguments(parser.add_argument_group("Mesh of your own", own_material.HELP))


def add_option(group: argparse._ArgumentGroup, option: SceneOption) -> None:
    """Add one scene option, with the engine's default, allowed values and help."""
    described = option.full_help.replace("%", "%%")
    if option.default_text:
        described += f" (default: {option.default_text})"
    name = f"--{option.name}"
    if option.kind == "flag":
        # Given later, so that argparse does not tell the default in words of its own.
        flag = group.add_argument(
            name, action=argparse.BooleanOptionalAction, default=argparse.SUPPRESS, help=described
        )
        flag.default = None if option.name == "ground" else option.default  # see `keywords`
    elif option.kind == "texts":
        group.add_argument(name, action="append", metavar=option.metavar, help=described)
    elif option.choices:
        group.add_argument(name, choices=tuple(option.choices), default=option.default, help=described)
    else:
        group.add_argument(name, type=value_of(option), default=option.default, metavar=option.metavar, help=described)


def value_of(option: SceneOption) -> Callable[[str], Any]:
    """Argument type: what the engine makes of an option's text."""

    def value(text: str) -> Any:
        try:
            return option.parse(text)
        except InputError as error:
            raise argparse.ArgumentTypeError(str(error)) from error

    return value


def size_of(args: argparse.Namespace) -> tuple[int, int]:
    """Width and height, pixels. Raises InputError."""
    low, high, *_ = next(option.range for option in load_core().scene_options() if option.name == "width")
    found = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", args.size)
    if not found or not all(low <= int(side) <= high for side in found.groups()):
        raise InputError(f"--size: found '{args.size}', expected WIDTHxHEIGHT, {low:g} to {high:g} pixels each")
    return int(found[1]), int(found[2])


def numbers_of(name: str, text: str, counts: Collection[int]) -> list[float]:
    """Numbers that are joined by commas in the text of an option. Raises InputError."""
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if len(found) not in counts or not all(map(math.isfinite, found)):
        wanted = " or ".join(map(str, counts))
        raise InputError(f"--{name}: found '{text}', expected {wanted} finite numbers joined by commas")
    return found


def make_engine(args: argparse.Namespace) -> Engine:
    """Load `args.file` and set material and lights. Raises FormatError, InputError, DeviceError."""
    engine = shown_engine(args.file, args)
    engine.set_lights(lights(engine, args))
    return engine


def shown_engine(file: Path, args: argparse.Namespace) -> Engine:
    """Load a body, baked first where it is a mesh, and set the material that the arguments say, which may be its own.

    Tells what became of colours, and of a map that carried the material there. Raises FormatError, InputError,
    DeviceError.
    """
    own = _own(file, args) if own_material.is_own(args.material) else None
    named = by_body(getattr(args, "material_of", None) or [])
    with _loaded(file, args) as (engine, body):
        if own is not None:
            tell_map(own.set_on(engine, body))
        elif named:
            engine.set_materials(named, material(args))
        else:
            tell_map(engine.set_material(material(args)))
    return engine


def _own(file: Path, args: argparse.Namespace) -> own_material.OwnColours:
    if getattr(args, "material_of", None):
        raise InputError(
            f"--material-of: found with --material {own_material.NAME}, whose colours are those of one mesh"
        )
    if args.map is not None:
        raise InputError(f"--map: found with --material {own_material.NAME}, whose colours lie where the mesh has them")
    written = [getattr(args, name, None) for name in ("output", "json", "field")]
    paths = [path for each in written for path in (each if isinstance(each, list) else [each])]
    return own_material.read(args.material, file, [path for path in paths if isinstance(path, Path)])


def material(args: argparse.Namespace) -> str:
    """The material's text, with the map that goes with it. Raises InputError."""
    return load_core().with_map(args.material, args.map) if args.map is not None else args.material


def by_body(texts: Iterable[str]) -> dict[str, str]:
    """Materials by the names of bodies, of texts as --material-of takes them. Raises InputError."""
    found = {}
    for text in texts:
        body, equals, material = text.partition("=")
        if not equals or not body:
            raise InputError(f"--material-of: found '{text}', expected BODY=M, such as cup=porcelain")
        if body in found:
            raise InputError(f"--material-of: found '{body}' twice, one material for each body is allowed")
        found[body] = material
    return found


def tell_map(report: str) -> None:
    """Say on standard error what a map, or a mesh's colours, made of a material, if there was one."""
    if report:
        Console(stderr=True, highlight=False, soft_wrap=True).print(report, markup=False)


def load_engine(file: Path, args: argparse.Namespace) -> Engine:
    """Load a body, baked first where it is a mesh. Raises FormatError, InputError, DeviceError."""
    with _loaded(file, args) as (engine, _):
        return engine


@contextlib.contextmanager
def _loaded(file: Path, args: argparse.Namespace) -> Iterator[tuple[Engine, Path]]:
    """An engine, and the baked file in it, which is there as long as the block runs."""
    core = load_core()
    with own_mesh.body(file, args, surface_only=args.method == "shortest-path") as path:
        yield core.Engine(path, device=args.device, validation=args.validation), path


def lights(engine: Engine, args: argparse.Namespace) -> list[str]:
    """The lights that the arguments say, by name about their view; else those of a picture, or the lamps for others."""
    pictured = hasattr(args, "ground")
    texts = args.light or ([] if pictured else ["lamps"])
    return load_core().picture_light(texts, **seen_from(args), front=engine.graph.front)[0]


def seen_from(args: argparse.Namespace) -> dict[str, str]:
    """Keyword arguments of `picture_light` for the view of the arguments, as far as they say one."""
    names = ("view", "up", "eye", "look_at")
    return {name: value for name in names if (value := getattr(args, name, None)) is not None}


def inputs(args: argparse.Namespace) -> list[Path | str | None]:
    """The files, and the texts that may name some, that a run reads."""
    texts = [getattr(args, name, None) for name in ("file", "material", "normal_map")]
    others = by_body(getattr(args, "material_of", None) or []).values()
    named = [load_core().volume_name(text) for text in (texts[1], *others) if text]
    return [*texts, *others, *(each[0] for each in named if each), *(args.light or [])]


def solve(engine: Engine, args: argparse.Namespace) -> dict:
    """Solve as the options say, with light that goes in by their normal map and roughness; the report of
    `Engine.solve`.
    """
    named = getattr(args, "normal_map", None)
    picture = {"normal_map": {"image": str(named)}} if named else {}
    load_core().set_normal_map(engine, json.dumps({"picture": picture}))
    for_light = getattr(args, "transmission_roughness", None)
    engine.set_light_roughness(getattr(args, "roughness", None) if for_light is None else for_light)
    return engine.solve(**keywords(args, SOLVE_GROUPS))


def picture(engine: Engine, args: argparse.Namespace) -> tuple[Picture, dict]:
    """Solve and render as the options say; the picture, and the report of `Engine.solve`."""
    report = solve(engine, args)
    made = engine.render(**keywords(args, PICTURE_GROUPS))
    check_validation(engine)
    return made, converging.report_of(made, report)


def exit_status(reports: Iterable[dict], strict: bool) -> int:
    """3 if a solve did not converge, a picture did not reach the error that it was to converge to or, where that is
    held against it, a solve misses the error asked for, else 0.
    """
    return 3 if any(_fails(report, strict) for report in reports) else 0


def _fails(report: dict, strict: bool) -> bool:
    found = report.get("convergence")
    return bool(report["stopped"] or (strict and report["missed"]) or (found and not found["reached"]))


def check_validation(engine: Engine) -> None:
    """Raise InputError if the validation layer had anything to say."""
    messages = engine.validation_messages
    if messages:
        raise InputError("Vulkan validation: " + " | ".join(messages))
