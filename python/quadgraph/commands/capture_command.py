"""`quadgraph capture`: a board to print, photographs on it as a capture, and whether a capture can be used.

`board` writes a ChArUco board at its true size; `patterns` writes what a projector is to show, and `projector` finds
where it stands from photographs of that on the board; `import` makes what `quadgraph acquire` reads of a session.json
and its photographs; `check` tells of poses, exposures and what is covered (docs/capture.md).
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quadgraph.base.errors import InputError
from quadgraph.commands import board_arguments, projector_steps
from quadgraph.commands.command_parser import CommandParser

if TYPE_CHECKING:
    from rich.console import Console

UNUSABLE = 3  # exit code
_PAGES = ("a4", "letter", "a3")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand and those below it."""
    said = "photographs for acquire: board, projector, import, check"
    parser = subparsers.add_parser("capture", help=said, description=__doc__)
    below = parser.add_subparsers(dest="step", metavar="STEP", required=True, parser_class=CommandParser)
    _add_board(below.add_parser("board", help="a board to print at its true size", description=run_board.__doc__))
    projector_steps.add_parsers(below)
    _add_import(below.add_parser("import", help="photographs as a capture", description=run_import.__doc__))
    _add_check(below.add_parser("check", help="whether a capture can be used", description=run_check.__doc__))


def _add_board(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--output", metavar="OUT", type=Path, required=True, help=".pdf, .svg or .png to write")
    parser.add_argument("--page", choices=_PAGES, default="a4", help="paper (default: a4)")
    board_arguments.add(parser)


def _add_import(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("session", metavar="SESSION", type=Path, help="session.json, or the folder that it is in")
    parser.add_argument(
        "-o", "--output", metavar="OUT", type=Path, required=True, help="the .json to write; pictures go beside it"
    )


def _add_check(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="CAPTURE", type=Path, help="capture.json")
    parser.add_argument("--page", metavar="FILE", type=Path, help="write one .html that needs nothing else")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write what is found here")


def run(args: argparse.Namespace) -> int:
    """Run the step; 3 where a capture cannot be used."""
    steps = {"board": run_board, **projector_steps.STEPS, "import": run_import, "check": run_check}
    return steps[args.step](args)


def _console() -> Console:
    from rich.console import Console

    return Console(highlight=False, soft_wrap=True)


def run_board(args: argparse.Namespace) -> int:
    """Write a ChArUco board to print at its true size, with two rulers to check the print by."""
    from quadgraph.acquisition.board import drawing
    from quadgraph.base import outputs

    outputs.check_outputs([args.output], [])
    board = board_arguments.board_of(args)
    (columns, rows), hollow = args.squares, board.hollow
    title = f"QuadGraph board {columns}x{rows}"
    drawing.write(args.output, drawing.page_of(board, args.page), title)
    stated = f'"squares": [{columns}, {rows}], "square": {board.square:g}, "marker": {board.marker:g}'
    stated += f', "dictionary": "{board.dictionary}"'
    if hollow[0]:
        stated += f', "hollow": [{hollow[0]}, {hollow[1]}]'
    console = _console()
    console.print(f"board: {args.output}; print at 100%, and measure both rulers: 150 mm", markup=False)
    console.print(f'session.json: "board": {{{stated}}}', markup=False)
    return 0


def run_import(args: argparse.Namespace) -> int:
    """Find cameras, merge exposures, and write a capture of pictures without distortion, as acquire reads it."""
    from rich.console import Console

    from quadgraph.acquisition.session import capture_writing, importing, session_file
    from quadgraph.base import outputs
    from quadgraph.commands.progress_bar import progress_bar

    if args.output.suffix.lower() != ".json":
        raise InputError(f"{args.output}: output must end in .json")
    session = session_file.read(args.session)
    outputs.check_outputs(capture_writing.outputs(session, args.output), session.files())
    errors = Console(stderr=True, highlight=False, soft_wrap=True)
    with progress_bar() as bar:
        task = bar.add_task("import", total=1.0)

        def tell(text: str) -> None:
            (bar.console if bar.console.is_terminal else errors).print(text, markup=False)

        def advance(share: float) -> None:
            bar.update(task, completed=share)

        record = importing.import_session(session, args.output, tell, advance)
    console = _console()
    for line in import_lines(record):
        console.print(line, markup=False)
    console.print(
        f"capture: {args.output}; next: quadgraph capture check {args.output} --page check.html", markup=False
    )
    return 0


def import_lines(record: dict[str, Any]) -> list[str]:
    """What an import found, a line a lens and a photograph."""
    from quadgraph.acquisition.capture.strict_json import Member
    from quadgraph.acquisition.checking import import_record

    lines = []
    for lens in record["lenses"]:
        radial, tangential = lens["radial"], lens["tangential"]
        lines.append(
            f"lens of {lens['width']} x {lens['height']} pixels: focal lengths {lens['fx']:.1f}, {lens['fy']:.1f}, "
            f"middle {lens['cx']:.1f}, {lens['cy']:.1f}, k1 {radial[0]:.4f}, k2 {radial[1]:.4f}, k3 {radial[2]:.4f}, "
            f"p1 {tangential[0]:.5f}, p2 {tangential[1]:.5f}"
        )
    for each in record["photographs"]:
        said = f"{each['photograph']} ({', '.join(each['files'])}): eye " + ", ".join(f"{x:.1f}" for x in each["eye"])
        if "corners" in each:
            said += f" mm; {len(each['corners'])} corners, {each['reprojection']:.2f} pixels off (RMS)"
        lines.append(said)
    for name, lamp in record["lamps"].items():
        lines.append(f"lamp {name}: {import_record.found_lamp(Member('', '', lamp)).line()}")
    return lines


def run_check(args: argparse.Namespace) -> int:
    """Tell of a capture's poses, scale, exposures and coverage; 3 if something cannot be used."""
    from quadgraph.acquisition.capture import capture
    from quadgraph.acquisition.checking import capture_check
    from quadgraph.base import atomic_file, outputs

    if args.page and args.page.suffix.lower() != ".html":
        raise InputError(f"{args.page}: a page must end in .html")
    stated = capture.read(args.file)
    outputs.check_outputs([args.page, args.json], [*stated.files(), capture_check.record_of(args.file)])
    checked = capture_check.check(stated)
    if args.json:
        atomic_file.write_json(args.json, checked.report())
    if args.page:
        from quadgraph.acquisition.checking import check_page

        check_page.write(args.page, checked)
    console = _console()
    for line in checked.lines():
        console.print(line, markup=False)
    return UNUSABLE if checked.unusable else 0
