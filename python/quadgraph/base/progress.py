"""What long work tells while it runs."""

from __future__ import annotations

from collections.abc import Callable

# Takes one line of text on what was done or is being done.
ProgressCallback = Callable[[str], None]
