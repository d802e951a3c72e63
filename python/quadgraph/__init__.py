"""Real-time rendering of heterogeneous translucent objects, with an error that is known."""

from quadgraph.base.version import __version__

__all__ = ["__version__"]
