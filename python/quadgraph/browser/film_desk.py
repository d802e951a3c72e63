"""What a server does with films: begins and ends them as pages say, tells all pages how far they are, and hands the
last one over.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from quadgraph.base.errors import InputError
from quadgraph.browser.films import Films

if TYPE_CHECKING:
    from aiohttp import web

_LOOKS_S = 0.25  # between two looks at how far a film is
CANCEL = "cancel"


class FilmDesk:
    """Films, for a server; used in the thread of its loop."""

    def __init__(self, films: Films, tell: Callable[[Mapping[str, Any]], None]) -> None:
        """Hold films; `tell` says something to all pages."""
        self._films, self._tell = films, tell
        self._following: asyncio.Task[None] | None = None
        self._one = asyncio.Lock()

    @property
    def said(self) -> dict[str, Any]:
        """What pages are told of the film."""
        return {"film": self._films.state}

    async def hear(self, wanted: Any, scene: Mapping[str, Any] | None) -> None:
        """Do what a page said of a film of the scene that is shown: what it is to be, or CANCEL. Raises InputError."""
        async with self._one:
            if wanted == CANCEL:
                if self._following is not None:
                    self._following.cancel()
                await asyncio.to_thread(self._films.cancel)
            elif scene is None:
                raise InputError("film: nothing is shown yet")
            else:
                self._films.begin(scene, wanted)
                self._following = asyncio.get_running_loop().create_task(self._follow())
        self._tell(self.said)

    async def _follow(self) -> None:
        while self._films.making:
            await asyncio.sleep(_LOOKS_S)
            if self._films.follow():
                self._tell(self.said)

    async def file(self, headers: Mapping[str, str]) -> web.StreamResponse:
        """The film, to be kept as a file by a browser."""
        from aiohttp import web

        made = self._films.made
        if made is None:
            return web.Response(status=404, text="There is no film.", headers=headers)
        kept = {"Content-Disposition": f'attachment; filename="film{made.suffix}"'}
        return web.FileResponse(made, headers={**headers, **kept})
