"""`quadgraph completion`: what lets a shell complete commands, options, their values and files.

bash: source <(quadgraph completion bash), in ~/.bashrc. zsh: the output as _quadgraph in a folder of $fpath. fish: the
output as ~/.config/fish/completions/quadgraph.fish.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

from quadgraph.commands.command_parser import CommandParser

_SHELLS = ("bash", "zsh", "fish")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser(
        "completion",
        help="a script with which a shell completes commands",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("shell", choices=_SHELLS, help="for which it is")


def run(args: argparse.Namespace) -> int:
    """Print the script; 0."""
    import shtab

    for parser in parsers(args.whole):
        if isinstance(parser, CommandParser):
            parser.declare_all()
        for action in parser._actions:
            if action.type is Path:
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    print(shtab.complete(args.whole, shell=args.shell))
    return 0


def parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """A parser and those of its subcommands."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for each in action.choices.values():
                yield from parsers(each)
