"""Packages that only some calls need, of an extra that is installed beside this one."""

from __future__ import annotations

import importlib
from types import ModuleType

from quadgraph.base.errors import InputError


def optional_package(name: str, extra: str) -> ModuleType:
    """Import a package of an extra. Raises InputError that says how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise InputError(f"{name} cannot be imported ({error}): pip install 'quadgraph[{extra}]'") from error
