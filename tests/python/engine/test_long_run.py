"""A body shown for long while light, material, edits and shape change at random: finite, without leak or message."""

from __future__ import annotations

import ctypes
import gc
import json
import os
import random
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from shapes import icosphere

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

MATERIALS = ("marble", "skin1", "ketchup", "wholemilk", "spectralon", "jade", "wood", "marble-veins", "chicken1,eta=1")
HOST_SLACK = 24 << 20  # bytes: what allocators keep, and books of the validation layer (1.2 to 1.6 kB a frame)
OWN_SLACK = 4 << 10  # bytes, without that layer, in a STILL process: what the interpreter keeps, 800 in 40 rounds
WARM = 2  # rounds that may make room and compile
# One thread for all, as llvmpipe otherwise holds up to seven blocks of 64 KiB at a time until its threads come to free
# them; freed memory counted as free at once; no pages of their own, rounded up, for some arrays some of the time.
STILL = {
    "QUADGRAPH_THREADS": "1",
    "LP_NUM_THREADS": "0",
    "GLIBC_TUNABLES": "glibc.malloc.tcache_count=0:glibc.malloc.mmap_threshold=1073741824",
}


class _Mallinfo2(ctypes.Structure):
    _names = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost"
    _fields_ = [(name, ctypes.c_size_t) for name in _names.split()]


def allocated() -> int:
    """Host memory that is allocated and not freed, bytes."""
    mallinfo2 = ctypes.CDLL(None).mallinfo2
    mallinfo2.restype = _Mallinfo2
    gc.collect()
    info = mallinfo2()
    return info.uordblks + info.hblkhd


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


def scene_of_a_sphere(folder: Path, finest: int = 2) -> Path:
    """A scene file beside its body, whose levels are icospheres of `finest` subdivisions and one fewer."""
    write_levels(folder / "sphere.qgraph", [icosphere(finest, 10), icosphere(finest - 1, 10)])
    few = {"sweeps": 1, "sweep_points": 500}
    scene = {"body": "sphere.qgraph", "material": "marble", "picture": {"width": 24, "height": 24}, "solver": few}
    (folder / "scene.json").write_text(json.dumps(scene))
    return folder / "scene.json"


@pytest.mark.parametrize(("rounds", "frames"), [(3, 20), pytest.param(5, 2000, marks=pytest.mark.long)])
def test_frames_stay_finite_and_memory_flat(tmp_path, rounds, frames):
    scene, stage = scene_of_a_sphere(tmp_path), _core.Stage(validation=True)
    device, host, spoilt = [], [], 0
    for _ in range(rounds):  # the same frames: what two rounds have made room for is enough for all
        file, changes, most = _core.SceneFile(scene), Changes(frames), 0
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


@pytest.mark.parametrize(
    ("device", "rounds", "frames"),
    [
        ("cpu", 10, 8),
        *(pytest.param(device, 5, 2000, marks=pytest.mark.long) for device in ("cpu", "llvmpipe")),
    ],
)
def test_the_engine_keeps_nothing_of_a_frame(tmp_path, device, rounds, frames):
    """Repeated frames leave as much behind as they found, once two rounds have made room for them.

    Objects by kind and bytes of device memory: exactly, so that one object or byte kept in a round is found.
    Host memory: bytes allocated and not freed, to OWN_SLACK in all rounds after the warm ones: found is a leak of 64
    bytes a frame (10 rounds of 8), or of 0.7 (long).
    """
    if getattr(ctypes.CDLL(None), "mallinfo2", None) is None:
        pytest.skip("the C library has no mallinfo2 (glibc 2.33)")
    command = [sys.executable, __file__, str(tmp_path), str(rounds), str(frames), device]
    helpers = str(Path(__file__).resolve().parents[1])
    run = subprocess.run(
        command, env=os.environ | STILL | {"PYTHONPATH": helpers}, stdout=subprocess.PIPE, text=True, check=True
    )
    after = json.loads(run.stdout)
    print(f"{rounds} rounds of {frames} frames: {[r['host'] for r in after]} bytes allocated")
    warm, *later = after[WARM - 1 :]
    assert [r["live"] for r in later] == [warm["live"]] * len(later)
    assert max(r["host"] for r in later) <= warm["host"] + OWN_SLACK


def rounds_of_frames(folder: Path, rounds: int, frames: int, device: str) -> list[dict]:
    """What there is after every round of the same frames: live, objects by kind; host, bytes."""
    # What is kept of a frame is looked for to the byte, on however small a body; a solve of this takes half the time.
    scene, stage, after = scene_of_a_sphere(folder, 1), _core.Stage(device), []
    for _ in range(rounds):
        file, changes = _core.SceneFile(scene), Changes(frames)
        for _ in range(frames):
            changes.change(file)
            show(stage, file.at(0))
        after.append({"live": _core.live_objects(), "host": allocated()})
    return after


@pytest.mark.long
def test_a_hundred_thousand_frames_take_no_more_memory_than_ten_thousand(tmp_path):
    """The light turns, and with it the material of every fourth frame; each is solved and drawn."""
    engine = _core.Engine(write_levels(tmp_path / "sphere.qgraph", [icosphere(1, 10)]), device="cpu")
    device, host = [], []
    for tenth in range(10):
        for frame in range(10_000):
            engine.set_material(MATERIALS[frame // 4 % len(MATERIALS)])
            engine.set_lights([f"directional:{frame % 7 - 3},-1,{tenth - 5}:1"])
            balance = engine.solve(model="diffusion", correction=False)["energy"]["balance"]
            assert np.abs(balance).max() < 1e-3, (tenth, frame)
            engine.render(f"{7 * frame % 360},10", width=8, height=8)
        device.append(_core.live_objects())
        host.append(resident())
    print(f"live {device[0]} and {device[-1]}, resident {[round(bytes_ / 1e6, 1) for bytes_ in host]} MB")
    assert device[1:] == device[:-1]
    assert max(host) <= host[0] + HOST_SLACK


def show(stage, scene) -> bool:
    """Whether there were tets inside out. Fails where something is not finite."""
    stage.show(scene)
    report = stage.solve()
    picture = stage.render()
    assert np.isfinite(report["energy"]["balance"]).all(), scene.json()
    for layer in (picture.scattered, picture.specular, picture.unscattered, picture.transmittance):
        assert np.isfinite(layer).all(), scene.json()
    return bool(report["deformed"])


if __name__ == "__main__":
    print(json.dumps(rounds_of_frames(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4])))
