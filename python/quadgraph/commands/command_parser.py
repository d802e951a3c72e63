"""Parsers of command lines, which say what a slip was meant for, and know what was typed."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

from quadgraph.base.message import meant, shortened
from quadgraph.commands import config

NAME_ROOM = 12  # letters of a subcommand's name in the list of them, and two blanks
_CHOICE = re.compile(r"invalid choice: '([^']*)' \(choose from (.*)\)")  # as argparse says it


class CommandParser(argparse.ArgumentParser):
    """The parser of a command line.

    One whose arguments need the compiled engine has `declare` add them when it is used, so that all others, and the
    list of subcommands, do without it. What the parser of a subcommand returns has also `given`, the names of the
    options that were typed. `configure` may change defaults before that, and returns those that it has changed, by
    destination.
    """

    declare: Callable[[argparse.ArgumentParser], None] | None = None
    configure: Callable[[argparse.ArgumentParser], dict[str, Any]] | None = None

    def __init__(self, *args: Any, **options: Any) -> None:
        """Make a parser as ArgumentParser does, with the option that leaves the file of defaults alone."""
        super().__init__(*args, **options)
        leave = "do without the file of defaults (docs/commands.md)"
        self.add_argument(config.OFF, action="store_true", default=argparse.SUPPRESS, help=leave)

    def parse_known_args(self, args=None, namespace=None):
        """Parse like ArgumentParser, with all arguments declared; what is typed wins over what is configured."""
        self.declare_all()
        before = self.configure(self) if self.configure is not None else {}
        parsed, rest = super().parse_known_args(args, namespace)
        if self._subparsers is None:
            typed = vars(self._typed(args))
            vars(parsed).update(self._displaced(typed, before) | typed)
            parsed.given = frozenset(typed)
        unknown = [text.partition("=")[0] for text in rest if text.startswith("-")]
        if unknown:
            slip = meant(unknown[0], self._option_string_actions)
            self.error(f"unrecognized arguments: {' '.join(rest)}{slip}")
        return parsed, rest

    def _displaced(self, typed: Mapping[str, Any], before: Mapping[str, Any]) -> dict[str, Any]:
        """Values from before of configured options that one which was typed excludes."""
        result: dict[str, Any] = {}
        for group in self._mutually_exclusive_groups:
            names = [action.dest for action in group._group_actions]
            if any(name in typed for name in names):
                result |= {name: before[name] for name in names if name in before}
        return result

    def _typed(self, args: Sequence[str]) -> argparse.Namespace:
        """What `args` say of options, without any default."""
        options = [action for action in self._actions if action.option_strings]
        kept = [(action, action.default) for action in options]
        others, self._defaults = self._defaults, {}
        try:
            for action in options:
                action.default = argparse.SUPPRESS
            found = super().parse_known_args(args, argparse.Namespace())[0]
        finally:
            self._defaults = others
            for action, default in kept:
                action.default = default
        names = {action.dest for action in options}
        return argparse.Namespace(**{name: value for name, value in vars(found).items() if name in names})

    def declare_all(self) -> None:
        """Add the arguments that are added when they are needed."""
        declare, self.declare = self.declare, None
        if declare is not None:
            declare(self)

    def error(self, message: str) -> NoReturn:
        """Say what is wrong with the usage, however long what was typed is, and what was meant, and exit with 2."""
        if choice := _CHOICE.search(message):
            message += meant(choice[1], re.findall(r"'([^']*)'", choice[2]))
        super().error(shortened(message))

    def _get_values(self, action, arg_strings):
        """Refuse `--name=--`, which argparse takes for no value at all."""
        if action.option_strings and "--" in arg_strings:
            raise argparse.ArgumentError(action, "'--' found, a value is wanted")
        return super()._get_values(action, arg_strings)


class Listing(argparse.RawDescriptionHelpFormatter):
    """A help with every subcommand on one line; argparse forgets how far their names are indented."""

    def __init__(self, prog: str) -> None:
        """Leave room for their names."""
        super().__init__(prog)
        self._action_max_length = NAME_ROOM + 2
