"""The command line `quadgraph`. Each subcommand is a module with add_parser and run: those of quadgraph.commands, and
those that an installed distribution names under the entry point group `quadgraph.commands`.
"""

from __future__ import annotations

import argparse
import functools
import importlib
import re
import sys
from collections.abc import Sequence
from types import ModuleType
from typing import Any

from quadgraph.base import config_file, program
from quadgraph.base.errors import InputError
from quadgraph.base.version import __version__
from quadgraph.commands import config
from quadgraph.commands.command_parser import NAME_ROOM, CommandParser, Listing

# Their modules import nothing heavy: what a subcommand needs, it imports when it runs.
SUBCOMMANDS = {
    "bake": "bake",
    "shapes": "shapes",
    "volume": "volume",
    "colours": "colours",
    "export": "export",
    "info": "info",
    "view": "view",
    "serve": "serve",
    "render": "render",
    "solve": "solve",
    "turntable": "turntable",
    "sheet": "sheet",
    "compare": "compare",
    "materials": "material_list",
    "cache": "cache",
    "completion": "completion",
    "capture": "capture_command",
    "acquire": "acquire",
    "devices": "device_list",
    "doctor": "doctor",
}
# The subcommands that quadgraph-validation brings along; their modules come through its entry points.
VALIDATION = ("bench", "accuracy", "reference", "photograph", "chart", "tables", "polygrid", "stability")


class Added:
    """The subparsers as a module of the second group sees them: help lines are kept for a heading apart."""

    def __init__(self, subparsers: argparse._SubParsersAction) -> None:
        self._subparsers = subparsers
        self._lines: list[str] = []

    def add_parser(self, name: str, help: str, **options: Any) -> argparse.ArgumentParser:
        """Add a subcommand that the list of the first group does not show."""
        self._lines.append(f"    {name:<{NAME_ROOM}}{help}")
        return self._subparsers.add_parser(name, **options)

    def text(self) -> str:
        """The group for the end of the help, nothing where nothing was added."""
        if not self._lines:
            return ""
        return "\n".join(["validation (quadgraph-validation is installed):", *self._lines])


def own_commands(only: str | None = None) -> dict[str, ModuleType]:
    """The package's own modules by the names of their subcommands: all, or the one of that name if there is one."""
    names = [name for name in SUBCOMMANDS if only in (None, name)]
    return {name: importlib.import_module(f"quadgraph.commands.{SUBCOMMANDS[name]}") for name in names}


def added_commands(only: str | None = None) -> dict[str, ModuleType]:
    """As own_commands, but the modules of installed entry points, in the order of VALIDATION."""
    from importlib.metadata import entry_points  # itself no light module

    found = {each.name: each for each in entry_points(group="quadgraph.commands")}
    order = [name for name in VALIDATION if name in found] + sorted(found.keys() - set(VALIDATION))
    return {name: found[name].load() for name in order if only in (None, name)}


def needed_commands(given: Sequence[str]) -> tuple[dict[str, ModuleType], dict[str, ModuleType]]:
    """What own_commands and added_commands give of the subcommand that a command line asks for.

    Of all subcommands where it names none, where it is one that tells of all, and where there is a file of defaults,
    which may name options of any.
    """
    asked = next(iter(given), "")
    if asked != "completion" and not config_file.exists():
        if own := own_commands(asked):
            return own, {}
        if added := added_commands(asked):
            return {}, added
    return own_commands(), added_commands()


def build_parser(commands: dict[str, ModuleType], added: dict[str, ModuleType]) -> argparse.ArgumentParser:
    """Return the parser of the whole command line: the package's own subcommands, and those that are added to them."""
    parser = CommandParser(
        prog="quadgraph",
        description="Real-time rendering of heterogeneous translucent objects.",
        formatter_class=Listing,
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=CommandParser)
    for module in commands.values():
        module.add_parser(subparsers)
    second = Added(subparsers)
    for module in added.values():
        module.add_parser(second)
    parser.epilog = second.text()
    if "completion" in subparsers.choices:
        subparsers.choices["completion"].set_defaults(whole=parser)  # it tells of all of them
    return parser


def configure(parser: argparse.ArgumentParser) -> None:
    """Let the user's file of defaults be read when one of its commands is parsed; not for one that helps to mend it."""
    (subparsers,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    parsers = {name: each for name, each in subparsers.choices.items() if isinstance(each, CommandParser)}

    def known() -> set[str] | None:
        try:
            for each in parsers.values():
                each.declare_all()
        except InputError:  # there is no engine, whose options would be known
            return None
        return {name for each in parsers.values() for name in config.options_of(each)}

    def defaults(command: str, each: argparse.ArgumentParser) -> dict[str, Any]:
        return config.apply(config.load(parsers), command, each, known)

    for name, each in parsers.items():
        if name not in ("doctor", "completion"):
            each.configure = functools.partial(defaults, name)


def check_installed(arguments: Sequence[str], added: dict[str, ModuleType]) -> None:
    """Raise InputError, saying what to install, if the subcommand asked for is one of a distribution that is absent."""
    command = next(iter(arguments), "")
    if command in VALIDATION and command not in added:
        raise InputError(
            f"{command} belongs to quadgraph-validation, which is not installed: pip install ./python/validation "
            "in the source tree"
        )


def join_negative_values(arguments: Sequence[str]) -> list[str]:
    """Turn `--view -30,10` into `--view=-30,10`: argparse takes what starts with a minus for an option."""
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1].startswith("--") and re.match(r"-[0-9.]+,", argument):
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit status: 1 for an error, 2 for wrong usage, 130 for Ctrl-C."""
    return program.ended(lambda: _run(join_negative_values(sys.argv[1:] if arguments is None else arguments)))


def _run(given: Sequence[str]) -> int:
    commands, added = needed_commands(given)
    check_installed(given, added)
    parser = build_parser(commands, added)
    if config.OFF not in given:
        configure(parser)
    args = parser.parse_args(given)
    status = (commands | added)[args.command].run(args)
    if sys.stdout is not None:  # it is where the process was started without one
        sys.stdout.flush()
    return status


if __name__ == "__main__":
    sys.exit(main())
