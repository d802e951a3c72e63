"""python/quadgraph/_core.pyi and _core_options.pyi say of the compiled module what that says of itself."""

from __future__ import annotations

import ast
import inspect
import re
from pathlib import Path

import pytest

from quadgraph.core import load_core

core = load_core()
PACKAGE = Path(__file__).resolve().parents[3] / "python/quadgraph"
STUB, OPTIONS = (ast.parse((PACKAGE / name).read_text()) for name in ("_core.pyi", "_core_options.pyi"))
Signature = list[tuple[str, bool]]  # the name of each argument, and whether it may be left out


def arguments(function: ast.FunctionDef) -> Signature:
    """What a definition takes, without self."""
    given = function.args
    named = [*given.posonlyargs, *given.args]
    optional = [False] * (len(named) - len(given.defaults)) + [True] * len(given.defaults)
    found = [(each.arg, may) for each, may in zip(named, optional, strict=True) if each.arg != "self"]
    found += [(each.arg, usual is not None) for each, usual in zip(given.kwonlyargs, given.kw_defaults, strict=True)]
    return found + ([("**", True)] if given.kwarg else [])


def stubbed(body: list[ast.stmt]) -> dict[str, list[Signature]]:
    """Functions of a body of the stub, with all their forms; properties apart."""
    found: dict[str, list[Signature]] = {}
    for each in body:
        if isinstance(each, ast.FunctionDef) and not any(ast.unparse(d) == "property" for d in each.decorator_list):
            found.setdefault(each.name, []).append(arguments(each))
    return found


def compiled(holder: object) -> dict[str, list[Signature]]:
    """Functions of the compiled module or a class of it, by the first lines of their descriptions."""
    found = {}
    for name, value in vars(holder).items():
        public = not name.startswith("_") or name == "__init__"
        if public and (inspect.isroutine(value) or type(value).__name__ == "instancemethod"):
            lines = re.findall(rf"^(?:\d+\. )?({name}\(.*\) -> .*)$", value.__doc__ or "", re.MULTILINE)
            # Types and defaults are pybind11's texts, of which some are no Python.
            plain = [re.sub(r"<[^<>]*>", "...", line) for line in lines]
            found[name] = [arguments(ast.parse(f"def {line}: ...").body[0]) for line in plain]
    return found


def classes() -> dict[str, ast.ClassDef]:
    return {each.name: each for each in [*STUB.body, *OPTIONS.body] if isinstance(each, ast.ClassDef)}


def test_names_are_the_compiled_ones():
    constants = {each.target.id for each in STUB.body if isinstance(each, ast.AnnAssign)}
    functions = stubbed(STUB.body)
    assert {name for name in dir(core) if not name.startswith("_")} == constants | set(functions) | set(classes())


def test_functions_take_what_the_compiled_ones_take():
    assert stubbed(STUB.body) == compiled(core)


@pytest.mark.parametrize("name", classes())
def test_methods_take_what_the_compiled_ones_take(name):
    wanted = {k: v for k, v in stubbed(classes()[name].body).items() if not k.startswith("__") or k == "__init__"}
    found = {k: v for k, v in compiled(getattr(core, name)).items() if v}
    assert wanted == found


@pytest.mark.parametrize("name", classes())
def test_properties_are_the_compiled_ones(name):
    written = {
        each.name
        for each in classes()[name].body
        if isinstance(each, ast.FunctionDef) and any(ast.unparse(d) == "property" for d in each.decorator_list)
    }
    assert written == {k for k, v in vars(getattr(core, name)).items() if isinstance(v, property)}
