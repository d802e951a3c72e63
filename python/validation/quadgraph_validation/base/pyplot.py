"""Matplotlib, for whoever draws."""

from __future__ import annotations

from quadgraph.base.errors import InputError


def load_pyplot(extra: str = "truth"):
    """Import matplotlib without a window. Raises InputError, naming the optional extra that has it, if it is absent."""
    try:
        import matplotlib
    except ImportError as error:
        raise InputError(
            f"matplotlib cannot be loaded ({error}); pip install -e 'python/validation[{extra}]' installs it"
        ) from error
    matplotlib.use("Agg")
    from matplotlib import pyplot

    return pyplot
