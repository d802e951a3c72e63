"""Pages of the reference, made of the code: command lines, the Python package, the schema of scenes."""

from __future__ import annotations

import argparse
import os
import tomllib
from collections.abc import Iterator
from pathlib import Path


def commands(_root: Path) -> str:
    """The command lines of `quadgraph`, from their parsers."""
    from quadgraph import cli

    os.environ["COLUMNS"] = "96"
    parser = cli.build_parser(cli.own_commands(), cli.added_commands())
    (subparsers,) = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    lines = ["# Command lines", "", "What `--help` of each command says, from its parser when this site was built."]
    for name, command in subparsers.choices.items():
        if command.declare is not None:
            command.declare, declare = None, command.declare
            declare(command)
        lines += ["", f"## quadgraph {name}", *_command(command)]
        for steps in (action for action in command._actions if isinstance(action, argparse._SubParsersAction)):
            for step, parser_of_step in steps.choices.items():
                lines += ["", f"### quadgraph {name} {step}", *_command(parser_of_step)]
    return "\n".join(lines) + "\n"


def _command(parser: argparse.ArgumentParser) -> Iterator[str]:
    yield from ("", _text(parser.description or ""), "", "```text", parser.format_usage().strip(), "```")
    for group in parser._action_groups:
        actions = [action for action in group._group_actions if action.help != argparse.SUPPRESS]
        if actions:
            yield from ("", f"**{(group.title or '').capitalize()}**", "")
            yield from (_text(group.description), "") if group.description else ()
            for action in actions:
                yield from (_names(action), f":   {_help(parser, action)}", "")
    if parser.epilog:
        yield from ("", _text(parser.epilog))


def _names(action: argparse.Action) -> str:
    metavar = action.metavar if isinstance(action.metavar, str) else (action.dest if action.nargs != 0 else "")
    if not action.option_strings:
        return f"`{metavar}`"
    value = "{" + ",".join(map(str, action.choices)) + "}" if action.choices else metavar
    value = value if action.nargs != 0 else ""
    return ", ".join(f"`{name} {value}`".replace(" `", "`") for name in action.option_strings)


def _help(parser: argparse.ArgumentParser, action: argparse.Action) -> str:
    return _text(parser._get_formatter()._expand_help(action)) if action.help else "as the group says"


def _text(text: str) -> str:
    """Plain text as Markdown: nothing of it is markup but spans of code."""
    pieces = text.split("`")
    for number in range(0, len(pieces), 2):
        for mark in "\\*_<>[]":
            pieces[number] = pieces[number].replace(mark, f"&#{ord(mark)};")
    return "`".join(pieces).replace("\n", " ")


def python(root: Path) -> str:
    """The public names of the Python package, those of docs/public_api.toml, from their docstrings."""
    listed = tomllib.loads((root / "docs/public_api.toml").read_text())
    lines = [
        "# The Python package",
        "",
        "All that `import quadgraph` gives, from the docstrings; how to begin is on [its page](../python.md).",
    ]
    for module in sorted({entry["module"] for entry in listed.values()}):
        lines += ["", f"## {module.rpartition('.')[2].capitalize()}"]
        for name, entry in listed.items():
            if entry["module"] == module:
                lines += ["", f"::: {module}.{name}"]
    return "\n".join(lines) + "\n"


def scene(root: Path) -> str:
    """The schema of scene files, whole."""
    schema = (root / "docs/scene.schema.json").read_text()
    return (
        "# Scene schema\n\nThe JSON Schema (2020-12) of [scene files](../scene.md), for editors: "
        "[scene.schema.json](../scene.schema.json).\n\n"
        f"```json\n{schema.rstrip()}\n```\n"
    )


PAGES = {"reference/commands.md": commands, "reference/python.md": python, "reference/scene.md": scene}
