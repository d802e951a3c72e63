"""An animation of a glTF 2.0 file: what its channels make of nodes at a time (glTF 2.0, 3.11 and appendix C)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from quadgraph.base.errors import InputError
from quadgraph.mesh.gltf_file import GltfFile

_PATHS = ("translation", "rotation", "scale", "weights")


@dataclass(frozen=True)
class _Channel:
    """Keys of one property of a node: times (k,) s; values (k, width), with CUBICSPLINE (k, 3, width)."""

    node: int
    path: str
    interpolation: str
    times: np.ndarray
    values: np.ndarray

    def at(self, time: float) -> np.ndarray:
        time = float(np.clip(time, self.times[0], self.times[-1]))
        k = int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, max(len(self.times) - 2, 0)))
        last = min(k + 1, len(self.times) - 1)
        length = self.times[last] - self.times[k]
        share = (time - self.times[k]) / length if length > 0 else 0.0
        if self.interpolation == "CUBICSPLINE":
            return self._spline(k, last, share, length)
        if self.interpolation == "STEP" or share in (0, 1):
            return self.values[last if share == 1 else k]
        if self.path == "rotation":
            return Slerp([0, 1], Rotation.from_quat(self.values[[k, last]]))(share).as_quat()
        return (1 - share) * self.values[k] + share * self.values[last]

    def _spline(self, k: int, last: int, t: float, length: float) -> np.ndarray:
        """Hermite's: of a key the incoming tangent, the value, the outgoing tangent."""
        value = (
            (2 * t**3 - 3 * t**2 + 1) * self.values[k, 1]
            + length * (t**3 - 2 * t**2 + t) * self.values[k, 2]
            + (3 * t**2 - 2 * t**3) * self.values[last, 1]
            + length * (t**3 - t**2) * self.values[last, 0]
        )
        return value / np.linalg.norm(value) if self.path == "rotation" else value


@dataclass(frozen=True)
class Animation:
    """Its channels; it begins with the first key of any, and ends with the last, in s."""

    channels: list[_Channel]

    @property
    def begin(self) -> float:
        return min(float(channel.times[0]) for channel in self.channels)

    @property
    def end(self) -> float:
        return max(float(channel.times[-1]) for channel in self.channels)

    def at(self, time: float) -> dict[int, dict[str, np.ndarray]]:
        """By number of a node: its translation (3,), rotation (4,), scale (3,), weights, as far as they are moved."""
        posed: dict[int, dict[str, np.ndarray]] = {}
        for channel in self.channels:
            posed.setdefault(channel.node, {})[channel.path] = channel.at(time)
        return posed


def animation_of(file: GltfFile, name: str | None = None) -> Animation:
    """The animation of that name, or the only one. Raises InputError."""
    all_of_them = file.document.get("animations", [])
    names = [animation.get("name", str(number)) for number, animation in enumerate(all_of_them)]
    if not names:
        raise InputError(f"{file.path}: no animation found")
    if name is None and len(names) > 1:
        raise InputError(f"{file.path}: {len(names)} animations found, choose one of them: {', '.join(names)}")
    if name is not None and name not in names:
        raise InputError(f"{file.path}: animation '{name}' not found, there are {', '.join(names)}")
    chosen = all_of_them[names.index(name) if name is not None else 0]
    channels = [
        _channel(file, chosen["samplers"][channel["sampler"]], channel["target"])
        for channel in chosen["channels"]
        if "node" in channel["target"] and channel["target"]["path"] in _PATHS
    ]
    if not channels:
        raise InputError(f"{file.path}: the animation moves nothing")
    return Animation(channels)


def _channel(file: GltfFile, sampler: dict, target: dict) -> _Channel:
    interpolation, path = sampler.get("interpolation", "LINEAR"), target["path"]
    if interpolation not in ("LINEAR", "STEP", "CUBICSPLINE"):
        raise InputError(f"{file.path}: interpolation '{interpolation}', allowed are LINEAR, STEP, CUBICSPLINE")
    times = file.accessor(sampler["input"])[:, 0]
    if len(times) == 0 or not (np.all(np.isfinite(times)) and np.all(np.diff(times) > 0)):
        raise InputError(f"{file.path}: the times of an animation must rise from key to key")
    values = file.accessor(sampler["output"]).astype(np.float64)
    each = (3,) if interpolation == "CUBICSPLINE" else ()
    width = values.size // (len(times) * (3 if each else 1))
    if width == 0 or values.size != len(times) * (3 if each else 1) * width or not np.all(np.isfinite(values)):
        raise InputError(f"{file.path}: {values.size} values of '{path}' for {len(times)} times")
    return _Channel(target["node"], path, interpolation, times, values.reshape(len(times), *each, width))
