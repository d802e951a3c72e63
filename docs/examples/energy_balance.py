"""Solve a body in a beam and see where the power goes, without the correction, whose samples miss some .1% of it."""

from pathlib import Path

import quadgraph

BODY = Path(__file__).parents[2] / "tests/data/tiny.qgraph"


def main() -> float:
    """Return the share of the power that entered and is missing, of the worst channel."""
    with quadgraph.Engine(BODY) as engine:
        engine.material = "wholemilk"
        engine.lights = ["directional:0,0,1:2.5"]
        energy = engine.solve(tolerance=1e-6, correction=False).energy
    print(f"entered {energy.entered} W, absorbed {energy.absorbed} W, scattered out {energy.scattered_out} W")
    return float(abs(energy.balance).max())


if __name__ == "__main__":
    print(main())
