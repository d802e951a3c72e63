"""shader_headers SHADERS GENERATED spirv|no-spirv LEVEL...: writes what the build makes from the text of the shaders in
a folder, with or without their SPIR-V, for these levels of a processor's instructions.
"""

import sys
from pathlib import Path

from interfaces import interfaces
from native import native
from shader_text import read_shaders


def write(folder: Path, files: dict[str, str]) -> None:
    """Leaves files alone that have their text already, so that nothing is compiled again for them, and removes files
    of shaders that are gone.
    """
    for name, text in files.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    for part in ("interface", "native"):
        for path in (folder / part).rglob("*.*"):
            if path.relative_to(folder).as_posix() not in files:
                path.unlink()


def main(shaders: Path, generated: Path, spirv: bool, levels: list[str]) -> None:
    texts = read_shaders(shaders)
    write(generated, native(texts) | interfaces(texts, spirv, levels))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3] == "spirv", sys.argv[4:])
