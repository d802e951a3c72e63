"""No function is above sixty lines and no file above four hundred."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDERS = ("docs", "engine", "python", "shaders", "tests", "tools")
CPP = {".cpp", ".h", ".glsl", ".comp", ".vert", ".frag"}
FUNCTION_LINES = 60
FILE_LINES = 400


def sources() -> Iterator[Path]:
    """All files of Python, C++ and GLSL, and the programs without a suffix among the tools."""
    for folder in FOLDERS:
        for file in sorted((ROOT / folder).rglob("*")):
            if file.suffix in CPP | {".py", ".pyi"} or (
                file.parent == ROOT / "tools" and not file.suffix and file.is_file()
            ):
                yield file


def python_functions(text: str) -> Iterator[tuple[str, int]]:
    """First line and number of lines of each function, nested ones too; decorators are no part of it."""
    lines = text.splitlines()
    left: list[ast.AST] = [ast.parse(text)]
    for node in left:  # statements alone, which are a fifth of all nodes
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield lines[node.lineno - 1].strip(), node.end_lineno - node.lineno + 1
        for name in ("body", "orelse", "finalbody", "handlers", "cases"):
            left += getattr(node, name, [])


def cpp_functions(text: str) -> Iterator[tuple[str, int]]:
    """First line and number of lines of each function of C++ and GLSL, in a namespace or a class.

    As clang-format lays it out, it goes from a line to the next brace with no more indent; raw strings do not count.
    """
    text = re.sub(r'R"(\w*)\(.*?\)\1"', lambda raw: "\n" * raw[0].count("\n"), text, flags=re.DOTALL)
    lines = text.splitlines()
    for end, line in enumerate(lines):
        if closed := re.fullmatch(r"( {0,2})\}", line):
            indent = len(closed[1])
            start = next(i for i in range(end - 1, -1, -1) if re.match(rf" {{0,{indent}}}[^\s#/]", lines[i]))
            if "(" in lines[start] and not re.match(r" *(\}|(if|for|while|switch)\b)", lines[start]):
                yield lines[start].strip(), end - start + 1


def functions(file: Path) -> Iterator[tuple[str, int]]:
    """First line and length of the functions of one file."""
    text = file.read_text()
    if file.suffix in CPP:
        return cpp_functions(text)
    return python_functions(text) if file.suffix or "python" in text.split("\n", 1)[0] else iter(())


def test_no_file_is_above_400_lines():
    lengths = {file.relative_to(ROOT).as_posix(): file.read_text().count("\n") for file in sources()}
    assert len(lengths) > 800
    assert not {name: length for name, length in lengths.items() if length > FILE_LINES}


def test_no_function_is_above_60_lines():
    found = [(file.relative_to(ROOT).as_posix(), *function) for file in sources() for function in functions(file)]
    assert len(found) > 5000
    assert not {(name, first): lines for name, first, lines in found if lines > FUNCTION_LINES}


def test_lengths_are_counted_from_the_first_to_the_last_line():
    assert list(python_functions("@a\ndef f(\n    b,\n):\n    def g():\n        pass\n")) == [
        ("def f(", 5),
        ("def g():", 2),
    ]
    cpp = "void f(int a,\n       int b) {\n  if (a) {\n#ifdef X\n    b();\n#endif\n  }\n}\n\n"
    cpp += "struct S {\n  int m() {\n    return 1;\n  }\n};\n"
    assert list(cpp_functions(cpp)) == [("void f(int a,", 8), ("int m() {", 3)]
