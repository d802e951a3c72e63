"""What is in the wheel of the product: no study, no chart, no other people's solver."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from quadgraph import cli

ROOT = Path(__file__).resolve().parents[2]
TOOL = ROOT / "tools/wheel"


def project(path: Path) -> dict:
    return tomllib.loads(path.read_text())


def imported(folder: Path) -> set[str]:
    """The top-level modules that files of a folder import, wherever in them."""
    found = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                found.add(str(node.module).partition(".")[0])
    return found


def names(requirements: list[str]) -> set[str]:
    """The modules of requirements."""
    found = {re.split(r"[;>=\[]", text)[0].strip() for text in requirements}
    return {"PIL" if name == "pillow" else name for name in found}


def test_the_wheel_is_the_package_alone():
    packages = project(ROOT / "pyproject.toml")["tool"]["scikit-build"]["wheel"]["packages"]
    assert packages == ["python/quadgraph"]
    rooms = {path.name for path in (ROOT / packages[0]).iterdir() if (path / "__init__.py").is_file()}
    assert rooms == {"api", "base", "mesh", "tets", "file", "baking", "acquisition", "browser", "commands", "work"}
    assert not {path.stem for path in (ROOT / packages[0] / "commands").glob("*.py")} & set(cli.VALIDATION)


def test_the_wheel_has_the_types_and_the_licences(tmp_path):
    """One without the compiled module, which is made in a second."""
    wanted = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*wanted, "--config-settings=wheel.cmake=false", "-w", tmp_path, ROOT], check=True)
    (wheel,) = tmp_path.glob("*.whl")
    found = set(zipfile.ZipFile(wheel).namelist())
    page = {f"quadgraph/browser/page/page.{kind}" for kind in ("css", "html", "js")}
    assert {"quadgraph/py.typed", "quadgraph/_core.pyi", "quadgraph/_core_options.pyi", *page} <= found
    (metadata,) = {name.partition("/")[0] for name in found if ".dist-info/" in name}
    assert {f"{metadata}/licenses/LICENSE", f"{metadata}/licenses/tools/cgal_mesh/LICENSE.md"} <= found


def test_the_packages_of_the_bare_system_are_those_that_the_page_names():
    (line,) = re.findall(r"^PACKAGES = \((.*)\)", TOOL.read_text(), re.MULTILINE)
    (command,) = re.findall(r"^    apt install (.*?) *#", (ROOT / "docs/compatibility.md").read_text(), re.MULTILINE)
    assert set(re.findall(r'"(.*?)"', line)) == {"python3", *command.split()}


@pytest.mark.long
@pytest.mark.skipif(not Path("/etc/debian_version").exists(), reason="the wheel is built on Debian")
def test_the_wheel_works_in_an_environment_of_its_own(tmp_path):
    """Built whole, repaired, installed, and used: minutes, a first time twenty."""
    done = subprocess.run([sys.executable, TOOL, "-o", tmp_path], check=True, capture_output=True, text=True)
    (wheel,) = tmp_path.glob("*.whl")
    assert f"{wheel}: works" in done.stdout


def test_the_product_imports_what_it_declares_and_no_more():
    package = project(ROOT / "pyproject.toml")["project"]
    needed = names(package["dependencies"])
    extras = package["optional-dependencies"]
    of_extras = (names(extras[name]) for name in ("capture", "cluster", "film", "meshio", "pyvista", "serve", "torch"))
    optional = {"openvdb", "pyopenvdb"}.union(*of_extras)
    others = imported(ROOT / "python" / "quadgraph") - set(sys.stdlib_module_names) - {"quadgraph"}
    assert others <= needed | optional
    # What trimesh traces rays with.
    assert needed - others <= {"embreex"}


def test_all_subcommands_of_the_validation_are_its_entry_points():
    validation = project(ROOT / "python" / "validation" / "pyproject.toml")["project"]
    assert set(validation["entry-points"]["quadgraph.commands"]) == set(cli.VALIDATION)


def test_help_has_the_validation_in_a_group_of_its_own():
    added = cli.added_commands()
    first, _, second = (
        cli.build_parser({}, added).format_help().partition("validation (quadgraph-validation is installed)")
    )
    assert set(added) == set(cli.VALIDATION)
    assert all(f"    {name} " in second and f"    {name} " not in first for name in cli.VALIDATION)
    assert "validation" not in cli.build_parser({}, {}).format_help()


def test_without_it_its_subcommands_say_what_to_install(monkeypatch, capsys):
    monkeypatch.setattr(cli, "added_commands", lambda only=None: {})
    assert cli.main(["chart", "--json", "a.json"]) == 1
    text = capsys.readouterr().err
    assert "pip install ./python/validation in the source tree" in text
    assert text.count("\n") == 1
