"""A body shown for long while light, material, edits and shape change at random: finite, without leak or message."""

from __future__ import annotations

import json
import random
import re
from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

MATERIALS = ("marble", "skin1", "ketchup", "wholemilk", "spectralon", "jade", "wood", "marble-veins", "chicken1,eta=1")
HOST_SLACK = 24 << 20  # bytes: what allocators keep


def resident() -> int:
    """Host memory of this process, bytes."""
    return 1024 * int(re.search(r"VmRSS:\s+(\d+)", Path("/proc/self/status").read_text())[1])


class Changes:
    """Random values of a scene of a sphere of radius 10 mm."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def near(self, size: float) -> list[float]:
        """A point in a box."""
        return [self.random.uniform(-size, size) for _ in range(3)]

    def lights(self) -> list[dict]:
        """Up to three, sometimes inside the body, sometimes dark."""
        kinds = (
            {"type": "directional", "direction": [*self.near(1)[:2], 0.5], "irradiance": self.random.uniform(0, 2)},
            {"type": "point", "position": self.near(30), "power": [self.random.uniform(0, 1000), 0, 1]},
            {"type": "ambient", "irradiance": self.random.uniform(0, 1)},
        )
        return self.random.sample(kinds, self.random.randint(1, 3))

    def edits(self) -> list[dict]:
        """Up to four of every operation."""
        made = []
        for _ in range(self.random.randint(0, 4)):
            edit = {"operation": self.random.choice(("multiply", "add", "set")), "sigma_a": self.random.uniform(0, 3)}
            if self.random.random() < 0.7:
                edit |= {"stroke": [self.near(10) for _ in range(self.random.randint(1, 5))], "radius": 4}
            if self.random.random() < 0.5:
                edit |= {"depth": [0, self.random.uniform(0.5, 4)], "softness": self.random.uniform(0, 2)}
            if self.random.random() < 0.5:
                edit["sigma_s_prime"] = [self.random.uniform(0, 4) for _ in range(3)]
            made.append(edit)
        return made

    def deformation(self) -> list[dict]:
        """Up to two, now and then so strong that tets turn inside out."""
        strong = 8 if self.random.random() < 0.2 else 1
        kinds = (
            {"type": "twist", "degrees": strong * self.random.uniform(-120, 120)},
            {"type": "bend", "degrees": strong * self.random.uniform(-60, 60)},
            {
                "type": "lattice",
                "size": [1, 2, 1],
                "displacements": [[0, 0, 0], [0, -strong * self.random.uniform(0, 9), 0]],
            },
            {"type": "stretch", "factor": self.random.uniform(0.5, 2) ** strong},
            {"type": "transform", "degrees": self.random.uniform(0, 360), "translate": self.near(5)},
        )
        return self.random.sample(kinds, self.random.randint(0, 2))

    def change(self, file) -> None:
        """One to three members of the scene."""
        values = {
            "/material": lambda: self.random.choice(MATERIALS),
            "/lights": self.lights,
            "/edits": self.edits,
            "/deformation": self.deformation,
            "/camera/azimuth": lambda: self.random.uniform(0, 360),
        }
        for pointer in self.random.sample(sorted(values), self.random.randint(1, 3)):
            file.set(pointer, json.dumps(values[pointer]()))


@pytest.mark.parametrize(("rounds", "frames"), [(3, 20), pytest.param(5, 2000, marks=pytest.mark.long)])
def test_frames_stay_finite_and_memory_flat(tmp_path, rounds, frames):
    write_levels(tmp_path / "sphere.qgraph", [icosphere(2, 10), icosphere(1, 10)])
    scene = {"body": "sphere.qgraph", "material": "marble", "picture": {"width": 24, "height": 24}}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    stage = _core.Stage(validation=True)
    device, host, spoilt = [], [], 0
    for _ in range(rounds):  # the same frames: what two rounds have made room for is enough for all
        file, changes, most = _core.SceneFile(tmp_path / "scene.json"), Changes(frames), 0
        for _ in range(frames):
            changes.change(file)
            spoilt += show(stage, file.at(0))
            most = max(most, stage.engine.device_bytes)
        device.append(most)
        host.append(resident())
    print(f"{rounds} rounds of {frames} frames, {spoilt} of them with tets inside out; device {device}, host {host}")
    assert spoilt > 0
    assert stage.engine.validation_messages == []
    assert max(device[1:]) == device[1]
    assert max(host[1:]) <= host[1] + HOST_SLACK


def show(stage, scene) -> bool:
    """Whether there were tets inside out. Fails where something is not finite."""
    stage.show(scene)
    report = stage.solve()
    picture = stage.render()
    assert np.isfinite(report["energy"]["balance"]).all(), scene.json()
    for layer in (picture.scattered, picture.specular, picture.unscattered, picture.transmittance):
        assert np.isfinite(layer).all(), scene.json()
    return bool(report["deformed"])
