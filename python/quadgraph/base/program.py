"""How a program of ours runs and ends: signals, and errors as one line and an exit status."""

from __future__ import annotations

import io
import math
import os
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from importlib.abc import MetaPathFinder
from pathlib import Path
from types import FrameType
from typing import NoReturn

from quadgraph.base.errors import QuadGraphError
from quadgraph.base.message import ERROR, shortened

INTERRUPTED = 128 + signal.SIGINT


class Stopped(KeyboardInterrupt):
    """TERM or HUP, which clean up as Ctrl-C does."""


_AGAIN = 0.02  # s, after which a signal is sent again that came in an import
_IMPORTLIB = "<frozen importlib"
_OURS = str(Path(__file__).parents[1]) + os.sep
_SETTLING = 1.0  # s after a signal in which another one would meet the cleaning up


def heed_signals() -> None:
    """Let TERM and HUP end the program as Ctrl-C does, where they are not ignored or somebody else's.

    All three wait while a module of others is imported: those make errors of their own of an interrupt, or forget it.
    Another one within a second says nothing new.
    """
    if threading.current_thread() is not threading.main_thread():
        return

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _SIGNALS.stop)


class _Signals(MetaPathFinder):
    """Raises a signal as an exception where that can be: at once, or where a module of ours is about to import another.

    A command imports for half a second, and a timer hardly ever meets the moments between two imports.
    """

    def __init__(self) -> None:
        self.first: int | None = None  # that was heeded in this run
        self._raised = -math.inf

    def stop(self, number: int, frame: FrameType | None) -> None:
        """Heed a signal, later where something is being imported."""
        if time.monotonic() < self._raised + _SETTLING:
            return
        self.first = self.first or number
        if _importing(frame):
            signal.signal(signal.SIGALRM, self._again)
            signal.setitimer(signal.ITIMER_REAL, _AGAIN)
            if self not in sys.meta_path:
                sys.meta_path.insert(0, self)
        else:
            self._raise(number)

    def find_spec(self, *_: object) -> None:
        """Find nothing: this is called before a module is looked for."""
        ours = all(file.startswith(_OURS) for file in _importing(sys._getframe(1)))
        if ours and self.first and threading.current_thread() is threading.main_thread():
            self._raise(self.first)

    def forget(self) -> None:
        """Wait no longer for an import."""
        if self.first:  # else the timer may be somebody else's
            signal.setitimer(signal.ITIMER_REAL, 0)
        if self in sys.meta_path:
            sys.meta_path.remove(self)

    def _again(self, _number: int, frame: FrameType | None) -> None:
        if self.first:
            self.stop(self.first, frame)

    def _raise(self, number: int) -> NoReturn:
        self._raised = time.monotonic()
        self.forget()
        raise KeyboardInterrupt if number == signal.SIGINT else Stopped(number)


_SIGNALS = _Signals()


def _importing(frame: FrameType | None) -> list[str]:
    """Files of the modules that are being imported, and of who imports the outermost; none where nothing is."""
    files, last = [], 0
    while frame is not None:
        files.append(frame.f_code.co_filename)
        if files[-1].startswith(_IMPORTLIB):
            last = len(files) + 1
        frame = frame.f_back
    return [file for file in files[:last] if not file.startswith(_IMPORTLIB)]


def ended(run: Callable[[], int]) -> int:
    """Run a program's work and return its exit status: what the work gives, 1 for an error, 130 for Ctrl-C.

    Errors of ours and of the system are said in one line on standard error; all others are raised.
    """
    _SIGNALS.first = None
    heed_signals()
    _print_any_character()
    try:
        return run()
    except KeyboardInterrupt:
        return _interrupted()
    except Exception as error:
        return _failed(error)
    finally:
        _SIGNALS.forget()  # one that still waits would come when Python has no handler any more


def _print_any_character() -> None:
    """Let characters that the encoding of standard output lacks be printed as escapes, and be no error."""
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="backslashreplace")


def _interrupted() -> int:
    print("quadgraph: interrupted", file=sys.stderr)
    return 128 + _SIGNALS.first if _SIGNALS.first else INTERRUPTED


def _failed(error: Exception) -> int:
    """Say what went wrong where it is ours or the system's to say, and return the exit status; raise all else."""
    if not isinstance(error, QuadGraphError | OSError):
        raise error
    if isinstance(error, OSError):
        _drop_output()
    if isinstance(error, BrokenPipeError):  # the reader of our output is gone
        return 1
    text = str(error)
    if isinstance(error, OSError):
        # Files that are read and written have errors of their own: this is standard output, or a temporary file.
        folder = tempfile.tempdir or os.environ.get("TMPDIR") or "/tmp"
        where = error.filename or f"standard output, or a temporary file in {folder}"
        text = shortened(f"{where}: {error.strerror or error}")
    print(f"{ERROR}{text}", file=sys.stderr)
    return 1


def _drop_output() -> None:
    """Let what is left of standard output not meet its reader, or a full disk, again when Python ends."""
    if sys.stdout is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
