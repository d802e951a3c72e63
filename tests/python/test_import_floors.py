"""The rooms of both Python packages: arrows between them go down, and no name is given twice."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

PYTHON = Path(__file__).resolve().parents[2] / "python"
# Every room may import itself and those before it.
FLOORS = {
    "quadgraph": (
        "base",
        "work",
        "core",
        "api",
        "mesh",
        "tets",
        "file",
        "baking",
        "acquisition",
        "browser",
        "commands",
        "cli",
    ),
    "quadgraph_validation": (
        "base",
        "bodies",
        "truth",
        "accuracy",
        "benchmark",
        "stability",
        "chart",
        "tables",
        "commands",
    ),
}
PUBLIC_ROOMS = ("api", "baking", "base")  # what `import quadgraph` gives comes from these
FOLDERS = {"quadgraph": PYTHON / "quadgraph", "quadgraph_validation": PYTHON / "validation" / "quadgraph_validation"}


def modules() -> dict[str, Path]:
    """The files of both packages by their dotted names."""
    found = {}
    for package, folder in FOLDERS.items():
        for path in sorted(folder.rglob("*.py")):
            name = ".".join((package, *path.relative_to(folder).with_suffix("").parts))
            found[name.removesuffix(".__init__")] = path
    return found


MODULES = modules()


def imports(path: Path, known: dict[str, Path]) -> Iterator[str]:
    """The modules of `known` that a file imports, wherever in it; `quadgraph._core` too."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: relative import"
            full = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [name if name in known or name == "quadgraph._core" else str(node.module) for name in full]
        else:
            continue
        yield from (name for name in names if name in known or name == "quadgraph._core")


def room(module: str) -> tuple[str, str]:
    """Package and room of a module; the room of the package itself is empty."""
    package, _, rest = module.partition(".")
    return package, rest.partition(".")[0]


def arrow_is_allowed(source: str, target: str) -> bool:
    """Whether one module may import another."""
    (package, here), (other, there) = room(source), room(target)
    if target == "quadgraph._core":
        return source == "quadgraph.core"
    if package != other:
        return package == "quadgraph_validation" and there not in ("commands", "cli", "")
    if there == "commands":
        return here == "cli" or here == "commands"
    if not here:
        return there in PUBLIC_ROOMS
    floors = FLOORS[package]
    return bool(there) and floors.index(there) <= floors.index(here)


@pytest.mark.parametrize("module", MODULES)
def test_no_arrow_goes_up(module):
    wrong = [target for target in imports(MODULES[module], MODULES) if not arrow_is_allowed(module, target)]
    assert not wrong


def test_arrows_that_go_up_are_seen(tmp_path):
    """The rule itself: each of these is refused, and their opposites are not."""
    up = [
        ("quadgraph.base.errors", "quadgraph.mesh.surface"),
        ("quadgraph.tets.graph", "quadgraph.file.qgraph_file"),
        ("quadgraph.baking.pipeline", "quadgraph.commands.bake"),
        ("quadgraph_validation.commands.chart", "quadgraph.commands.bake"),
        ("quadgraph.baking.pipeline", "quadgraph_validation.bodies.media"),
        ("quadgraph_validation.truth.fresnel", "quadgraph_validation.chart.pixels"),
        ("quadgraph.baking.pipeline", "quadgraph._core"),
        ("quadgraph", "quadgraph.core"),
        ("quadgraph", "quadgraph.tets.graph"),
    ]
    assert not [pair for pair in up if arrow_is_allowed(*pair)]
    assert arrow_is_allowed("quadgraph.file.qgraph_file", "quadgraph.tets.graph")
    assert arrow_is_allowed("quadgraph_validation.chart.pixels", "quadgraph.mesh.surface")
    file = tmp_path / "late.py"
    file.write_text("def f():\n    from quadgraph.commands import bake\n    import quadgraph.cli\n")
    assert list(imports(file, MODULES)) == ["quadgraph.commands.bake", "quadgraph.cli"]


def test_every_room_has_its_floor():
    for package, floors in FLOORS.items():
        found = {room(module)[1] for module in MODULES if room(module)[0] == package} - {""}
        assert found == set(floors)


def test_packages_import_one_another_in_no_circle():
    """Folders within rooms too, such as tets/polygrid, which the floors do not tell apart."""
    packages = {module for module, path in MODULES.items() if path.name == "__init__.py"}

    def package_of(module: str) -> str:
        return module if module in packages else module.rpartition(".")[0]

    arrows = defaultdict(set)
    for module, path in MODULES.items():
        for target in imports(path, MODULES):
            if target in MODULES and package_of(target) != package_of(module):
                arrows[package_of(module)].add(package_of(target))
    # Not counted: the packages' own __init__ and top modules, which the floors order.
    arrows = {source: {t for t in to if t not in FLOORS} for source, to in arrows.items() if source not in FLOORS}
    while free := [source for source, to in arrows.items() if not to & arrows.keys()]:
        for source in free:
            del arrows[source]
    assert not arrows


def test_no_two_modules_have_the_same_file_name():
    places = defaultdict(list)
    for module, path in MODULES.items():
        if path.name != "__init__.py":
            places[path.name].append(module)
    assert not {name: found for name, found in places.items() if len(found) > 1}


def test_no_two_classes_have_the_same_name():
    places = defaultdict(list)
    for module, path in MODULES.items():
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                places[node.name].append(module)
    assert not {name: found for name, found in places.items() if len(found) > 1}
