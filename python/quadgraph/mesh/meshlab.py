"""pymeshlab, imported where it is needed: that takes a third of a second, and libraries of the system."""

from __future__ import annotations

from types import ModuleType

from quadgraph.base.errors import ToolError


def load() -> ModuleType:
    """Import pymeshlab. Raises ToolError that names what it needs of the system."""
    try:
        import pymeshlab
    except ImportError as error:
        raise ToolError(
            f"pymeshlab cannot be imported ({error}); its libraries are in Debian's packages libgl1, libopengl0 and "
            "libxkbcommon0: apt install libgl1 libopengl0 libxkbcommon0"
        ) from error
    return pymeshlab
