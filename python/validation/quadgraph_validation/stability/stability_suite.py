"""The whole suite: which maps and methods, the points of each, and how many are of which class."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph_validation.stability import arithmetic, columns, solids
from quadgraph_validation.stability.error_classes import CLASSES, FACTOR, SILENT, SMALL, USABLE, USELESS
from quadgraph_validation.stability.stability_maps import CaseOf, Map, StabilitySetting
from quadgraph_validation.stability.stability_methods import DEFAULT, StabilityMethod, chosen

MAPS: tuple[Map, ...] = (*columns.MAPS, *solids.MAPS, columns.TRANSPORT, *arithmetic.MAPS)


def axes(maps: Sequence[Map] = MAPS) -> list[str]:
    """Names of the axes, each once."""
    return list(dict.fromkeys(axis.name for each in maps for axis in (each.x, each.y)))


def maps_with(names: Sequence[str]) -> list[Map]:
    """Maps that have one of the axes, or one of these names themselves; all if there are none.

    Raises InputError for a name that neither an axis nor a map has.
    """
    for name in names:
        if name not in axes() and name not in (each.name for each in MAPS):
            known = ", ".join(axes()), ", ".join(each.name for each in MAPS)
            raise InputError(f"axis '{name}': allowed are {known[0]}; or a map: {known[1]}")
    return [each for each in MAPS if not names or {each.name, each.x.name, each.y.name} & set(names)]


def run(
    maps: Sequence[Map], methods: Sequence[str], setting: StabilitySetting, tell: ProgressCallback = lambda text: None
) -> dict:
    """The record of all maps; methods: names, all if there are none."""
    return record_of([run_map(each, chosen(each.methods, list(methods)), setting, tell) for each in maps])


def record_of(found: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The record of maps, those without panels left out."""
    limits = {"small": SMALL, "factor": FACTOR, "usable": USABLE, "useless": USELESS}
    found = [each for each in found if each["panels"]]
    return {"limits": limits, "maps": found, "counts": counts(found)}


def run_map(
    each: Map, methods: Sequence[StabilityMethod], setting: StabilitySetting, tell: ProgressCallback
) -> dict[str, Any]:
    """The points of a map, row by row from its first y, of every method."""
    case_of = each.cases(setting, each.x.values, each.y.values)
    panels = {}
    for method in methods:
        tell(f"{each.name}: {method.name}")
        panels[method.name] = panel(each, method, case_of)
    return described(each) | {"panels": panels}


def panel(each: Map, method: StabilityMethod, case_of: CaseOf) -> list[list[dict[str, Any]]]:
    """The points of a map of one method, row by row from its first y."""
    return [[each.judge(case_of(x, y), method) for x in each.x.values] for y in each.y.values]


def described(each: Map) -> dict[str, Any]:
    """A map without its points."""
    record: dict[str, Any] = {"name": each.name, "title": each.title, "truth": each.truth}
    for axis, name in ((each.x, "x"), (each.y, "y")):
        texts = [axis.text(index) for index in range(len(axis.values))]
        record[name] = {"axis": axis.name, "label": axis.label, "values": list(axis.values), "texts": texts}
    return record


def read(path: Path, maps: Sequence[str], methods: Sequence[str]) -> dict[str, Any]:
    """A record from its file, reduced to maps of these names and to the methods, all if there are none.

    Raises InputError if it is none.
    """
    try:
        record = json.loads(path.read_text())
        found = []
        for each in record["maps"]:
            panels = {name: rows for name, rows in each["panels"].items() if not methods or name in methods}
            if each["name"] in maps and panels:
                found.append(each | {"panels": panels})
        return record | {"maps": found, "counts": counts(found)}
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: not a record of `quadgraph stability` ({error!r})") from error


def counts(maps: Sequence[dict[str, Any]]) -> dict[str, dict[str, dict[str, int]]]:
    """Points by map, method and class."""
    return {
        each["name"]: {
            method: {name: found[name] for name in CLASSES}
            for method, rows in each["panels"].items()
            for found in [Counter(point["class"] for row in rows for point in row)]
        }
        for each in maps
    }


def silent_of_default(record: dict[str, Any]) -> list[str]:
    """The points of the default method that are wrong silently, in words."""
    texts = []
    for each in record["maps"]:
        for j, row in enumerate(each["panels"].get(DEFAULT.name, [])):
            for i, point in enumerate(row):
                if point["class"] == SILENT:
                    place = (
                        f"{each['x']['label']} {each['x']['texts'][i]}, {each['y']['label']} {each['y']['texts'][j]}"
                    )
                    texts.append(f"{each['name']}: {place}: error {point['true']}, estimate {point['estimate']}")
    return texts
