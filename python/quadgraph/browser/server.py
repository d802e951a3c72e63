"""The server between pages and frames: one page, one WebSocket for each that shows it, on a thread of its own.

A page sends JSON, as `FrameLoop` does it, and images for its brush; it is sent, for every frame, a JSON text and then
the JPEG, the newest one whenever it has shown the one before. Whoever has the token may look and change; nothing else
is asked.
"""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import io
import json
import secrets
import threading
from collections.abc import Mapping
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from quadgraph.base.errors import InputError
from quadgraph.base.optional_package import optional_package
from quadgraph.browser.film_desk import FilmDesk
from quadgraph.browser.films import Films
from quadgraph.browser.frame_loop import ShownFrame
from quadgraph.browser.inbox import Inbox, Message
from quadgraph.browser.stamps import MOST_SENT_BYTES, Stamps, scene_text

if TYPE_CHECKING:
    from aiohttp import web

MOST_PAGES = 8
MOST_BYTES = 1 << 16  # of a message
_SHOWN_S = 5.0  # after which a page that has not said that it shows a frame gets the next
_SCRIPTS = ("page.js", "brush.js", "stamps.js", "film.js")
_FILES = {**dict.fromkeys(_SCRIPTS, "text/javascript"), "page.css": "text/css"}
# The token stands in the address: it must not leave with a link, or stay in a cache.
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self' ws: wss:; base-uri 'none'; form-action 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


class Page:
    """One page that is connected: the newest frame that it has not been sent."""

    def __init__(self, socket: web.WebSocketResponse) -> None:
        """Hold its socket."""
        self.socket = socket
        self.news = asyncio.Event()
        self.shown = asyncio.Event()
        self.shown.set()

    async def send_frames(self, server: Server) -> None:
        """Send frames as they come, the newest only, each after the one before was shown."""
        sent = 0
        while True:
            await self.news.wait()
            self.news.clear()
            frame = server.frame
            if frame is None or frame.serial == sent:
                continue
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self.shown.wait(), _SHOWN_S)
            self.shown.clear()
            frame = server.frame or frame
            sent = frame.serial
            await self.socket.send_json({"frame": dict(frame.said)})
            if frame.jpeg:
                await self.socket.send_bytes(frame.jpeg)


