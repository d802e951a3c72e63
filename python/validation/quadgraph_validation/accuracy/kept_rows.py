"""Rows of a long study that is gone on with: those of its record are kept, and each new one is written at once."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from quadgraph.base.errors import InputError

Row = dict[str, Any]


@dataclass
class KeptRows:
    """only: names of the cases that are wanted, none: all; rows: that there are already, of these cases and others;
    write: is given all rows, in the order of the cases, after each new one; tell: is given the name of a case before;
    spread: makes the rows of cases by their names, in place of one case after the other.
    """

    only: Sequence[str] = ()
    rows: list[Row] = field(default_factory=list)
    write: Callable[[list[Row]], None] = lambda rows: None
    tell: Callable[[str], None] = lambda name: None
    spread: Callable[[Sequence[str]], list[Row]] | None = None

    def complete(self, cases: Iterable[tuple[str, Callable[[], Row]]]) -> list[Row]:
        """The rows of all wanted cases, each by its name, and after them those that are there of others; none that is
        there is made again or lost. Raises InputError for a wanted name that no case has.
        """
        every = list(cases)
        names = [name for name, _ in every]
        if unknown := [name for name in self.only if name not in names]:
            raise InputError(f"--scene: {', '.join(unknown)} found, allowed are {', '.join(names)}")
        found = {row["name"]: row for row in self.rows}
        missing = {name: make for name, make in every if name not in found and (not self.only or name in self.only)}
        if self.spread is not None:
            found |= {row["name"]: row for row in self.spread(list(missing))}
            self.write(self._in_order(found, names))
            return self._in_order(found, names)
        for name, make in missing.items():
            self.tell(name)
            found[name] = {"name": name} | make()
            self.write(self._in_order(found, names))
        return self._in_order(found, names)

    @staticmethod
    def _in_order(found: dict[str, Row], names: Sequence[str]) -> list[Row]:
        return [found[name] for name in dict.fromkeys([*names, *found]) if name in found]


def read(path: Path, study: str, **same: Any) -> list[Row]:
    """The rows of a record of a study, none where there is no file. same: members that it has to have.

    Raises InputError for any other file.
    """
    if not path.exists():
        return []
    try:
        record = json.loads(path.read_text())
        found = {name: record[name] for name in ("study", *same)}
        rows = list(record["rows"])
        if not all(isinstance(row["name"], str) for row in rows):
            raise ValueError("rows without names")
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: not a record of `accuracy {study}` ({error}); name another file") from error
    wanted = {"study": study} | same
    if found != wanted:
        raise InputError(f"{path}: {found} found, --resume needs {wanted}; name another file")
    return rows
