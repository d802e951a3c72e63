"""Defaults of options from the user's file (quadgraph.base.config_file): for all commands, and for one in its table."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from quadgraph.base import config_file
from quadgraph.base.errors import InputError
from quadgraph.base.message import meant

OFF = "--no-config"


@dataclass(frozen=True)
class Config:
    """What the file says: values by the names of options, for all commands and by command."""

    shared: Mapping[str, Any]
    tables: Mapping[str, Mapping[str, Any]]


def load(commands: Iterable[str]) -> Config:
    """Read the file. Raises InputError for a table that is none of a command."""
    document = config_file.load()
    tables = {name: value for name, value in document.items() if isinstance(value, dict)}
    names = list(commands)
    for name in tables:
        if name not in names:
            raise _refusal(f"[{name}]{meant(name, names)}", "found", f"tables of commands are: {', '.join(names)}")
    return Config({name: value for name, value in document.items() if name not in tables}, tables)


def apply(
    config: Config,
    command: str,
    parser: argparse.ArgumentParser,
    known_elsewhere: Callable[[], set[str] | None],
) -> dict[str, Any]:
    """Let what the file says be the defaults of a command; return the defaults before that, by destination.

    known_elsewhere: names of options of all commands, which values for all may name; None where they cannot be told.
    Raises InputError for a name that is none, and for a value that the option does not take.
    """
    options = options_of(parser)
    before: dict[str, Any] = {}
    own = config.tables.get(command, {})
    for name in own:
        if name not in options:
            raise _refusal(f"[{command}] {name}{meant(name, options)}", "found", f"allowed are {', '.join(options)}")
    for name, value in {**config.shared, **own}.items():
        if name in options:
            action = options[name]
            before.setdefault(action.dest, action.default)
            action.default = value_of(parser, action, name if name not in own else f"[{command}] {name}", value)
        elif (allowed := known_elsewhere()) is not None and name not in allowed:
            raise _refusal(f"{name}{meant(name, allowed)}", "found", f"allowed are {', '.join(sorted(allowed))}")
    return before


def options_of(parser: argparse.ArgumentParser) -> dict[str, argparse.Action]:
    """Options of a command by their names without hyphens in front; none that has to be typed in any case."""
    found = {}
    for action in parser._actions:
        names = [text[2:] for text in action.option_strings if text.startswith("--")]
        if names and not action.required and action.default is not argparse.SUPPRESS:
            found[names[0]] = action
    return found


def value_of(parser: argparse.ArgumentParser, action: argparse.Action, name: str, value: Any) -> Any:
    """What an option makes of a value of the file, by the checks of the command line. Raises InputError."""
    if action.nargs == 0:
        if not isinstance(value, bool):
            raise _refusal(name, f"found {value!r}", "allowed are true and false")
        return value
    if isinstance(action, argparse._AppendAction):
        values = value if isinstance(value, list) else [value]
        return [_checked(parser, action, name, each) for each in values]
    return _checked(parser, action, name, value)


def _checked(parser: argparse.ArgumentParser, action: argparse.Action, name: str, value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise _refusal(name, f"found {value!r}", "allowed is a text or a number, as it is typed")
    try:
        found = parser._get_value(action, str(value))
        parser._check_value(action, found)
    except argparse.ArgumentError as error:
        raise _refusal(name, f"found {value!r}", error.message) from error
    return found


def _refusal(name: str, found: str, allowed: str) -> InputError:
    return InputError(f"{config_file.place()}: {name}: {found}; {allowed} (or use {OFF})")
