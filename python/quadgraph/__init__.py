"""Real-time rendering of heterogeneous translucent objects, with an error that is known."""

__version__ = "0.1.0"
