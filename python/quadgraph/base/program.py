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
from types import FrameType

from quadgraph.base.errors import QuadGraphError
from quadgraph.base.message import ERROR, shortened

INTERRUPTED = 128 + signal.SIGINT


class Stopped(KeyboardInterrupt):
    """TERM or HUP, which clean up as Ctrl-C does."""


_SENT: list[int] = []  # signals that were heeded in this run
_AGAIN = 0.02  # s, after which a signal is sent again that came in an import
_SETTLING = 1.0  # s after a signal in which another one would meet the cleaning up


def heed_signals() -> None:
    """Let TERM and HUP end the program as Ctrl-C does, where they are not ignored or somebody else's.

    All three wait until what is being imported is: modules make errors of their own of an interrupt, or forget it.
    Another one within a second says nothing new.
    """
    if threading.current_thread() is not threading.main_thread():
        return

    heeded = -math.inf

    def again(_number: int, _frame: FrameType | None) -> None:
        signal.raise_signal(_SENT[0])

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal heeded
        if time.monotonic() < heeded + _SETTLING:
            return
        _SENT.append(number)
        if _in_import(frame):
            signal.signal(signal.SIGALRM, again)
            signal.setitimer(signal.ITIMER_REAL, _AGAIN)
        else:
            heeded = time.monotonic()
            signal.setitimer(signal.ITIMER_REAL, 0)
            raise KeyboardInterrupt if number == signal.SIGINT else Stopped(number)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, stop)


def _in_import(frame: FrameType | None) -> bool:
    while frame is not None and frame.f_code.co_filename != "<frozen importlib._bootstrap>":
        frame = frame.f_back
    return frame is not None


def ended(run: Callable[[], int]) -> int:
    """Run a program's work and return its exit status: what the work gives, 1 for an error, 130 for Ctrl-C.

    Errors of ours and of the system are said in one line on standard error; all others are raised.
    """
    _SENT.clear()
    heed_signals()
    _print_any_character()
    try:
        return run()
    except KeyboardInterrupt:
        return _interrupted()
    except Exception as error:
        return _failed(error)
    finally:
        if _SENT:  # one that still waits for an import would come when Python has no handler any more
            signal.setitimer(signal.ITIMER_REAL, 0)


def _print_any_character() -> None:
    """Let characters that the encoding of standard output lacks be printed as escapes, and be no error."""
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="backslashreplace")


def _interrupted() -> int:
    print("quadgraph: interrupted", file=sys.stderr)
    return 128 + _SENT[0] if _SENT else INTERRUPTED


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
