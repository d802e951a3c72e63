"""The one door to the compiled engine, quadgraph._core."""

from __future__ import annotations

from typing import TYPE_CHECKING

from quadgraph.base.errors import InputError

if TYPE_CHECKING:
    from quadgraph._core import Engine as Engine
    from quadgraph._core import QuadGraph as QuadGraph


def load_core():
    """Import the compiled module, or say how to get it. Raises InputError."""
    try:
        from quadgraph import _core
    except ImportError as error:
        raise InputError(
            f"the compiled engine quadgraph._core cannot be loaded ({error}); tools/setup builds it"
        ) from error
    return _core
