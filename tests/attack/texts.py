"""Hostile numbers, texts and JSON values."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

Rng = np.random.Generator
DEEP = 300_000  # brackets in each other, at most

FIXED = ("nan", "inf", "-inf", "1e999", "-1e999", "", " ", "--", "0x10", "1_000", "1,5", "1e", "+-1", "%", "1e-999")
FOREIGN = ("\u0661\u0662", "\uff11\uff12", "\u00bd", "1\u00a0000", "\u22121", "1\u200b2")


def number(rng: Rng) -> str:
    """A number as text, or what only looks like one."""
    kind = rng.integers(8)
    if kind == 0:
        return str(rng.choice(FIXED))
    if kind == 1:
        return str(rng.choice(FOREIGN))
    if kind == 2:
        return str(int(rng.choice([-1, 1])) * 2 ** int(rng.choice([31, 32, 63, 64, 128])) + int(rng.integers(-2, 3)))
    if kind == 3:
        return "9" * int(10 ** rng.uniform(1, 4.5))
    if kind == 4:
        return f"{'-' * int(rng.integers(2))}{rng.uniform(1, 10):.3f}e{int(rng.integers(-330, 330))}"
    if kind == 5:
        return f"{-(10 ** rng.uniform(-3, 6)):.6g}"
    if kind == 6:
        return f"{rng.uniform(0, 10):.3f}{rng.choice(['x', 'mm', '%', ';', ' 1', '/1', chr(27) + '[31m'])}"
    return f"{10 ** rng.uniform(-6, 9):.6g}"


def extreme(rng: Rng) -> float:
    """A finite or infinite number of any size, rarely one that is none."""
    kind = rng.integers(5)
    if kind == 0:
        return float(rng.choice([np.nan, np.inf, -np.inf, 0.0, -0.0]))
    return float(rng.choice([-1, 1]) * 10.0 ** rng.uniform(-45 if kind < 3 else -300, 40 if kind < 3 else 300))


def word(rng: Rng, most: int = 5) -> str:
    """A text of up to 10^most characters, some of them strange."""
    length = int(10 ** rng.uniform(0, most))
    strange = ["\x1b]0;x\x07", "\u202e", "\x00", "\ud7ff", "/../", "%s%n", "\n", "\u00e9"]
    text = "".join(chr(int(c)) for c in rng.integers(33, 127, min(length, 40)))
    return (text * (length // 40 + 1))[:length] + (str(rng.choice(strange)) if rng.integers(2) else "")


def nested(rng: Rng, depth: int) -> str:
    """JSON text of so many brackets in each other."""
    if rng.integers(2):
        return "[" * depth + "]" * depth
    return '{"a":' * depth + "1" + "}" * depth


def depth(rng: Rng) -> int:
    """From one that is allowed, 64, to one that no stack holds."""
    return int(10 ** rng.uniform(1.85, np.log10(DEEP)))


def junk(rng: Rng) -> Any:
    """A JSON value of any kind."""
    values = [
        None,
        True,
        False,
        "",
        word(rng, 3),
        [],
        {},
        [[]],
        int(rng.integers(-(2**40), 2**40)),
        10 ** int(rng.integers(10, 40)),
        float(np.clip(extreme(rng), -1e300, 1e300)) if rng.integers(2) else -1,
        [1, "a", None],
        {"name": {"name": 1}},
        [0] * int(rng.integers(1, 2000)),
    ]
    value = values[int(rng.integers(len(values)))]
    return 0.5 if isinstance(value, float) and value != value else value


def places(value: Any, path: tuple = ()) -> list[tuple]:
    """The paths of all values below a JSON value."""
    found = [path] if path else []
    if isinstance(value, dict):
        for key, each in value.items():
            found += places(each, (*path, key))
    elif isinstance(value, list):
        for index, each in enumerate(value):
            found += places(each, (*path, index))
    return found


def at(value: Any, path: tuple) -> Any:
    """The value at a path."""
    for step in path:
        value = value[step]
    return value


def replaced(document: Any, path: tuple, value: Any) -> Any:
    """A copy of a document with another value at a path."""
    changed = copy.deepcopy(document)
    at(changed, path[:-1])[path[-1]] = value
    return changed


def pick(rng: Rng, values: Any) -> Any:
    """One of several values, of whatever type."""
    return values[int(rng.integers(len(values)))]


def random_bytes(rng: Rng, data: bytes, most: int = 12, first: int = 0) -> bytes:
    """Bytes of which a few are others, from `first` on."""
    changed = bytearray(data)
    for place in rng.integers(first, len(data), int(rng.integers(1, most + 1))):
        changed[place] = int(rng.integers(256))
    return bytes(changed)