class Server:
    """Serves the page and its frames while it is open. Use it in a `with` block."""

    def __init__(self, host: str, port: int, token: str, hello: dict[str, Any], stamps: Stamps, films: Films) -> None:
        """Take a place to listen at, 0 for any free port; hello: what a page is told at first; stamps: what takes the
        images that pages send; films: what makes those that they ask for.

        Raises InputError where the package is not there.
        """
        optional_package("aiohttp", "serve")
        self._host, self._port, self._hello, self._stamps = host, port, hello, stamps
        self._token = token or secrets.token_urlsafe(24)
        self._inbox: Inbox | None = None
        self._pages: set[Page] = set()
        self._loop = asyncio.new_event_loop()
        self._ended = asyncio.Event()
        self._started: threading.Event = threading.Event()
        self._trouble: OSError | None = None
        self._thread = threading.Thread(target=self._run, name="quadgraph-serve", daemon=True)
        self._desk = FilmDesk(films, self._tell_all)
        self._telling: set[asyncio.Task[None]] = set()
        self._at_rest: npt.NDArray[np.uint8] | None = None
        self.frame: ShownFrame | None = None

    def open(self, inbox: Inbox) -> None:
        """Listen; what pages say goes into the inbox. Raises InputError where that cannot be."""
        self._inbox = inbox
        self._thread.start()
        self._started.wait()
        if self._trouble is not None:
            self._thread.join()
            raise InputError(
                f"--port: {self._host} port {self._port} cannot be listened at ({self._trouble.strerror}); another "
                "one, or 0 for any that is free"
            )

    def close(self) -> None:
        """Send the pages away and end the thread."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._ended.set)
            self._thread.join()

    @property
    def address(self) -> str:
        """What a browser opens."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"http://{host}:{self._port}/?token={self._token}"

    def show(self, frame: ShownFrame) -> None:
        """Give all pages a new frame; from any thread."""

        def tell() -> None:
            self.frame = frame
            if frame.srgb is not None:
                self._at_rest = frame.srgb
            for page in self._pages:
                page.news.set()

        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(tell)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve())
        finally:
            self._loop.close()

    async def _serve(self) -> None:
        from aiohttp import web

        application = web.Application()
        application.router.add_get("/", self._index)
        application.router.add_get("/live", self._live)
        application.router.add_get("/scene.json", self._scene)
        application.router.add_get("/scene.zip", self._bundle)
        application.router.add_get("/picture.png", self._picture)
        application.router.add_get("/film", self._film)
        application.router.add_post("/stamp", self._stamp)
        for name in _FILES:
            application.router.add_get(f"/{name}", self._file)
        runner = web.AppRunner(application, access_log=None, shutdown_timeout=1.0)
        await runner.setup()
        try:
            site = web.TCPSite(runner, self._host, self._port)
            await site.start()
            self._port = runner.addresses[0][1]
        except OSError as error:
            self._trouble = error
            self._started.set()
            await runner.cleanup()
            return
        self._started.set()
        await self._ended.wait()
        for page in list(self._pages):
            await page.socket.close(code=1001, message=b"the server ends")
        await runner.cleanup()

    def _knows(self, request: web.Request) -> bool:
        return hmac.compare_digest(request.query.get("token", "").encode(), self._token.encode())

    def _refused(self) -> web.Response:
        from aiohttp import web

        said = "The token in the address is missing or wrong. The terminal that serves this says the whole address."
        return web.Response(status=403, text=said, headers=_HEADERS)

    async def _index(self, request: web.Request) -> web.Response:
        from aiohttp import web

        if not self._knows(request):
            return self._refused()
        return web.Response(text=_page_file("page.html"), content_type="text/html", headers=_HEADERS)

    async def _file(self, request: web.Request) -> web.Response:
        from aiohttp import web

        name = request.path.removeprefix("/")
        return web.Response(text=_page_file(name), content_type=_FILES[name], headers=_HEADERS)

    async def _scene(self, request: web.Request) -> web.Response:
        from aiohttp import web

        if not self._knows(request):
            return self._refused()
        scene = dict(self.frame.scene) if self.frame else {}
        if sent := self._stamps.sent_in(scene.get("edits", [])):
            said = f"The scene stamps images that pages have sent ({', '.join(sent)}): scene.zip has it with these."
            return web.Response(status=409, text=said, headers=_HEADERS)
        headers = {**_HEADERS, "Content-Disposition": 'attachment; filename="scene.json"'}
        return web.Response(text=scene_text(scene), content_type="application/json", headers=headers)

    async def _bundle(self, request: web.Request) -> web.Response:
        from aiohttp import web

        if not self._knows(request):
            return self._refused()
        packed = await asyncio.to_thread(self._stamps.bundle, dict(self.frame.scene) if self.frame else {})
        headers = {**_HEADERS, "Content-Disposition": 'attachment; filename="scene.zip"'}
        return web.Response(body=packed, content_type="application/zip", headers=headers)

    async def _stamp(self, request: web.Request) -> web.Response:
        """Keep an image for brushes; tells the name that it has, or why it is refused."""
        from aiohttp import web

        if not self._knows(request):
            return self._refused()
        content = bytearray()
        if (request.content_length or 0) <= MOST_SENT_BYTES:
            async for part in request.content.iter_chunked(1 << 16):
                content += part
                if len(content) > MOST_SENT_BYTES:
                    break
        if not content or len(content) > MOST_SENT_BYTES:
            said = f"image: allowed are 1 to {MOST_SENT_BYTES} bytes"
            return web.json_response({"refused": said}, status=413, headers=_HEADERS)
        try:
            called = await asyncio.to_thread(self._stamps.take, request.query.get("name", ""), bytes(content))
        except InputError as error:
            return web.json_response({"refused": str(error)}, status=400, headers=_HEADERS)
        return web.json_response({"image": called}, headers=_HEADERS)

    async def _picture(self, request: web.Request) -> web.Response:
        from aiohttp import web

        if not self._knows(request):
            return self._refused()
        if self._at_rest is None:
            return web.Response(status=404, text="There is no picture at rest yet.", headers=_HEADERS)
        png = await asyncio.to_thread(_png, self._at_rest)
        headers = {**_HEADERS, "Content-Disposition": 'attachment; filename="picture.png"'}
        return web.Response(body=png, content_type="image/png", headers=headers)

    async def _film(self, request: web.Request) -> web.StreamResponse:
        return await self._desk.file(_HEADERS) if self._knows(request) else self._refused()

    async def _live(self, request: web.Request) -> web.StreamResponse:
        from aiohttp import WSMsgType, web

        if not self._knows(request):
            return self._refused()
        if len(self._pages) >= MOST_PAGES:
            said = f"{MOST_PAGES} pages show this scene already; close one"
            return web.Response(status=503, text=said, headers=_HEADERS)
        socket = web.WebSocketResponse(max_msg_size=MOST_BYTES, heartbeat=20)
        await socket.prepare(request)
        page = Page(socket)
        self._pages.add(page)
        await socket.send_json({"hello": self._hello | {"images": self._stamps.names}})
        await socket.send_json(self._desk.said)
        page.news.set()
        sender = asyncio.create_task(page.send_frames(self))
        try:
            async for message in socket:
                if message.type == WSMsgType.TEXT:
                    await self._hear(page, message.data)
        finally:
            self._pages.discard(page)
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)
        return socket

    async def _hear(self, page: Page, text: str) -> None:
        said = _object_in(text)
        if said is None:
            await page.socket.send_json({"refused": "a JSON object is expected, of Unicode text and finite numbers"})
            return
        if "ping" in said:
            await page.socket.send_json({"pong": said["ping"]})
        elif "shown" in said:
            page.shown.set()
        elif "film" in said:
            try:
                await self._desk.hear(said["film"], self.frame.scene if self.frame else None)
            except InputError as error:
                await page.socket.send_json({"refused": str(error)})
        elif self._inbox is not None:
            self._inbox.put(Message(said, lambda answer: self._answer(page, dict(answer))))

    def _answer(self, page: Page, answer: dict[str, Any]) -> None:
        """Tell one page something; from any thread."""
        self._loop.call_soon_threadsafe(lambda: self._tell(page, answer))

    def _tell_all(self, said: Mapping[str, Any]) -> None:
        """Tell all pages something; from the server's thread."""
        for page in self._pages:
            self._tell(page, said)

    def _tell(self, page: Page, said: Mapping[str, Any]) -> None:
        async def tell() -> None:
            if not page.socket.closed:
                await page.socket.send_json(said)

        self._telling.add(task := self._loop.create_task(tell()))
        task.add_done_callback(self._telling.discard)


def _object_in(text: str) -> dict[str, Any] | None:
    """The JSON object of a message; None of anything else, and of what no file of a scene could hold."""
    try:
        found = json.loads(text)
        json.dumps(found, ensure_ascii=False, allow_nan=False).encode()
    except (ValueError, RecursionError):  # no Unicode and no JSON are ValueErrors
        return None
    return found if isinstance(found, dict) else None


def _png(srgb: npt.NDArray[np.uint8]) -> bytes:
    from PIL import Image

    encoded = io.BytesIO()
    Image.fromarray(srgb).save(encoded, "PNG")
    return encoded.getvalue()


def _page_file(name: str) -> str:
    return (resources.files("quadgraph.browser") / "page" / name).read_text(encoding="utf-8")
