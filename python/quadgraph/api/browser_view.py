"""A scene in a browser, or in a cell of a notebook, while a process of its own shows it."""

from __future__ import annotations

import html
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path
from subprocess import PIPE
from types import TracebackType
from typing import Self

from quadgraph.api.scene import Scene, SceneFile
from quadgraph.base.child_process import beside
from quadgraph.base.errors import InputError
from quadgraph.base.optional_package import optional_package

_LEAST_HEIGHT, _MOST_HEIGHT = 100, 4000  # pixels


class BrowserView:
    """A scene in a page that orbits, lights and changes it (docs/window.md, "In a browser"); a notebook shows it in a
    cell. Use it in a `with` block, or call `close`.
    """

    def __init__(self, source: Scene | str | Path, *, device: str = "", port: int = 0, height: int = 640) -> None:
        """Start `quadgraph serve` of a scene, or of a baked file, a mesh or a scene file, on this machine alone.

        device: as of `Engine`; port: 0 for any that is free; height: pixels in a notebook. Returns once the address is
        known. Raises InputError where it cannot be shown, for shapes in memory, and without the package: pip install
        'quadgraph[serve]'.
        """
        optional_package("aiohttp", "serve")
        if not isinstance(height, int) or not _LEAST_HEIGHT <= height <= _MOST_HEIGHT:
            raise InputError(f"height: {height!r} found, {_LEAST_HEIGHT} to {_MOST_HEIGHT} pixels allowed")
        self._height = height
        self._open = ExitStack()
        with ExitStack() as failed:
            failed.callback(self._open.close)
            self._address = self._started(source, device, port)
            failed.pop_all()

    def _started(self, source: Scene | str | Path, device: str, port: int) -> str:
        folder = Path(self._open.enter_context(tempfile.TemporaryDirectory(prefix="quadgraph-")))
        if isinstance(source, Scene):
            SceneFile(source).save(folder / "scene.json")
            source = folder / "scene.json"
        said = self._open.enter_context((folder / "said.txt").open("w+"))
        command = [sys.executable, "-m", "quadgraph.cli", "serve", str(source), "--port", str(port)]
        command += ["--device", device] if device else []
        process = self._open.enter_context(beside(command, stdout=PIPE, stderr=said))
        address = process.stdout.readline().strip() if process.stdout else ""
        if not address:
            process.wait()
            said.seek(0)
            raise InputError(said.read().strip().removeprefix("quadgraph: ") or "quadgraph serve said nothing")
        return address

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close."""
        self.close()

    def __repr__(self) -> str:
        """Return the address, without the token."""
        return f"BrowserView({self._address.partition('?')[0]})"

    def close(self) -> None:
        """End it; pages say that they have lost it."""
        self._open.close()

    @property
    def address(self) -> str:
        """What a browser opens, with the token that lets it look and change."""
        return self._address

    def _repr_html_(self) -> str:
        """Show it in a notebook."""
        address = html.escape(self._address, quote=True)
        return f'<iframe src="{address}" width="100%" height="{self._height}" style="border: 0"></iframe>'
