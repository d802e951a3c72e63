"""`quadgraph acquire`: what a body is made of, from photographs of it (docs/acquisition.md).

Finds absorption and reduced scattering of red, green and blue, with their standard deviations, and writes them as
--material takes them: the same throughout, or with --volume from place to place.
"""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from quadgraph.acquisition.volume.volume_options import PUBLISHED, SCHEMES, TOTAL_VARIATION, VolumeOptions
from quadgraph.base.arguments import add_device_arguments, up_to
from quadgraph.base.errors import InputError
from quadgraph.base.progress import ProgressCallback
from quadgraph.work.finished_tasks import LEDGER
from quadgraph.work.schedulers import StayingWorkers, add_scheduler_argument, check_several

if TYPE_CHECKING:
    from quadgraph.acquisition.recovery import Recovered
    from quadgraph.commands.light_tasks import LightTasks

DISAGREES = 3  # exit code


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("acquire", help="coefficients of a body, from photographs", description=__doc__)
    parser.add_argument(
        "file", metavar="CAPTURE", nargs="+", type=Path, help="capture.json (docs/acquisition.md); several allowed"
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        type=Path,
        required=True,
        help="the .npz to write, as --material takes it; of several captures the folder for them",
    )
    add_scheduler_argument(parser, "several captures, or the lights of one,")
    parser.add_argument(
        "--volume", action="store_true", help="find coefficients that differ from place to place; takes minutes"
    )
    parser.add_argument(
        "--spacing",
        metavar="MM",
        type=up_to(1000),
        help="of the points where --volume has its unknowns (default: as far apart as the edges of the "
        "body's tets, and at most 2,000)",
    )
    parser.add_argument(
        "--scheme",
        choices=SCHEMES,
        help="of --volume: what is taken where the photographs leave coefficients open, as few and small edges as can "
        "be, or (h1) as small slopes; or the published inverse diffusion, for comparison (default: "
        f"{TOTAL_VARIATION})",
    )
    parser.add_argument(
        "--json",
        metavar="FILE",
        type=Path,
        help="write coefficients, standard deviations, chi^2, gains and what is to be said against them here",
    )
    parser.add_argument(
        "--report",
        metavar="FILE",
        type=Path,
        help="write one .html that needs nothing else: photographs, predictions, residuals, coefficients, convergence",
    )
    parser.add_argument(
        "--correction",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="predict by the engine corrected by sweeps of the transport equation; without, the coefficients are those "
        "of its moment equations (default: --correction)",
    )
    parser.add_argument(
        "--resume",
        metavar="FOLDER",
        type=Path,
        help="of --volume: keep there after each outer step how far the fit is, and go on from what is there",
    )
    add_device_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Recover and write; 3 where photographs contradict what the capture says, or the fit did not settle."""
    from rich.console import Console

    from quadgraph.acquisition.capture import capture
    from quadgraph.acquisition.recovery import recover
    from quadgraph.base import atomic_file, outputs
    from quadgraph.commands.progress_bar import progress_bar

    _check(args)
    if len(args.file) > 1:
        from quadgraph.commands import acquire_many

        return acquire_many.run(args)
    (file,) = args.file
    stated = capture.read(file)
    outputs.check_outputs([args.output, args.json, args.report], stated.files())
    errors = Console(stderr=True, highlight=False, soft_wrap=True)
    with progress_bar() as bar:
        task = bar.add_task("acquire", total=1.0)

        def tell(text: str) -> None:
            (bar.console if bar.console.is_terminal else errors).print(text, markup=False)

        def advance(share: float) -> None:
            bar.update(task, completed=share)

        volume = VolumeOptions(args.spacing, args.scheme or TOTAL_VARIATION) if args.volume else None
        device = args.device, args.validation
        with ExitStack() as until:
            spread = _spread(args, until, tell) if args.scheduler else None
            found = recover(stated, args.correction, volume, tell, advance, *device, args.resume, spread)
    found.material.save(args.output)
    if args.json:
        atomic_file.write_json(args.json, found.report())
    if args.report:
        from quadgraph.acquisition import report_page

        report_page.write(args.report, found)
    _summarise(found, args.output)
    return 0 if is_settled(found) else DISAGREES


def _spread(args: argparse.Namespace, until: ExitStack, tell: ProgressCallback) -> LightTasks:
    from quadgraph.commands.light_tasks import LightTasks

    workers = StayingWorkers(args.scheduler, until)
    return LightTasks(workers, args.output.parent / LEDGER, args.device, args.validation, tell)


def _check(args: argparse.Namespace) -> None:
    """Raise InputError for options that do not go together."""
    spread = len(args.file) > 1 or (args.correction and args.scheme != PUBLISHED)
    check_several(args, spread, "several captures are wanted, or one whose predictions are corrected")
    if len(args.file) == 1 and args.output.suffix.lower() != ".npz":
        raise InputError(f"{args.output}: output must end in .npz")
    if args.report and args.report.suffix.lower() != ".html":
        raise InputError(f"{args.report}: a report must end in .html")
    if args.spacing is not None and not args.volume:
        raise InputError("--spacing: found without --volume, which it is of; state both or neither")
    if args.scheme is not None and not args.volume:
        raise InputError("--scheme: found without --volume, which it is of; state both or neither")
    if args.resume and args.scheme == PUBLISHED:
        raise InputError(f"--resume: found with --scheme {PUBLISHED}, which keeps no steps; leave one of them out")
    if args.resume and not args.volume:
        raise InputError("--resume: found without --volume, whose steps it keeps; leave it out, for the rest is quick")


def is_settled(found: Recovered) -> bool:
    """Whether a fit came to its end, and photographs do not contradict what the capture says."""
    from quadgraph.acquisition.volume.volume_fit import VolumeFit

    return (isinstance(found.fit, VolumeFit) or found.fit.converged) and not found.findings


def _summarise(found: Recovered, output: Path) -> None:
    from rich.console import Console

    console = Console(highlight=False, soft_wrap=True)
    for line in lines(found):
        console.print(line, markup=False)
    console.print(f"material: {output}")


def lines(found: Recovered) -> list[str]:
    """What was found, a line a coefficient, and what is to be said of it."""
    from quadgraph.acquisition.model.prediction import CHANNELS, NAMES
    from quadgraph.acquisition.volume import volume_report
    from quadgraph.acquisition.volume.volume_fit import VolumeFit

    fit = found.fit
    if isinstance(fit, VolumeFit):
        return [*volume_report.lines(fit), *found.undetermined, *found.findings, *found.notes]
    said = []
    for row, name in enumerate(NAMES):
        values = (
            f"{colour} {value:.4g} ± {value * deviation:.2g}"
            for colour, value, deviation in zip(CHANNELS, fit.coefficients[row], fit.deviations[row], strict=True)
        )
        said.append(f"{name}, 1/mm: {', '.join(values)}")
    said.append(f"chi^2 per degree of freedom: {', '.join(f'{value:.3g}' for value in fit.chi_squared)}")
    return [*said, *found.undetermined, *found.findings, *found.notes]
