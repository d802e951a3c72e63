"""The bake of `quadgraph view` in a process of its own: the mesh, sizes as JSON and a folder are its arguments.

Progress goes to standard error, a line each; the body is named in a line of JSON on standard output. It is the one that
is kept, whichever program has baked it, or, where none can be kept, one in the folder.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from quadgraph.base import program


def bake(mesh: Path, sizes: str, folder: Path) -> int:
    """Find, await or bake the body, and name it."""
    from quadgraph.baking import kept
    from quadgraph.baking.pipeline import BakeOptions

    def tell(text: str) -> None:
        print(text, file=sys.stderr, flush=True)

    with kept.body(mesh, BakeOptions(**json.loads(sizes)), tell) as body:
        if not body.is_relative_to(kept.folder()):  # it goes when the block ends
            body = body.rename(folder / body.name)
        print(json.dumps({"body": str(body.resolve())}))
    return 0


if __name__ == "__main__":
    sys.exit(program.ended(lambda: bake(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))))
