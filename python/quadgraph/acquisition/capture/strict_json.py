"""Members of a JSON document that is read strictly; errors name the path into it, found and allowed."""

from __future__ import annotations

import json
import math
from collections.abc import Collection
from typing import Any, NoReturn

from quadgraph.base.errors import InputError
from quadgraph.base.message import meant

_SHOWN = 60  # characters of a value that errors quote


def shown(value: object) -> str:
    """A value as JSON, cut where it is long."""
    text = json.dumps(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


class Member:
    """A value in a document, and the path to it, as `photographs[3].camera`."""

    def __init__(self, file: str, path: str, value: Any) -> None:
        """file: the document's name, which begins every error."""
        self.file, self.path, self.value = file, path, value

    def wrong(self, allowed: str) -> NoReturn:
        """Raise InputError: path, what was found, what is allowed and what to do next."""
        raise InputError(f"{self.file}: {self.path or 'the document'}: found {shown(self.value)}, {allowed}")

    def members(self, required: Collection[str], optional: Collection[str]) -> dict[str, Member]:
        """The members of an object of these names and no other. Raises InputError."""
        if not isinstance(self.value, dict):
            self.wrong("allowed is an object")
        known = [*required, *optional]
        for name in self.value:
            if name not in known:
                self._child(name).wrong(
                    f"allowed is nothing of this name{meant(name, known)}; allowed are {', '.join(known)}"
                )
        for name in required:
            if name not in self.value:
                raise InputError(f"{self.file}: {self._child(name).path}: is missing, it has to be there")
        return {name: self._child(name) for name in self.value}

    def named(self) -> dict[str, Member]:
        """The members of an object of any names. Raises InputError where there is none."""
        if not isinstance(self.value, dict) or not self.value:
            self.wrong("allowed is an object with at least one member, each with a name of your own")
        return {name: self._child(name) for name in self.value}

    def items(self, most: int) -> list[Member]:
        """The items of a list, of which there have to be one to `most`. Raises InputError."""
        if not isinstance(self.value, list) or not 1 <= len(self.value) <= most:
            found = f"{len(self.value)} items" if isinstance(self.value, list) else shown(self.value)
            raise InputError(f"{self.file}: {self.path}: found {found}, allowed is a list of 1 to {most}")
        return [Member(self.file, f"{self.path}[{number}]", value) for number, value in enumerate(self.value)]

    def number(self, low: float, high: float, what: str, above: bool = False) -> float:
        """A finite number from `low` to `high`, without `low` itself if `above`. Raises InputError."""
        value = self.value
        fine = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
        if not fine or not low <= value <= high or (above and value == low):
            self.wrong(f"allowed is a number {'above' if above else 'from'} {low:g} to {high:g} ({what})")
        return float(value)

    def whole(self, low: int, high: int, what: str) -> int:
        """A whole number from `low` to `high`. Raises InputError."""
        if not isinstance(self.value, int) or isinstance(self.value, bool) or not low <= self.value <= high:
            self.wrong(f"allowed is a whole number from {low} to {high} ({what})")
        return self.value

    def text(self, what: str) -> str:
        """A text that is not empty. Raises InputError."""
        if not isinstance(self.value, str) or not self.value or "\0" in self.value:
            self.wrong(f"allowed is a text ({what})")
        return self.value

    def one_of(self, names: Collection[str], next_step: str) -> str:
        """One of these texts. Raises InputError."""
        if not isinstance(self.value, str) or self.value not in names:
            slip = meant(self.value, names) if isinstance(self.value, str) else ""
            self.wrong(f"allowed are {', '.join(names)}{slip}; {next_step}")
        return self.value

    def _child(self, name: str) -> Member:
        value = self.value.get(name)
        return Member(self.file, f"{self.path}.{name}" if self.path else name, value)
