"""Bodies that commands bake by themselves, kept in the user's cache folder from one run to the next."""

from __future__ import annotations

import errno
import fcntl
import hashlib
import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from urllib.parse import unquote

from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.baking.report import BakeReport
from quadgraph.base import regular_file
from quadgraph.base.cache_folder import cache_folder
from quadgraph.base.progress import ProgressCallback
from quadgraph.base.version import __version__
from quadgraph.mesh import gltf_file

MOST_BYTES = 4_000_000_000  # of all bodies; the longest unused go first
_TRIES = 100  # to lock a folder that others remove
_ROOMS = ("base", "mesh", "tets", "file", "baking")  # what a bake is made by


@dataclass(frozen=True)
class KeptBody:
    """A body in the cache folder: its file, bytes, and when it was used last, s since 1970."""

    path: Path
    size: int
    used: float


def folder() -> Path:
    """Where bodies are kept."""
    return cache_folder() / "bodies"


@contextmanager
def body(mesh: Path, options: BakeOptions, tell: ProgressCallback) -> Iterator[Path]:
    """Give the .qgraph of a mesh, baked unless one of the same content and options is kept.

    It stays in the cache folder, or where that cannot be written is there as long as the block runs. Several processes
    may ask at once: one bakes, the others wait for it. Raises what `pipeline.bake` raises.
    """
    with _made(_place(mesh, options), mesh, lambda path: bake(mesh, path, options, tell), tell) as path:
        yield path


@contextmanager
def bodies_of(scene: Path, placed: Sequence[BodyMesh], tell: ProgressCallback) -> Iterator[Path]:
    """Do the same with the bodies of a scene file, which are baked into one file."""
    options = BakeOptions()
    place = folder() / _key([each.mesh for each in placed], [replace(each, mesh=Path()) for each in placed])[:24]
    with _made(place, scene, lambda path: bake_bodies(placed, path, options, tell), tell) as path:
        yield path


@contextmanager
def _made(place: Path, source: Path, make: Callable[[Path], BakeReport], tell: ProgressCallback) -> Iterator[Path]:
    """Give what is kept in a folder, or is made and kept there."""
    try:
        with _turn(place, source.name, tell):
            path = _kept(source, place / f"{source.stem}.qgraph", make, tell)
    except OSError as error:
        tell(f"{error.filename or folder()}: {error.strerror}; the bake of {source.name} is not kept")
        with tempfile.TemporaryDirectory(prefix="quadgraph-") as temporary:
            path = Path(temporary) / f"{source.stem}.qgraph"
            make(path)
            yield path
        return
    yield path


def find(mesh: Path, options: BakeOptions) -> Path | None:
    """The .qgraph of a mesh if one of the same content and options is kept."""
    path = _place(mesh, options) / f"{mesh.stem}.qgraph"
    with suppress(OSError):
        os.utime(path)
        return path
    return None


def bodies() -> list[KeptBody]:
    """What is kept, the last used first."""
    found = []
    for path in folder().glob("*/*.qgraph"):
        with suppress(FileNotFoundError):
            state = path.stat()
            found.append(KeptBody(path, state.st_size, state.st_mtime))
    return sorted(found, key=lambda each: -each.used)


def clear() -> list[KeptBody]:
    """Remove all bodies but those that are being baked, and tell which. What a program has opened it keeps."""
    gone = [each for each in bodies() if _removed(each)]
    _remove_empty(folder())
    return gone


def _place(mesh: Path, options: BakeOptions) -> Path:
    return folder() / _key([mesh], options)[:24]


def _kept(source: Path, path: Path, make: Callable[[Path], BakeReport], tell: ProgressCallback) -> Path:
    if path.exists():
        os.utime(path)
        return path
    report = make(path)
    for note in report.notes:
        tell(note)
    tell(f"baked {source.name} in {report.seconds['total']:.0f} s, kept for the next time (quadgraph cache)")
    _trim(path)
    return path


def _trim(newest: Path) -> None:
    """Remove what was not used for longest until the rest is within bounds."""
    room = MOST_BYTES
    for each in bodies():
        room -= each.size
        if room < 0 and each.path != newest:
            _removed(each)


def _removed(each: KeptBody) -> bool:
    """Remove a body and say so, unless its folder is at work."""
    with suppress(OSError), _locked(each.path.parent, fcntl.LOCK_NB):
        each.path.unlink()
        return True
    return False


def _remove_empty(place: Path) -> None:
    with suppress(OSError):
        place.rmdir()


@contextmanager
def _turn(place: Path, name: str, tell: ProgressCallback) -> Iterator[None]:
    """Hold the lock of a folder as long as the block runs, and say so where it has to be waited for."""
    with ExitStack() as stack:
        try:
            stack.enter_context(_locked(place, fcntl.LOCK_NB))
        except BlockingIOError:
            tell(f"another program is baking {name}; waiting for it")
            stack.enter_context(_locked(place))
        yield


@contextmanager
def _locked(place: Path, how: int = 0) -> Iterator[None]:
    """Hold the lock of a folder, which is made, and removed if it is empty then. The lock ends with the process."""
    handle = _lock(place, how)
    try:
        yield
    finally:
        _remove_empty(place)
        os.close(handle)


def _lock(place: Path, how: int) -> int:
    """Open a folder and lock it: the one of that name, as who has the lock may remove it while others wait for it."""
    for _ in range(_TRIES):
        with suppress(FileNotFoundError), ExitStack() as opened:
            place.mkdir(parents=True, exist_ok=True)
            handle = os.open(place, os.O_RDONLY | os.O_DIRECTORY)
            opened.callback(os.close, handle)
            fcntl.flock(handle, fcntl.LOCK_EX | how)
            if os.path.samestat(os.fstat(handle), place.stat()):
                opened.pop_all()
                return handle
    raise OSError(errno.EBUSY, "cannot be made, or is removed again and again", str(place))


def _key(meshes: Sequence[Path], options: object) -> str:
    """Of what a bake is made of: the meshes' files, options, and the code that bakes."""
    kinds = " ".join(mesh.suffix.lower() for mesh in meshes)
    digest = hashlib.sha256(f"{__version__} {_code()} {kinds} {options!r}".encode())
    for path in (file for mesh in meshes for file in mesh_files(mesh)):
        with suppress(OSError):  # the reader says what is wrong with it
            digest.update(hashlib.sha256(regular_file.read_bytes(path)).digest())
    return digest.hexdigest()


def mesh_files(mesh: Path) -> list[Path]:
    """A mesh's own file, and those that a .gltf names."""
    if mesh.suffix.lower() != ".gltf":
        return [mesh]
    document = gltf_file.read(mesh, lambda file: file.document)
    names = [str(each["uri"]) for each in document.get("buffers", []) if "uri" in each]
    names += [unquote(str(each["uri"])) for each in document.get("images", []) if "uri" in each]
    return [mesh, *(mesh.parent / name for name in names if not name.startswith("data:"))]


@cache
def _code() -> str:
    digest = hashlib.sha256()
    package = Path(__file__).resolve().parents[1]
    for room in _ROOMS:
        for path in sorted((package / room).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()
