"""Bodies that are baked once and kept: by content and options, within bounds, for several programs."""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

from quadgraph import cli
from quadgraph.baking import kept
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.base.errors import InputError
from shapes import cube, icosphere, write_obj

QUICK = {"levels": 1, "visibility_rays": 0, "relax_nodes": 0}


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    """A cache folder of the test's own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "quadgraph" / "bodies"


@pytest.fixture
def mesh(tmp_path) -> Path:
    return write_obj(icosphere(1, 5), tmp_path / "ball.obj")


def asked(mesh: Path, told: list[str] | None = None, **options) -> Path:
    with kept.body(mesh, BakeOptions(**QUICK, **options), (told if told is not None else []).append) as path:
        assert path.exists()
        return path


def test_a_mesh_is_baked_once_for_its_content_and_options(mesh, cache):
    told: list[str] = []
    first = asked(mesh, told)
    assert any("no size was given" in line for line in told)
    before, count = first.stat().st_ino, len(told)
    os.utime(first, (1, 1))
    assert asked(mesh, told) == first
    assert (first.stat().st_ino, len(told)) == (before, count)
    assert first.stat().st_mtime > 1e9  # it was used
    copy = mesh.with_name("copy.obj")
    copy.write_bytes(mesh.read_bytes())
    assert (asked(copy).parent, copy.stem) == (first.parent, "copy")
    assert asked(mesh, longest_mm=20) != first
    write_obj(cube(5), mesh)
    assert asked(mesh) != first
    assert {path.suffix for path in cache.glob("*/*")} == {".qgraph"}


def test_what_was_not_used_for_longest_goes_first(mesh, monkeypatch):
    old, newer = asked(mesh, longest_mm=10), asked(mesh, longest_mm=11)
    os.utime(old, (1, 1))
    monkeypatch.setattr(kept, "MOST_BYTES", int(2.5 * old.stat().st_size))
    newest = asked(mesh, longest_mm=12)
    assert [each.path for each in kept.bodies()] == [newest, newer]
    monkeypatch.setattr(kept, "MOST_BYTES", 1)
    last = asked(mesh, longest_mm=13)  # one that is too large by itself is kept all the same
    assert [each.path for each in kept.bodies()] == [last]


def test_a_mesh_that_cannot_be_baked_leaves_nothing(tmp_path, cache):
    open_mesh = tmp_path / "open.obj"
    open_mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(InputError):
        asked(open_mesh)
    assert not list(cache.iterdir())


def test_without_a_folder_to_keep_it_in_a_body_is_baked_for_the_moment(mesh, cache):
    cache.parent.parent.write_text("a file where the folder should be")
    told: list[str] = []
    with kept.body(mesh, BakeOptions(**QUICK), told.append) as path:
        assert path.exists()
    assert not path.exists()
    assert any("not kept" in line for line in told)


def test_pictures_of_a_gltf_count(tmp_path):
    mesh, picture = tmp_path / "a.gltf", tmp_path / "a b.png"
    mesh.write_text('{"asset": {"version": "2.0"}, "images": [{"uri": "a%20b.png"}]}')
    picture.write_bytes(b"1")
    assert kept.mesh_files(mesh) == [mesh, picture]


def test_buffers_of_a_gltf_count(tmp_path):
    document = '{"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 4}]}'
    path = tmp_path / "a.gltf"
    path.write_text(document)
    keys = set()
    for content in (b"1234", b"1235"):
        (tmp_path / "a.bin").write_bytes(content)
        keys.add(kept._key([path], BakeOptions()))
    assert len(keys) == 2


def test_programs_that_ask_at_once_bake_once(mesh, cache):
    code = (
        "import sys; from pathlib import Path; from quadgraph.baking import kept; "
        "from quadgraph.baking.pipeline import BakeOptions\n"
        f"with kept.body(Path(sys.argv[1]), BakeOptions(**{QUICK}), print) as path: print('has', path.stat().st_ino)"
    )
    programs = [
        subprocess.Popen([sys.executable, "-c", code, str(mesh)], stdout=subprocess.PIPE, text=True) for _ in range(3)
    ]
    said = [program.communicate(timeout=120)[0] for program in programs]
    assert [program.returncode for program in programs] == [0, 0, 0]
    assert sum("baked ball.obj" in text for text in said) == 1
    assert len({text.splitlines()[-1] for text in said}) == 1


def test_a_body_is_kept_where_the_folder_goes_as_it_is_waited_for(mesh, cache):
    """Another program that was stopped removes the folder of its bake, after this one has said that it waits."""
    place = kept._place(mesh, BakeOptions(**QUICK))
    with ExitStack() as other:
        other.enter_context(kept._locked(place))
        told: list[str] = []

        def tell(text: str) -> None:
            told.append(text)
            if text.startswith("another program is baking"):
                other.close()
                assert not place.exists()

        with kept.body(mesh, BakeOptions(**QUICK), tell) as path:
            assert path.parent == place
        assert told[0].startswith("another program is baking")
    assert path.exists()


def test_what_is_being_baked_is_neither_cleared_nor_trimmed(mesh, monkeypatch):
    """Another program holds the lock of a folder as long as it bakes."""
    busy, idle = asked(mesh, longest_mm=10), asked(mesh, longest_mm=11)
    with kept._locked(busy.parent):
        monkeypatch.setattr(kept, "MOST_BYTES", 1)
        newest = asked(mesh, longest_mm=12)
        assert {each.path for each in kept.bodies()} == {busy, newest}
        assert [each.path for each in kept.clear()] == [newest]
        assert busy.exists()
    assert [each.path for each in kept.clear()] == [busy]
    assert not idle.exists()


def test_the_command_lists_and_clears(mesh, cache, capsys):
    name = asked(mesh).name
    assert cli.main(["cache"]) == 0
    assert name in capsys.readouterr().out
    assert cli.main(["cache", "clear"]) == 0
    assert "1 body, " in capsys.readouterr().out
    assert not cache.exists()
    assert cli.main(["cache", "list"]) == 0
    assert "0 bodies" in capsys.readouterr().out


def test_a_body_is_found_once_it_is_kept(mesh):
    options = BakeOptions(**QUICK)
    assert kept.find(mesh, options) is None
    path = asked(mesh)
    assert kept.find(mesh, options) == path
    assert kept.find(mesh, BakeOptions(**QUICK, longest_mm=3)) is None
