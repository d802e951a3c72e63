"""A bar with the time left, for people: nothing where standard error is no terminal."""

from __future__ import annotations

from rich.console import Console
from rich.progress import Progress


def progress_bar() -> Progress:
    """A bar on standard error, to be used in a `with` block, that is gone afterwards."""
    console = Console(stderr=True)
    return Progress(console=console, transient=True, disable=not console.is_terminal)
