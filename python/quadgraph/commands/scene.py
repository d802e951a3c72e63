"""What `render`, `solve` and `bench` share: options that describe a scene, and the engine set up from them."""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import tempfile
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quadgraph.commands import budget
from quadgraph.errors import InputError

if TYPE_CHECKING:
    from quadgraph._core import Engine, SceneOption


UNITS_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
VARIED_MATERIAL = "marble-veins"
# Groups of the engine's scene options: what a solve takes, and a picture besides.
SOLVE_GROUPS = ("Scene", "Solver", "Method shortest-path")
PICTURE_GROUPS = ("Camera", "Picture")


def load_core():
    """Import the compiled module, or say how to get it. Raises InputError."""
    try:
        from quadgraph import _core
    except ImportError as error:
        raise InputError(
            f"the compiled engine quadgraph._core cannot be loaded ({error}); tools/setup builds it"
        ) from error
    return _core


def positive_float(text: str) -> float:
    """Argument type: a finite number above zero."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text}: must be a positive number")
    return value


def positive_int(text: str) -> int:
    """Argument type: an integer above zero."""
    value = int(text)
    if value <= 0:
        raise argparse.ArgumentTypeError(f"{text}: must be a positive integer")
    return value


def length_mm(text: str) -> float:
    """Argument type: a positive length with its unit, in mm."""
    found = re.fullmatch(r"\s*([0-9.eE+-]+)\s*(mm|cm|m)\s*", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text}: must be a number and mm, cm or m, like 100mm")
    return positive_float(found.group(1)) * UNITS_MM[found.group(2)]


def share(text: str) -> float:
    """Argument type: a share above 0 and below 1, as a number or in percent."""
    number = text.removesuffix("%")
    value = float(number) / (100 if number != text else 1)
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be above 0 and below 1 (or 100%)")
    return value


# Path-traced pictures that come with the repository.
COMMITTED_TRUTH = Path("docs/benchmarks/truth")


def shared_meshes() -> Path:
    """The folder in which scenes' mesh files are looked for by default."""
    return Path(os.environ.get("QUADGRAPH_SHARED", "../shared")) / "meshes"


def add_meshes_argument(group: argparse._ActionsContainer) -> None:
    """Add the folder of scenes' mesh files."""
    group.add_argument(
        "--meshes",
        type=Path,
        default=shared_meshes(),
        metavar="FOLDER",
        help="of the mesh files (default: %(default)s)",
    )


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
    return {keyword: value for keyword, value in given.items() if value is not None}


def add_scene_arguments(
    parser: argparse.ArgumentParser, file_help: str = "a baked .qgraph", groups: Collection[str] = SOLVE_GROUPS
) -> None:
    """Add FILE, the device options and the engine's scene options of these groups."""
    parser.add_argument("file", metavar="FILE", type=Path, help=file_help)
    add_device_arguments(parser)
    for name in groups:
        group = parser.add_argument_group(name)
        for option in options((name,)):
            add_option(group, option)
    add_size_arguments(parser.add_argument_group("Mesh without bake"))


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
        flag.default = option.default
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


def add_size_arguments(group: argparse._ArgumentGroup) -> None:
    """Add the size of a mesh that is shown without a bake."""
    size = group.add_mutually_exclusive_group()
    size.add_argument("--unit", choices=tuple(UNITS_MM), help="of the coordinates, where FILE is a mesh without bake")
    size.add_argument(
        "--height",
        type=length_mm,
        metavar="L",
        help="of such a mesh along y, like 100mm or 1.8m (default: 100mm)",
    )


def add_device_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the choice of Vulkan device and the validation layer."""
    parser.add_argument("--device", default="", metavar="NAME", help="part of the Vulkan device's name")
    parser.add_argument(
        "--validation", action="store_true", help="load the Vulkan validation layer, fail on any message"
    )


@contextlib.contextmanager
def baked_or_bare(file: Path, unit: str | None, height_mm: float | None) -> Iterator[Path]:
    """The file, or if it is a mesh, one without levels made of it, which is there as long as the block runs."""
    from quadgraph import bare

    if not bare.is_mesh(file):
        if unit is not None or height_mm is not None:
            raise InputError(f"{file}: --unit and --height are for meshes; a baked file knows its size")
        yield file
        return
    if unit is None and height_mm is None:
        height_mm = bare.HEIGHT_MM
    with tempfile.TemporaryDirectory(prefix="quadgraph-") as folder:
        path = Path(folder) / f"{file.stem}.qgraph"
        bare.write(file, path, unit, height_mm)
        yield path


def make_engine(args: argparse.Namespace) -> Engine:
    """Load `args.file` and set material and lights. Raises FormatError, InputError, VulkanError."""
    core = load_core()
    with baked_or_bare(args.file, getattr(args, "unit", None), getattr(args, "height", None)) as path:
        engine = core.Engine(path, device=args.device, validation=args.validation)
    engine.set_material(args.material)
    seen_from = {name: value for name in ("view", "up") if (value := getattr(args, name, None)) is not None}
    engine.set_lights(args.light or core.default_lights(**seen_from, front=engine.graph.front))
    return engine


def solve(engine: Engine, args: argparse.Namespace) -> dict:
    """Solve as the options say; the report of `Engine.solve`, and in `budget` what the bake has to say of the error."""
    taken = budget.taken(engine.graph.metadata, args)
    given = keywords(args, SOLVE_GROUPS)
    if taken and taken.options:
        given |= taken.options
    return engine.solve(**given) | {"cycles": given["cycles"], "budget": taken.sentence if taken else ""}


def check_validation(engine: Engine) -> None:
    """Raise InputError if the validation layer had anything to say."""
    messages = engine.validation_messages
    if messages:
        raise InputError("Vulkan validation: " + " | ".join(messages))


def unmet(report: dict) -> list[str]:
    """One sentence per level that stopped before the tolerance was met, unless so asked, and one for the error."""
    missed = [report["missed"]] if report["missed"] else []
    if report["cycles"] > 0:
        return missed
    return missed + [
        f"not converged: level {level['level']} stopped after {level['iterations']} iterations "
        f"at residual {level['residual']:.2e}"
        for level in report["levels"]
        if not level["converged"]
    ]
