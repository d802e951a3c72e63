"""What a parser knows of what was typed."""

from __future__ import annotations

import argparse
from pathlib import Path

import pytest

from quadgraph.commands.command_parser import CommandParser


@pytest.fixture
def parser() -> CommandParser:
    """One with arguments of every kind, and configured defaults of two that exclude each other."""
    made = CommandParser(prog="quadgraph")
    made.add_argument("file", type=Path, nargs="?")
    made.add_argument("more", type=Path, nargs="*")
    made.add_argument("--size", default="1x1")
    made.add_argument("--light", action="append")
    made.add_argument("--flag", action=argparse.BooleanOptionalAction, default=True)
    made.add_argument("--frames", type=int, nargs="?", const=0)
    either = made.add_mutually_exclusive_group()
    either.add_argument("--unit")
    either.add_argument("--height")
    return made


@pytest.mark.parametrize(
    ("typed", "given"),
    [
        ([], set()),
        (["a.obj", "b.obj", "c.obj"], set()),
        (["--size", "1x1"], {"size"}),
        (["a.obj", "--light", "x", "--light", "y", "--no-flag"], {"light", "flag"}),
        (["--frames"], {"frames"}),
        (["--frames", "3", "--no-config"], {"frames", "no_config"}),
    ],
)
def test_options_that_were_typed_are_known_and_arguments_are_what_they_were(parser, typed, given):
    args = parser.parse_args(typed)
    assert args.given == given
    places = [Path(text) for text in typed if text.endswith(".obj")]
    assert ([args.file] if args.file else []) + list(args.more) == places
    assert args.size == "1x1"


def test_what_is_typed_wins_over_what_is_configured(parser):
    def configure(each):
        before = {"light": None, "height": None}
        each.set_defaults(light=["configured"], height="2cm")
        return before

    parser.configure = configure
    assert parser.parse_args([]).light == ["configured"]
    args = parser.parse_args(["--light", "typed", "--unit", "mm"])
    assert (args.light, args.unit, args.height) == (["typed"], "mm", None)
