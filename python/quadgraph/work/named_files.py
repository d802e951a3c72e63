"""Files that texts name, as those of materials, lights and scenes do: what a task reads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

_LONGEST = 4096  # characters of a name


def named_files(texts: Iterable[str]) -> list[Path]:
    """The files that texts or their parts between colons and commas name, as far as they are there, each once."""
    parts = [part for text in texts for part in (text, *re.split("[:,]", text)) if part and "\0" not in part]
    return [path for part in dict.fromkeys(parts) if len(part) < _LONGEST and (path := Path(part)).is_file()]


def texts_in(value: Any) -> Iterator[str]:
    """All texts in a document of JSON."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list)):
        for each in value.values() if isinstance(value, dict) else value:
            yield from texts_in(each)
