"""What `import quadgraph` gives is what docs/public_api.toml lists, and all of it is described."""

from __future__ import annotations

import inspect
import tomllib
from pathlib import Path

import pytest

import quadgraph

ROOT = Path(__file__).resolve().parents[3]
LISTED = tomllib.loads((ROOT / "docs/public_api.toml").read_text())


def members(found: object) -> list[str]:
    """Names without an underscore that a class has from QuadGraph's own classes."""
    if not inspect.isclass(found):
        return []
    own = [each for each in found.__mro__ if each.__module__.startswith("quadgraph.")]
    names = {name for each in own for name in (*vars(each), *vars(each).get("__annotations__", ()))}
    return sorted(name for name in names if not name.startswith("_"))


def test_names_are_the_reviewed_ones():
    public = set(quadgraph.__all__) - {"__version__"}
    assert public == set(LISTED)
    assert public | {"__version__"} == set(dir(quadgraph))


@pytest.mark.parametrize("name", LISTED)
def test_members_are_the_reviewed_ones(name):
    found = getattr(quadgraph, name)
    assert members(found) == LISTED[name]["members"]
    assert found.__module__ == LISTED[name]["module"]


@pytest.mark.parametrize("name", LISTED)
def test_every_name_and_method_is_described(name):
    found = getattr(quadgraph, name)
    assert inspect.getdoc(found)
    for member in members(found):
        value = inspect.getattr_static(found, member, None)
        if isinstance(value, property | staticmethod | classmethod) or inspect.isfunction(value):
            assert inspect.getdoc(value), member
