"""Materials of Wavefront OBJ files (.mtl): Kd, Ni, and the texture map_Kd."""

from __future__ import annotations

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.looks import texture
from quadgraph.mesh.looks.gltf_media import numbers_of
from quadgraph.mesh.looks.parts import Look

MOST_BYTES = 1 << 24


class ObjLook:
    """A material as it is read; scale, offset: of the texture's coordinates, (2,)."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.colour = (1.0, 1.0, 1.0)
        self.eta: float | None = None
        self.texture: texture.Texture | None = None
        self.scale, self.offset = np.ones(2), np.zeros(2)

    @property
    def look(self) -> Look:
        """What was read."""
        return Look(self.name, self.colour, self.texture, None, self.eta)


def read_mtl(pictures: texture.Pictures, name: str) -> dict[str, ObjLook]:
    """The materials of a library that an OBJ file, `pictures.mesh`, names. Raises InputError naming file and line."""
    obj = pictures.mesh
    path = obj.parent / name
    data = pictures.read(name, f"{obj}, mtllib")
    if len(data) > MOST_BYTES:
        raise InputError(f"{path}: {len(data)} bytes found, at most {MOST_BYTES} are allowed")
    found: dict[str, ObjLook] = {}
    present: ObjLook | None = None
    for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), 1):
        key, _, rest = line.partition("#")[0].strip().replace("\t", " ").partition(" ")
        where, rest = f"{path}, line {number}", rest.strip()
        if key == "newmtl":
            present = found.setdefault(rest, ObjLook(rest or "unnamed"))
        elif present is not None:
            _read_line(pictures, present, key.lower(), rest, where)
    return found


def _read_line(pictures: texture.Pictures, present: ObjLook, key: str, rest: str, where: str) -> None:
    if key == "kd":
        values = _floats(rest.split(), where)
        values = values * 3 if len(values) == 1 else values
        red, green, blue = numbers_of(where, {"Kd": values}, "Kd", (1.0, 1.0, 1.0), 0, 1)
        present.colour = (red, green, blue)
    elif key == "ni":
        (value,) = numbers_of(where, {"Ni": _floats(rest.split(), where)}, "Ni", (1.5,), 0, 1e6)
        present.eta = value if 1 < value <= 3 else None  # 1 is what programs write that have no index
    elif key == "map_kd":
        _read_map(pictures, present, rest.split(), where)


def _floats(words: list[str], where: str) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        raise InputError(f"{where}: cannot read {' '.join(words)[:80]!r}, numbers are wanted") from None


def _read_map(pictures: texture.Pictures, present: ObjLook, words: list[str], where: str) -> None:
    """A texture with its options, each with the words that go with it; the name is the rest, blanks included."""
    clamp = False
    while words and words[0].startswith("-"):
        option = words.pop(0).lower()
        if option in ("-o", "-s", "-t"):
            count = next((k for k, word in enumerate(words[:3]) if not _is_number(word)), 3)
            values = np.array(_floats(words[: min(count, 2)], where))
            words = words[count:]
            if option == "-s":
                present.scale[: len(values)] = values
            elif option == "-o":
                present.offset[: len(values)] = values
            continue
        clamp = clamp or (option == "-clamp" and words[:1] == ["on"])
        words = words[2 if option == "-mm" else 1 :]
    name = " ".join(words)
    if not name:
        raise InputError(f"{where}: map_Kd without a picture found")
    pixels = pictures.beside(name, where)
    present.texture = texture.Texture(pixels, ("clamp", "clamp") if clamp else ("repeat", "repeat"))


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
