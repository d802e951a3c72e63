"""A mesh in the window: its surface at once, and the body as soon as a child process has baked it."""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import threading
from contextlib import ExitStack, suppress
from pathlib import Path

from rich.console import Console

from quadgraph.baking import bare
from quadgraph.base import atomic_file, child_process
from quadgraph.base.errors import InputError
from quadgraph.base.message import ERROR
from quadgraph.commands import own_mesh


def show(program: str, mesh: Path, args: argparse.Namespace, options: list[str]) -> int:
    """Open the window with a preview of a mesh, bake it meanwhile, and let the window change over to the body.

    args: own_mesh.sizes. Returns the window's exit status once it is closed, 1 if there was no body. The bake ends with
    the window. Raises InputError for a file that is no mesh.
    """
    surface = {name: value for name, value in own_mesh.sizes(args).items() if name != "wrap"}
    with child_process.workspace() as folder, ExitStack() as children:
        (folder / "preview").mkdir()
        preview = folder / "preview" / f"{mesh.stem}.qgraph"
        size_note = bare.write(mesh, preview, **surface).size_note
        bake = _Bake(mesh, args, folder, size_note)
        try:
            bake.start(children)
            window = children.enter_context(
                child_process.beside([program, str(preview), "--copy-body", "--preview", str(bake.news), *options])
            )
            status = window.wait()
        finally:
            bake.closing.set()
            children.close()
            bake.join()
    return status or (1 if bake.failed else 0)


class _Bake:
    """A bake in a child process, which says how it stands: on standard error, and in a file for the window."""

    def __init__(self, mesh: Path, args: argparse.Namespace, folder: Path, size_note: str) -> None:
        self.news = folder / "news.json"
        self.closing = threading.Event()  # the window is closed, and nobody waits for the body
        self.failed = False
        self._mesh = mesh
        self._sizes = own_mesh.sizes(args)
        self._folder = folder
        self._size_note = size_note
        self._console = Console(stderr=True, highlight=False, soft_wrap=True)
        self._follower: threading.Thread | None = None

    def start(self, children: ExitStack) -> None:
        """Start the child, which ends with `children`, and follow what it says."""
        if self._size_note:
            self._tell(self._size_note)
        # The window, which shares the processor with it, comes first.
        command = ["nice", sys.executable, "-P", "-m", "quadgraph.commands.preview_child"]
        answer = children.enter_context((self._folder / "answer.json").open("w"))
        child = children.enter_context(
            child_process.beside(
                [*command, str(self._mesh), json.dumps(self._sizes), str(self._folder)],
                stdout=answer,
                stderr=subprocess.PIPE,
                # What a child leaves that had to be killed is in the folder that goes.
                env=os.environ | {"TMPDIR": str(self._folder)},
            )
        )
        self._follower = threading.Thread(target=self._follow, args=(child,), name="bake of the preview")
        self._follower.start()

    def join(self) -> None:
        """Wait for the end of what follows the child, which has ended."""
        if self._follower is not None:
            self._follower.join()

    def _follow(self, child: subprocess.Popen[str]) -> None:
        last = ""
        assert child.stderr is not None
        with child.stderr, self._console.status(f"baking {self._mesh.name}, once for this mesh and size"):
            for line in child.stderr:
                last = line.strip() or last
                if last == self._size_note:  # which was told at first
                    continue
                if last.startswith(ERROR) and not self.closing.is_set():
                    self.failed = True  # its process may end after the window
                self._tell(last)
                self._announce("progress", last)
        status = child.wait()
        if self.closing.is_set():
            return
        if status == 0:
            self._announce("body", json.loads((self._folder / "answer.json").read_text())["body"])
            return
        self.failed = True
        how = f"the bake was ended by {signal.Signals(-status).name}" if status < 0 else last.removeprefix(ERROR)
        self._announce("failed", how)
        if status < 0:
            self._tell(how)

    def _tell(self, text: str) -> None:
        if not self.closing.is_set():
            self._console.print(text, markup=False)

    def _announce(self, what: str, text: str) -> None:
        with suppress(InputError):  # the terminal says it too
            atomic_file.write_json(self.news, {what: text})
