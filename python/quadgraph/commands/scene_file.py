"""Scene files as commands open them: those of meshes too, whose bodies are baked first."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from quadgraph.base import json_text, regular_file
from quadgraph.base.errors import InputError, ToolError
from quadgraph.core import load_core

if TYPE_CHECKING:
    from quadgraph.baking.bodies import BodyMesh
    from quadgraph.baking.scene_bodies import SceneBodies
    from quadgraph.core import SceneFile


def is_scene(path: Path) -> bool:
    """Whether a file is taken for a scene, by its name."""
    return path.suffix.lower() == ".json"


@contextlib.contextmanager
def opened(path: Path) -> Iterator[tuple[SceneFile, dict[str, Any]]]:
    """Give a scene file and the JSON value that it is of, whose body is there as long as the block runs.

    Bodies that are meshes are baked into one, unless that is kept. Progress is told on standard error. Raises
    InputError, FormatError and ToolError.
    """
    from quadgraph.baking import scene_bodies

    document = content(path)
    if document is None or not scene_bodies.has_bodies(document):
        file = load_core().SceneFile(path)
        yield file, json_text.loads(regular_file.read_bytes(path)) if document is None else document
        return
    with contextlib.ExitStack() as stack:
        found = _bodies(path, document)
        plain = stack.enter_context(_baked(path, found))
        try:
            file = load_core().scene_file(json.dumps(plain), path)
        except InputError as error:
            raise InputError(found.as_said(str(error))) from None
        yield file, plain


def content(path: Path) -> Any:
    """The JSON value of a file; None where it cannot be read, which the engine says better."""
    try:
        return json_text.loads(regular_file.read_bytes(path))
    except (OSError, InputError):
        return None


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Let errors of a bake begin with the name of the scene."""
    try:
        yield
    except (InputError, ToolError) as error:
        raise type(error)(f"{path}: {error}") from error


def meshes_of(path: Path) -> list[BodyMesh]:
    """The bodies of a scene of meshes, as `opened` bakes them. Raises InputError, also for a scene of a baked body."""
    document = json_text.loads(regular_file.read_bytes(path)) if path.is_file() else content(path)
    if not (isinstance(document, dict) and "bodies" in document):
        raise InputError(f"{path}: a scene with /bodies, a list of meshes, is wanted (docs/bodies.md)")
    return _bodies(path, document).meshes


def _bodies(path: Path, document: dict[str, Any]) -> SceneBodies:
    from quadgraph.baking import scene_bodies

    try:
        return scene_bodies.read(document, path.parent)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


@contextlib.contextmanager
def _baked(path: Path, found: SceneBodies) -> Iterator[dict[str, Any]]:
    from quadgraph.baking import kept

    errors = Console(stderr=True, highlight=False, soft_wrap=True)

    def tell(text: str) -> None:
        errors.print(text, markup=False)

    with contextlib.ExitStack() as stack:
        with naming(path), errors.status(f"baking {path.name}, once for these meshes, sizes and places"):
            body = stack.enter_context(kept.bodies_of(path, found.meshes, tell))
        yield found.with_body(body)
