"""JSON from files of others, by the rules of engine/base/json_text.h: parsers and what walks their values recurse."""

from __future__ import annotations

import json
import re
from typing import Any

from quadgraph.base.errors import InputError

DEPTH = 64  # brackets in each other
BYTES = 64 << 20
_TOKENS = re.compile(rb'"(?:[^"\\]|\\.)*"?|[\[{\]}]', re.DOTALL)


def place(text: bytes, byte: int) -> str:
    """Return "line 3, column 14" of a byte."""
    line = text.rfind(b"\n", 0, byte)
    return f"line {text.count(chr(10).encode(), 0, byte) + 1}, column {byte - line}"


def check(text: bytes) -> None:
    """Raise InputError naming place, what was found and what is allowed where a text is too long or too deep."""
    if len(text) > BYTES:
        raise InputError(f"JSON of {len(text)} bytes found, allowed are {BYTES}")
    depth = 0
    for token in _TOKENS.finditer(text):
        if token[0] in (b"[", b"{"):
            depth += 1
            if depth > DEPTH:
                where = place(text, token.start())
                raise InputError(
                    f"JSON nested deeper than {DEPTH} levels at {where}, which is the most that is allowed"
                )
        elif token[0] in (b"]", b"}"):
            depth = max(depth - 1, 0)


def loads(text: bytes) -> Any:
    """Return the value of a document. Raises InputError that says where it is none."""
    check(text)
    try:
        return json.loads(text.decode("utf-8"))
    except json.JSONDecodeError as error:
        raise InputError(f"no JSON at line {error.lineno}, column {error.colno}: {error.msg}") from None
    except ValueError as error:
        raise InputError(f"no JSON in UTF-8: {error}") from None
