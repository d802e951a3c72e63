"""What pages say, checked: places, names of files, and values as errors show them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from quadgraph import core
from quadgraph.base.errors import InputError

MOST_PLACES = 64  # of a stroke in one message
NAMES_FILE = frozenset({"file", "image", "mask", "shapes", "volume", "from"})


def shares(name: str, places: Any) -> list[tuple[float, float]]:
    """Pairs of finite numbers. Raises InputError."""
    if not isinstance(places, list) or not 0 < len(places) <= MOST_PLACES:
        raise InputError(f"{name}: found {shown(places)}, allowed are 1 to {MOST_PLACES} places [x, y]")
    for place in places:
        numbers = isinstance(place, list) and len(place) == 2 and all(type(each) in (int, float) for each in place)
        if not numbers or not all(abs(each) <= 10 for each in place):
            raise InputError(f"{name}: found {shown(place)}, allowed are [x, y] in shares of the picture")
    return [(float(x), float(y)) for x, y in places]


def points_in(edits: Iterable[Any]) -> int:
    """Points of all strokes of edits and layers."""
    found = 0
    for edit in edits:
        for holder in (edit, edit.get("mirrored", {})):
            found += len(holder.get("stroke", ()))
        found += 1 + points_in(edit.get("edits", ()))
    return found


def layers_of(edits: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Of the `edits` of a scene with all members filled in: "name", "visible" and "opacity" of each layer, the lowest
    first, and how many "strokes" it has.
    """
    if edits and "edits" not in edits[0]:  # those of a layer as it is at first
        edits = [{"name": "Layer 1", "visible": True, "opacity": 1.0, "edits": edits}]
    told = [{name: each[name] for name in ("name", "visible", "opacity")} for each in edits]
    return [said | {"strokes": len(each["edits"])} for said, each in zip(told, edits, strict=True)]


def files(value: Any) -> Iterable[str]:
    """Names of files in the members of a JSON value, however deep."""
    if isinstance(value, list):
        for each in value:
            yield from files(each)
    elif isinstance(value, Mapping):
        for name, each in value.items():
            if name in NAMES_FILE and isinstance(each, str):
                yield each
            else:
                yield from files(each)


def material_files(material: Any) -> Iterable[str]:
    """The file that a material's text names, if it does."""
    named = core.volume_name(material) if isinstance(material, str) else None
    return [named[0]] if named else []


def shown(value: Any) -> str:
    """A JSON value in an error, at most 40 letters of it."""
    text = json.dumps(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
