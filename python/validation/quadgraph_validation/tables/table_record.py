"""The record of the tables: rows are kept as they are measured, so that an interrupted run goes on."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from quadgraph.base import atomic_file
from quadgraph.base.errors import InputError, QuadGraphError
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.tables.table_row import TableRow

FORMAT = 1
TITLES = {"1": "Table 1", "12": "Figure 12", "13": "Figure 13", "14": "Figure 14", "packing": "Packed order"}
_SAME = ("device", "driver", "cores", "commit")  # of the machine: rows of one table have them in common


def begin(path: Path, settings: dict[str, Any]) -> dict[str, Any]:
    """The record at `path`, or a new one. Raises InputError if what is there was measured with other settings."""
    if not path.exists():
        return {"format": FORMAT, "settings": settings, "tables": {}}
    record = read(path)
    for name, wanted in settings.items():
        found = record["settings"].get(name)
        if found != wanted:
            raise InputError(
                f"{path}: settings.{name}: {found!r} found, this run has {wanted!r}; give another --json or remove it"
            )
    return record


def _tell_at(tell: ProgressCallback, place: str, text: str) -> None:
    tell(f"{place}: {text}")


def fill(
    path: Path,
    record: dict[str, Any],
    table: str,
    rows: Sequence[TableRow],
    machine: dict[str, Any],
    tell: ProgressCallback,
) -> None:
    """Measure a table's rows into the record and save it after each.

    Rows that a run left which did not end are kept, if it had the same machine and commit; where it ended they are
    measured anew. A row that cannot be measured says why.
    """
    entry = record["tables"].get(table)
    if entry is None or any(entry["machine"].get(name) != machine[name] for name in _SAME):
        entry = record["tables"][table] = {"machine": machine, "complete": False, "rows": {}, "left_out": {}}
    if entry["complete"]:
        wanted = {row.key for row in rows}
        entry["rows"] = {key: row for key, row in entry["rows"].items() if key not in wanted}
        entry["complete"] = False
    for number, row in enumerate(rows):
        if row.key in entry["rows"]:
            continue
        try:
            if row.missing:
                raise InputError(row.missing)
            place = f"{TITLES[table]}, row {number + 1} of {len(rows)}"
            found = row.measure(partial(_tell_at, tell, place))
        except QuadGraphError as error:
            entry["left_out"][row.key] = str(error)
        else:
            entry["left_out"].pop(row.key, None)
            # Through JSON's types, so that what is drawn now is what is drawn from the file.
            entry["rows"][row.key] = json.loads(json.dumps(found))
        atomic_file.write_json(path, record)
    entry["complete"] = True
    atomic_file.write_json(path, record)


def read(path: Path) -> dict[str, Any]:
    """Read a record. Raises InputError, naming file and field, if it is not one."""
    try:
        record = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as JSON: {error}") from error
    for name in ("format", "settings", "tables"):
        if not isinstance(record, dict) or name not in record:
            raise InputError(f"{path}: {name}: not there; `quadgraph tables --json` writes a record")
    if record["format"] != FORMAT:
        raise InputError(f"{path}: format: {record['format']!r} found, {FORMAT} allowed")
    return record
