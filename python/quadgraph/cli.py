"""The command line `quadgraph`. Each subcommand is a module with add_parser and run: those of quadgraph.commands, and
those that an installed distribution names under the entry point group `quadgraph.commands`.
"""

from __future__ import annotations

import argparse
import functools
import importlib
import io
import math
import os
import re
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from importlib.metadata import entry_points
from types import FrameType, ModuleType
from typing import Any

from quadgraph.base.errors import InputError, QuadGraphError
from quadgraph.base.message import ERROR, shortened
from quadgraph.base.version import __version__
from quadgraph.commands import config
from quadgraph.commands.command_parser import NAME_ROOM, CommandParser, Listing

# Their modules import nothing heavy: what a subcommand needs, it imports when it runs.
SUBCOMMANDS = {
    "bake": "bake",
    "shapes": "shapes",
    "volume": "volume",
    "info": "info",
    "view": "view",
    "render": "render",
    "solve": "solve",
    "turntable": "turntable",
    "sheet": "sheet",
    "compare": "compare",
    "materials": "material_list",
    "cache": "cache",
    "completion": "completion",
    "acquire": "acquire",
    "doctor": "doctor",
}
# The subcommands that quadgraph-validation brings along; their modules come through its entry points.
VALIDATION = ("bench", "accuracy", "reference", "photograph", "chart", "tables", "polygrid", "stability")
INTERRUPTED = 128 + signal.SIGINT


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


def added_commands() -> dict[str, ModuleType]:
    """The modules of installed entry points by the names of their subcommands, in the order of VALIDATION."""
    found = {each.name: each for each in entry_points(group="quadgraph.commands")}
    order = [name for name in VALIDATION if name in found] + sorted(found.keys() - set(VALIDATION))
    return {name: found[name].load() for name in order}


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


class Stopped(KeyboardInterrupt):
    """TERM or HUP, which clean up as Ctrl-C does."""


_SENT: list[int] = []  # signals that were heeded in this run of `main`
_AGAIN = 0.02  # s, after which a signal is sent again that came in an import
_SETTLING = 1.0  # s after a signal in which another one would meet the cleaning up


def heed_signals() -> None:
    """Let TERM and HUP end the program as Ctrl-C does, where they are not ignored or somebody else's.

    All three wait until what is being imported is: modules make errors of their own of an interrupt, or forget it.
    Another one within a second says nothing new.
    """
    if threading.current_thread() is not threading.main_thread():
        return

    heeded = -math.inf

    def again(_number: int, _frame: FrameType | None) -> None:
        signal.raise_signal(_SENT[0])

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal heeded
        if time.monotonic() < heeded + _SETTLING:
            return
        _SENT.append(number)
        if _in_import(frame):
            signal.signal(signal.SIGALRM, again)
            signal.setitimer(signal.ITIMER_REAL, _AGAIN)
        else:
            heeded = time.monotonic()
            signal.setitimer(signal.ITIMER_REAL, 0)
            raise KeyboardInterrupt if number == signal.SIGINT else Stopped(number)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, stop)


def _in_import(frame: FrameType | None) -> bool:
    while frame is not None and frame.f_code.co_filename != "<frozen importlib._bootstrap>":
        frame = frame.f_back
    return frame is not None


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit status: 1 for an error, 2 for wrong usage, 130 for Ctrl-C."""
    _SENT.clear()
    heed_signals()
    _print_any_character()
    try:
        return _run(join_negative_values(sys.argv[1:] if arguments is None else arguments))
    except KeyboardInterrupt:
        return _interrupted()
    except Exception as error:
        return _failed(error)
    finally:
        if _SENT:  # one that still waits for an import would come when Python has no handler any more
            signal.setitimer(signal.ITIMER_REAL, 0)


def _print_any_character() -> None:
    """Let characters that the encoding of standard output lacks be printed as escapes, and be no error."""
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="backslashreplace")


def _run(given: Sequence[str]) -> int:
    commands = {name: importlib.import_module(f"quadgraph.commands.{module}") for name, module in SUBCOMMANDS.items()}
    added = added_commands()
    check_installed(given, added)
    parser = build_parser(commands, added)
    if config.OFF not in given:
        configure(parser)
    args = parser.parse_args(given)
    status = (commands | added)[args.command].run(args)
    if sys.stdout is not None:  # it is where the process was started without one
        sys.stdout.flush()
    return status


def _interrupted() -> int:
    print("quadgraph: interrupted", file=sys.stderr)
    return 128 + _SENT[0] if _SENT else INTERRUPTED


def _failed(error: Exception) -> int:
    """Say what went wrong where it is ours or the system's to say, and return the exit status; raise all else."""
    if not isinstance(error, QuadGraphError | OSError):
        raise error
    if isinstance(error, OSError):
        _drop_output()
    if isinstance(error, BrokenPipeError):  # the reader of our output is gone
        return 1
    text = str(error)
    if isinstance(error, OSError):
        # Files that are read and written have errors of their own: this is standard output, or a temporary file.
        folder = tempfile.tempdir or os.environ.get("TMPDIR") or "/tmp"
        where = error.filename or f"standard output, or a temporary file in {folder}"
        text = shortened(f"{where}: {error.strerror or error}")
    print(f"{ERROR}{text}", file=sys.stderr)
    return 1


def _drop_output() -> None:
    """Let what is left of standard output not meet its reader, or a full disk, again when Python ends."""
    if sys.stdout is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    sys.exit(main())
