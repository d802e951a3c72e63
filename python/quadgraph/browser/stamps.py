"""Images that brushes of pages stamp: those beside the scene's file, and what visitors send, kept while it is served.

What is sent is a PNG of a limited size, of which chunks that are no part of the picture are left out, and nothing of it
is read before its size is known.
"""

from __future__ import annotations

import contextlib
import copy
import io
import json
import re
import shutil
import struct
import tempfile
import threading
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from quadgraph import core
from quadgraph.base.errors import InputError
from quadgraph.browser.page_values import shown

MOST_SENT_BYTES = 4 << 20  # of an image
MOST_SENT_SIDE = 1024  # texels
MOST_SENT = 16  # images, as long as it is served
MOST_BESIDE, MOST_BESIDE_BYTES = 256, 16 << 20
_SUFFIXES = frozenset({".png", ".exr", ".hdr"})
_MOST_LETTERS = 48  # of a name
_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_FRAME_BYTES = 12  # of a chunk, beside what it holds: its length, kind and check sum
_KEPT_CHUNKS = frozenset({b"IHDR", b"PLTE", b"IDAT", b"IEND", b"tRNS", b"gAMA", b"sRGB", b"cHRM"})
_STAMPED = ("image", "mask")  # members of an edit


class Stamps:
    """Images by names that pages may say. Safe between threads; use it in a `with` block."""

    def __init__(self, folder: Path | None = None) -> None:
        """Take the images of a folder, by their names; none without. `self.folder` is where those are that are sent."""
        self._beside = {path.name: path.resolve() for path in _images_in(folder)} if folder else {}
        self.folder = Path(tempfile.mkdtemp(prefix="quadgraph-serve-"))
        self._sent: dict[str, bytes] = {}
        self._lock = threading.Lock()

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Forget what was sent."""
        self.close()

    def close(self) -> None:
        """Forget what was sent."""
        shutil.rmtree(self.folder, ignore_errors=True)

    @property
    def names(self) -> list[str]:
        """What a page may say: those of the folder, and then those that were sent."""
        with self._lock:
            return [*self._beside, *self._sent]

    def path(self, name: Any) -> str:
        """Where the image of that name is. Raises InputError for other names."""
        names = self.names
        if not isinstance(name, str) or name not in names:
            allowed = ", ".join(names) or "none yet, a page can send one"
            raise InputError(f"found the image {shown(name)}, there are {allowed}")
        return str(self._beside.get(name, self.folder / name))

    def take(self, name: str, content: bytes) -> str:
        """Keep an image that a page sends, and return what it is called from now on. Raises InputError."""
        picture = _checked_png(content)
        with self._lock:
            same = [known for known, kept in self._sent.items() if kept == picture]
            if same:
                return same[0]
            if len(self._sent) >= MOST_SENT:
                raise InputError(f"image: {MOST_SENT} were sent already, and no more are kept")
            called = self._free_name(name)
            path = self.folder / called
            path.write_bytes(picture)
            try:
                core.read_image(str(path))
            except InputError as error:
                path.unlink()
                raise InputError(f"image: {str(error).removeprefix(f'{path}: ')}") from None
            self._sent[called] = picture
            return called

    def _free_name(self, name: str) -> str:
        said = re.sub(r"\.png$", "", name, flags=re.IGNORECASE)
        stem = re.sub(r"[^A-Za-z0-9_-]+", "-", said)[:_MOST_LETTERS].strip("-") or "image"
        for number in range(1, len(self._beside) + len(self._sent) + 2):
            called = f"{stem}.png" if number == 1 else f"{stem}-{number}.png"
            if called not in self._beside and called not in self._sent:
                break
        return called

    def sent_in(self, edits: Sequence[Mapping[str, Any]]) -> list[str]:
        """Names of images that were sent and that edits of a scene stamp."""
        kept = {Path(file).name for file in stamped(edits) if Path(file).parent == self.folder}
        return sorted(kept)

    def bundle(self, document: Mapping[str, Any]) -> bytes:
        """A .zip of a scene file and, beside it, what was sent of the images that it names."""
        edits = copy.deepcopy(document.get("edits", []))
        for edit in _edits_in(edits):
            for member in _STAMPED:
                if member in edit and Path(edit[member]).parent == self.folder:
                    edit[member] = Path(edit[member]).name
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as archive:
            archive.writestr("scene.json", scene_text({**document, "edits": edits}))
            for name in self.sent_in(document.get("edits", [])):
                archive.writestr(name, self._sent[name])
        return packed.getvalue()


def scene_text(document: Mapping[str, Any]) -> str:
    """The text of a scene file."""
    return json.dumps({"quadgraph_scene": 1, **document}, indent=2)


def stamped(edits: Sequence[Mapping[str, Any]]) -> set[str]:
    """Files of images that edits and those of layers stamp."""
    return {edit[member] for edit in _edits_in(edits) for member in _STAMPED if member in edit}


def _edits_in(edits: Sequence[Any]) -> Iterator[Any]:
    for edit in edits:
        yield edit
        yield from edit.get("edits", ())


def _images_in(folder: Path) -> Iterator[Path]:
    """Images of a folder, of a size that a page may ask for, the first by their names."""
    with contextlib.suppress(OSError):  # of a folder that cannot be listed
        found = [path for path in sorted(folder.iterdir()) if path.suffix.lower() in _SUFFIXES]
        fits = [path for path in found if path.is_file() and path.stat().st_size <= MOST_BESIDE_BYTES]
        yield from fits[:MOST_BESIDE]


def _checked_png(content: bytes) -> bytes:
    """What of a PNG makes the picture. Raises InputError for anything else, and for one that is too large."""
    if len(content) > MOST_SENT_BYTES:
        raise InputError(f"image: found {len(content)} bytes, allowed are {MOST_SENT_BYTES}")
    if not content.startswith(_SIGNATURE):
        raise InputError("image: found no PNG, allowed is a .png")
    chunks = list(_chunks(content))
    if not chunks or chunks[0][0] != b"IHDR" or len(chunks[0][1]) != _FRAME_BYTES + 13:
        raise InputError("image: found a PNG that does not say its size")
    width, height = struct.unpack_from(">II", chunks[0][1], 8)
    if not (1 <= width <= MOST_SENT_SIDE and 1 <= height <= MOST_SENT_SIDE):
        raise InputError(f"image: found {width}x{height} texels, allowed are 1 to {MOST_SENT_SIDE} a side")
    return _SIGNATURE + b"".join(whole for kind, whole in chunks if kind in _KEPT_CHUNKS)


def _chunks(content: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Kinds of the chunks of a PNG, and their bytes. Raises InputError where one ends beyond the file."""
    at = len(_SIGNATURE)
    while at < len(content):
        end = at + _FRAME_BYTES + int.from_bytes(content[at : at + 4], "big")
        if end > len(content):
            raise InputError("image: found a PNG that is cut off")
        kind = content[at + 4 : at + 8]
        yield kind, content[at:end]
        if kind == b"IEND":
            return
        at = end
