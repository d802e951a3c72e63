"""What a command is to write, held against what it reads before any work is done."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable
from pathlib import Path

from quadgraph.base.errors import InputError


def check_kind(path: Path) -> None:
    """Raise InputError unless `path` is a regular file, which is replaced, or a new name."""
    if path.is_symlink():
        what = "a link"
    elif path.is_dir():
        what = "a folder"
    elif path.exists() and not path.is_file():
        what = "no regular file"
    else:
        return
    raise InputError(f"{path}: is {what}, allowed is a regular file or a new name")


def check_folder(path: Path) -> None:
    """Raise InputError unless there is a folder for `path` to lie in."""
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist; make it, or give another name")


def check_outputs(
    outputs: Iterable[Path | None], inputs: Iterable[Path | str | None], made: Collection[Path] = ()
) -> None:
    """Raise InputError where an output is one of the inputs or another output, or as `check_kind` or `check_folder`.

    inputs: files, and texts that may name some, as those of lights do: each part between colons counts; made: outputs
    whose folders are made where they are missing.
    """
    read = {_identity(Path(part)): part for text in inputs if text for part in _parts(text)}
    written: set[object] = set()
    for path in outputs:
        if path is None:
            continue
        check_kind(path)
        if path not in made:
            check_folder(path)
        name = _identity(path)
        if name in read:
            raise InputError(f"{path}: is read ({read[name]}) and would be replaced; give the output another name")
        if name in written:
            raise InputError(f"{path}: is the name of two outputs; give each its own")
        written.add(name)


def _parts(text: Path | str) -> list[str]:
    whole = str(text)
    return [part for part in (whole, *whole.split(":")) if part and "\0" not in part]


def _identity(path: Path) -> object:
    """The same for two names of one file, hard links among them."""
    try:
        found = path.stat()
    except OSError:
        return os.path.realpath(path)
    return found.st_dev, found.st_ino
