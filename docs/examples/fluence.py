"""Fluence where the method has its unknowns, and at points of one's own."""

from pathlib import Path

import numpy as np

import quadgraph

BODY = Path(__file__).parents[2] / "tests/data/tiny.qgraph"


def main() -> float:
    """Return the largest relative difference between the unknowns and the fluence asked for at their points."""
    with quadgraph.Engine(BODY) as engine:
        engine.material = quadgraph.Material.parse("marble")
        engine.solve(method="fem")
        fluence = engine.fluence()
        again = engine.fluence_at(fluence.points)
        low, high = engine.box
        print(f"in the middle {engine.fluence_at([(low + high) / 2])[0]} W/mm^2")
    return float(np.abs(again - fluence.values).max() / np.abs(fluence.values).max())


if __name__ == "__main__":
    print(main())
