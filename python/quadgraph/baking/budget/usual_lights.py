"""Sets of lights around a body that its error is measured under."""

from __future__ import annotations

import numpy as np

LIGHTS = ("sun", "sun and sky", "three", "lamp", "near lamp and sky")


def lights(name: str, vertices: np.ndarray) -> list[str]:
    """What the engine reads for a name in LIGHTS, around a body of these vertices (n, 3), mm."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle, size = (low + high) / 2, float((high - low).max())

    def lamp(way: tuple[float, float, float]) -> str:
        """A point light that gives about 1 W/mm^2 at the middle of the body."""
        place = middle + size * np.array(way)
        power = 4 * np.pi * size**2 * float(np.dot(way, way))
        return f"point:{','.join(f'{x:g}' for x in place)}:{power:g}"

    return {
        "sun": ["directional:0.3,-0.2,-0.9:1"],
        "sun and sky": ["directional:-1,-0.3,0.2:1", "ambient:0.02"],
        "three": ["directional:0.3,-0.2,-0.9:1", "directional:-1,-0.3,0.2:0.3", "ambient:0.1"],
        "lamp": [lamp((0.8, 0.7, 0.6))],
        "near lamp and sky": [lamp((-0.2, 0.9, -0.5)), "ambient:0.05"],
    }[name]
