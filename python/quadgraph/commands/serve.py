"""`quadgraph serve`: the window in a browser, for machines without a display and for notebooks (docs/window.md)."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, get_args

from rich.console import Console

from quadgraph.api.choices import Model, Tone
from quadgraph.api.scene import Scene
from quadgraph.base.errors import InputError
from quadgraph.commands import own_mesh, scene_file, scene_options, scene_overrides
from quadgraph.core import load_core

if TYPE_CHECKING:
    from quadgraph.core import SceneFile

_TOKEN = "QUADGRAPH_SERVE_TOKEN"
_LEAST_TOKEN = 16  # letters
_SIZE = "640x640"


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser(
        "serve",
        help="the window in a browser",
        description=__doc__,
        epilog="Prints the address, with a token in it: whoever has that may look and change, and only on this machine "
        "unless --host says otherwise. From elsewhere: ssh -L 8642:127.0.0.1:8642 MACHINE, then the same address. "
        f"{_TOKEN} in the environment, if set, is the token. Ctrl-C ends it.",
    )
    parser.declare = add_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add all arguments, those of a render among them."""
    scene_options.add_scene_arguments(
        parser, "a mesh, a baked .qgraph, or a scene .json (docs/scene.md)", scene_options.RENDER_GROUPS
    )
    parser.set_defaults(size=_SIZE)
    group = parser.add_argument_group("of the server")
    group.add_argument("--host", default="127.0.0.1", metavar="ADDRESS", help="where it listens (default: %(default)s)")
    group.add_argument("--port", type=port, default=8642, metavar="N", help="0: any (default: %(default)s)")


def port(text: str) -> int:
    """Argument type: a port's number."""
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"found '{text}', allowed are 0 to 65535")
    return int(text)


def run(args: argparse.Namespace) -> int:
    """Serve until it is interrupted."""
    from quadgraph.api.stage import Stage
    from quadgraph.browser.films import Films
    from quadgraph.browser.frame_loop import FrameLoop
    from quadgraph.browser.server import Server
    from quadgraph.browser.shown_scene import ShownScene
    from quadgraph.browser.stamps import Stamps

    core = load_core()
    token = os.environ.get(_TOKEN, "")
    if token and len(token) < _LEAST_TOKEN:
        raise InputError(f"{_TOKEN}: found {len(token)} letters, allowed are at least {_LEAST_TOKEN}")
    with (
        _scene(args) as (scene, own),
        Stage(device=args.device) as stage,
        Stamps(args.file.parent) as stamps,
        Films(args.device, own) as films,
    ):
        stage.show(scene)
        shown = ShownScene(scene, stage.engine.bodies, stage.engine.hosts, stamps)
        low, high = stage.engine.box
        hello = {
            "file": args.file.name,
            "materials": list(core.material_names()),
            "tones": list(get_args(Tone)),
            "bodies": list(stage.engine.bodies),
            "hosts": stage.engine.hosts,
            "methods": list(stage.methods),
            "models": list(get_args(Model)),
            "brush": stage.usual_brush,
            "mirrors": stage.mirrors,
            "films": list(films.turns),
            "box": [low.tolist(), high.tolist()],
        }
        server = Server(args.host, args.port, token, hello, stamps, films)
        frames = FrameLoop(stage, shown, server.show)
        try:
            server.open(frames.inbox)
            Console(highlight=False, soft_wrap=True).print(server.address, markup=False)
            frames.run()
        finally:
            server.close()
    return 0


@contextlib.contextmanager
def _scene(args: argparse.Namespace) -> Iterator[tuple[Scene, SceneFile | None]]:
    """The first frame of a scene file, or a body with what the options say, there as long as the block runs.

    With the file where it has several frames.
    """
    if scene_file.is_scene(args.file):
        with scene_file.opened(args.file) as (file, document):
            scene_overrides.apply(file, document, args)
            yield Scene.from_dict(json.loads(file.at(0).json())), file if file.frames > 1 else None
        return
    with own_mesh.body(args.file, args, surface_only=args.method == "shortest-path") as body:
        document = {"body": str(body.resolve()), "material": args.material}
        file = load_core().scene_file(json.dumps(document))
        scene_overrides.put(file, document, args)
        for name, side in zip(("width", "height"), scene_options.size_of(args), strict=True):
            file.set(f"/picture/{name}", str(side))
        yield Scene.from_dict(json.loads(file.at(0).json())), None
