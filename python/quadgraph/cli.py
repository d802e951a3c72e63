"""The command line `quadgraph`. Each subcommand is a module of quadgraph.commands with add_parser and run."""

from __future__ import annotations

import argparse
import importlib
import os
import re
import signal
import sys
from collections.abc import Callable, Sequence

from quadgraph import __version__
from quadgraph.errors import QuadGraphError

# Modules that import nothing heavy: what a subcommand needs, it imports when it runs.
SUBCOMMANDS = (
    "bake",
    "shapes",
    "volume",
    "info",
    "view",
    "render",
    "solve",
    "bench",
    "accuracy",
    "reference",
    "chart",
    "tables",
    "polygrid",
    "stability",
)
INTERRUPTED = 128 + signal.SIGINT


class CommandParser(argparse.ArgumentParser):
    """The parser of a subcommand. One whose arguments need the compiled engine has `declare` add them when it is used,
    so that all others, and the list of subcommands, do without it.
    """

    declare: Callable[[argparse.ArgumentParser], None] | None = None

    def parse_known_args(self, args=None, namespace=None):
        """As ArgumentParser does, with all arguments declared."""
        declare, self.declare = self.declare, None
        if declare is not None:
            declare(self)
        return super().parse_known_args(args, namespace)


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    parser = argparse.ArgumentParser(
        prog="quadgraph", description="Real-time rendering of heterogeneous translucent objects."
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=CommandParser)
    for name in SUBCOMMANDS:
        importlib.import_module(f"quadgraph.commands.{name}").add_parser(subparsers)
    return parser


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
    try:
        args = build_parser().parse_args(join_negative_values(sys.argv[1:] if arguments is None else arguments))
        status = importlib.import_module(f"quadgraph.commands.{args.command}").run(args)
        sys.stdout.flush()
        return status
    except QuadGraphError as error:
        print(f"quadgraph: error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("quadgraph: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of our output is gone; what is left must not meet it again when Python ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1


if __name__ == "__main__":
    sys.exit(main())
