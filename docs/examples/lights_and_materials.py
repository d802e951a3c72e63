"""Lights and materials as objects: twice the power of all lights gives twice the exitance."""

from dataclasses import replace
from pathlib import Path

import quadgraph

BODY = Path(__file__).parents[2] / "tests/data/tiny.qgraph"


def main() -> float:
    """Return the exitance with twice the power over that with the power once."""
    light = quadgraph.PointLight(position=(1, 1, -20), power=(30, 20, 10))
    with quadgraph.Engine(BODY) as engine:
        engine.material = quadgraph.Material(sigma_s_prime=(2.0, 2.5, 3.0), sigma_a=(0.002, 0.004, 0.008), eta=1.3)
        exitances = []
        for power in ((30, 20, 10), (60, 40, 20)):
            engine.lights = [replace(light, power=power)]
            engine.solve(tolerance=1e-6)
            exitances.append(float(engine.surface().exitance.sum()))
    return exitances[1] / exitances[0]


if __name__ == "__main__":
    print(main())
