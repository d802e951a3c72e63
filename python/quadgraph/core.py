"""The one door to the compiled engine, quadgraph._core: `from quadgraph import core`, then `core.Engine` and so on."""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING

from quadgraph.base.errors import InputError

if TYPE_CHECKING:
    from quadgraph._core import *  # noqa: F403


def load_core() -> ModuleType:
    """Import the compiled module, or say how to get it. Raises InputError."""
    try:
        from quadgraph import _core
    except ImportError as error:
        raise InputError(
            f"the compiled engine quadgraph._core cannot be loaded ({error}); tools/setup builds it"
        ) from error
    return _core


def __getattr__(name: str) -> object:
    if name.startswith("__"):
        raise AttributeError(f"module 'quadgraph.core' has no attribute {name!r}")
    return getattr(load_core(), name)
