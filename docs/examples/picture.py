"""Render a body and write a PNG."""

import tempfile
from pathlib import Path

import quadgraph

BODY = Path(__file__).parents[2] / "tests/data/tiny.qgraph"


def main() -> float:
    """Return the share of the picture that the body covers."""
    with quadgraph.Engine(BODY) as engine, tempfile.TemporaryDirectory() as folder:
        engine.material = "marble"
        engine.solve()
        picture = engine.render("30,10", width=64, height=64)
        picture.save(Path(folder) / "cube.png", background="black")
        print(f"{(Path(folder) / 'cube.png').stat().st_size} bytes")
    return float(picture.alpha.mean())


if __name__ == "__main__":
    print(main())
