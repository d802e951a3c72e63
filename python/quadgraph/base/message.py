"""Texts of errors, kept short whatever they quote."""

import difflib
import re
from collections.abc import Iterable

ERROR = "quadgraph: error: "  # how the command line begins a line that says what went wrong
MOST = 440  # characters; and the program's name before them is still less than 480
_KEPT_OF_WORD = 45
_LONG_WORD = re.compile(r"\S{101,}")
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")  # what a terminal obeys
_KEPT_FIRST, _KEPT_LAST = 180, 250  # of a whole text


def shortened(text: str) -> str:
    """Leave out the middle of long words, and then of the whole, where a text is longer than MOST.

    What it begins with, the place, and what it ends with, the next step, stay. Control characters stand there as \\xNN.
    engine/base/message.h does the same.
    """
    text = _CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", text)
    if len(text) <= MOST:
        return text
    text = _LONG_WORD.sub(lambda word: f"{word[0][:_KEPT_OF_WORD]}...{word[0][-_KEPT_OF_WORD:]}", text)
    return text if len(text) <= MOST else f"{text[:_KEPT_FIRST]}...{text[-_KEPT_LAST:]}"


def meant(found: str, names: Iterable[str]) -> str:
    """` (did you mean 'NAME'?)` with the one of `names` that `found` is a slip of; else nothing."""
    close = difflib.get_close_matches(found[:MOST], list(names), n=1, cutoff=0.65)
    return f" (did you mean '{close[0]}'?)" if close else ""
