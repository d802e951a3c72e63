"""Films that pages ask for: one at a time, made by `quadgraph turntable`, or `render`, in a process of its own.

It comes after the frames of the session.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from quadgraph import core
from quadgraph.api.scene import Scene, SceneFile
from quadgraph.base import json_text
from quadgraph.base.child_process import beside
from quadgraph.base.errors import InputError
from quadgraph.base.message import ERROR
from quadgraph.browser.page_values import shown

if TYPE_CHECKING:
    from quadgraph.core import SceneFile as CoreSceneFile

TURNS = ("camera", "body", "light")
OWN = "frames"  # in place of a turn: those of the scene file
SECONDS = (5, 10, 15)
SUFFIXES = (".mp4", ".gif")
RATE = 24  # frames a second
MOST_SIDE = 1280  # pixels of a film
MOST_BYTES = 512 << 20  # of a film
_UNMET = 3  # exit status of a film that is there, of which a solve did not converge
_ALLOWED = {"turn": TURNS, "seconds": SECONDS, "suffix": SUFFIXES}


class Films:
    """The film that is being made, or that was made last. Use it in a `with` block, from one thread at a time."""

    def __init__(self, device: str = "", own: CoreSceneFile | None = None) -> None:
        """Hold no film; device: as of `Engine`; own: a scene file with frames to film, if there is one.

        `self.state` is what a page is told of it, ready for JSON.
        """
        self.folder = Path(tempfile.mkdtemp(prefix="quadgraph-films-"))
        self.state: dict[str, Any] = {"is": "none"}
        self._device, self._own = device, own
        self._film = self.folder / "film.mp4"
        self._made: Path | None = None
        self._process: subprocess.Popen[str] | None = None
        self._held = ExitStack()

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End what is being made, and forget what was."""
        self.close()

    def close(self) -> None:
        """End what is being made, and forget what was."""
        self.cancel()
        shutil.rmtree(self.folder, ignore_errors=True)

    @property
    def making(self) -> bool:
        """Whether one is being made."""
        return self._process is not None

    @property
    def made(self) -> Path | None:
        """The file of the one that was made last."""
        return self._made

    def begin(self, scene: Mapping[str, Any], wanted: Any) -> None:
        """Begin a film of a scene: {"turn": one of `turns`, "seconds": of SECONDS, "suffix": of SUFFIXES}.

        Own frames take as long as their file says. Raises InputError, also where one is being made.
        """
        if self.making:
            raise InputError("film: one is being made; cancel it, or wait for it")
        if not isinstance(wanted, dict) or wanted.keys() != _ALLOWED.keys():
            raise InputError(f"film: found {shown(wanted)}, allowed is an object of {', '.join(_ALLOWED)}")
        for name, allowed in {**_ALLOWED, "turn": self.turns}.items():
            if type(wanted[name]) is not type(allowed[0]) or wanted[name] not in allowed:
                said = ", ".join(map(str, allowed))
                raise InputError(f"film: {name}: found {shown(wanted[name])}, allowed are {said}")
        if self._made is not None:
            self._made.unlink(missing_ok=True)
            self._made = None
        frames = self._write(_filmed(scene), wanted)
        self._progress.unlink(missing_ok=True)
        log = self._held.enter_context((self.folder / "said.txt").open("w"))
        try:
            self._process = self._held.enter_context(beside(self._command(wanted), stdout=log, stderr=log))
        except OSError as error:
            self._held.close()
            raise InputError(f"film: it cannot be begun ({error.strerror})") from error
        self._film = self.folder / f"film{wanted['suffix']}"
        self.state = {"is": "making", "done": 0, "frames": frames, "seconds_left": None}

    @property
    def turns(self) -> tuple[str, ...]:
        """What a film can show."""
        return (*TURNS, OWN) if self._own else TURNS

    def _write(self, scene: dict[str, Any], wanted: Mapping[str, Any]) -> int:
        """Write the scene for the command; how many frames it makes."""
        path = self.folder / "scene.json"
        if self._own and wanted["turn"] == OWN:
            self._own.of_scene(core.scene_file(json.dumps(scene)).at(0)).save(path)
            return self._own.frames
        SceneFile(Scene.from_dict(scene)).save(path)
        return int(RATE * wanted["seconds"])

    def _command(self, wanted: Mapping[str, Any]) -> list[str]:
        seconds, scene = wanted["seconds"], str(self.folder / "scene.json")
        turn = ["turntable", scene, "--turn", wanted["turn"]]
        turn += ["--frames", str(RATE * seconds), "--seconds", str(seconds)]
        command = ["nice", sys.executable, "-P", "-m", "quadgraph.cli"]
        command += ["render", scene, "--frames"] if wanted["turn"] == OWN else turn
        command += ["--progress", str(self._progress), "-o", str(self.folder / f"film{wanted['suffix']}")]
        return command + (["--device", self._device] if self._device else [])

    @property
    def _progress(self) -> Path:
        return self.folder / "progress.json"

    def follow(self) -> bool:
        """Look how far it is. Return whether `state` has become another."""
        if self._process is None:
            return False
        before = self.state
        status = self._process.poll()
        if status is not None:
            self._end(status)
        elif sum(path.stat().st_size for path in self.folder.glob(".film*")) > MOST_BYTES:
            self._forget({"is": "failed", "why": f"the film is larger than {MOST_BYTES >> 20} MiB"})
        elif self._progress.exists():
            self.state = {"is": "making", **json_text.loads(self._progress.read_bytes())}
        return self.state != before

    def _end(self, status: int) -> None:
        if status in (0, _UNMET) and self._film.exists():
            self._made = self._film
            self._forget({"is": "ready", "suffix": self._film.suffix, "bytes": self._film.stat().st_size})
            return
        lines = [line for line in (self.folder / "said.txt").read_text(errors="replace").splitlines() if line.strip()]
        why = lines[-1].removeprefix(ERROR) if lines and status > 0 else f"its process ended with status {status}"
        self._forget({"is": "failed", "why": why.replace(f"{self.folder}/", "")})

    def cancel(self) -> None:
        """End what is being made, if anything is, and wait for that."""
        if self.making:
            self._forget({"is": "none"})

    def _forget(self, state: dict[str, Any]) -> None:
        self._held.close()
        self._process = None
        self.state = state


def _filmed(scene: Mapping[str, Any]) -> dict[str, Any]:
    """The scene with pictures of an even size, each of one solve, that is no larger than allowed."""
    picture = dict(scene["picture"])
    share = min(1.0, MOST_SIDE / max(picture["width"], picture["height"]))
    sides = {side: max(2, int(share * picture[side]) // 2 * 2) for side in ("width", "height")}
    return {**scene, "picture": picture | sides | {"converge": 0, "time_limit": 0}}
