"""Matplotlib, for whoever draws."""

from __future__ import annotations

from typing import Any

from quadgraph_validation.base import extra_module


def load_pyplot(extra: str = "truth") -> Any:
    """Import matplotlib without a window. Raises InputError, naming the optional extra that has it, if it is absent."""
    extra_module.load("matplotlib", extra).use("Agg")
    return extra_module.load("matplotlib.pyplot", extra)
