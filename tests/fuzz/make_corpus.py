"""Writes what fuzzers start from: `make_corpus.py FOLDER` makes FOLDER/reader, FOLDER/scene and FOLDER/volume, and the
words of scenes in FOLDER/scene.dict.
"""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
MATERIAL = "sigma_s_prime=1/2/3,sigma_a=0.1"  # those of colours take a fit of a quarter of a second each
TRACKS = [
    {"path": "/lights/0/irradiance", "keys": [[0, 1], [4, 2], [9, 0]], "between": "smooth"},
    {"path": "/camera/azimuth", "keys": [[0, 0], [10, 360]]},
    {"path": "/camera/target", "keys": [[0, [0, 0, 0]], [5, [1, 2, 3]]]},
    {"path": "/material", "keys": [[0, "skin1"], [3, MATERIAL]], "between": "step"},
]
LIGHTS = [
    {"type": "ambient", "irradiance": 1},
    {"type": "directional", "direction": [0, 0, -1], "irradiance": [1, 2, 3]},
    {"type": "point", "position": [0, 0, 9], "power": 1},
]


def words(schema: Any) -> set[str]:
    """Names and fixed values of a JSON schema."""
    if isinstance(schema, list):
        return set().union(*map(words, schema))
    if not isinstance(schema, dict):
        return set()
    found = {*schema.get("properties", {})} | set().union(*map(words, schema.values()))
    return found | {value for value in (*schema.get("enum", []), schema.get("const")) if isinstance(value, str)}


def main(folder: Path) -> None:
    """Make the three folders and the words, or add what they lack."""
    for name in ("reader", "scene", "volume"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for path in (ROOT / "tests/data").glob("*.qgraph"):
        shutil.copy(path, folder / "reader")
    for path in (ROOT / "docs/scenes").glob("*.json"):
        scene = json.loads(path.read_text())
        (folder / "scene" / path.name).write_text(json.dumps(scene | {"material": MATERIAL}))
    found = words(json.loads((ROOT / "docs/scene.schema.json").read_text()))
    (folder / "scene.dict").write_text("".join(f'"\\"{word}\\""\n' for word in sorted(found)))
    tracked = {"quadgraph_scene": 1, "body": "a.qgraph", "lights": LIGHTS, "tracks": TRACKS, "frames": 20}
    (folder / "scene/tracked.json").write_text(json.dumps(tracked))
    for kind in ("<f4", "<f8", "|u1", "<i8"):
        grid = np.arange(24).reshape(2, 3, 4).astype(kind)
        colours = np.ones((2, 3, 4, 3), kind)
        known = {"sigma_s_prime_deviation": grid, "sigma_a_deviation": colours}
        np.savez(folder / f"volume/{kind[1:]}.npz", sigma_s_prime=grid, sigma_a=colours, spacing=1.0, eta=1.4, **known)
    np.savez_compressed(
        folder / "volume/packed.npz", sigma_s_prime=grid, sigma_a=grid, spacing=[1, 2, 3], origin=[0, 0, 1]
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
