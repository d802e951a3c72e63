"""Cases by seed and number, each run in a folder of its own by one of several threads."""

from __future__ import annotations

import shutil
import signal
import tempfile
import threading
import traceback
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from attack import child
from attack.bodies import Bodies
from attack.case import Case, Outcome, Place, Verdict
from attack.families import FAMILIES
from attack.judge import classify, files_of

WORKERS = 2


def family_of(number: int) -> str:
    """Families take turns."""
    return tuple(FAMILIES)[number % len(FAMILIES)]


def numbers(family: str | None) -> Iterator[int]:
    """The numbers of a family's cases, or of all, without end."""
    number = 0
    while True:
        if family is None or family_of(number) == family:
            yield number
        number += 1


def draw(seed: int, number: int) -> tuple[str, Case]:
    """The family and the case of a number: its recipes in an order by seed, all else by seed and number."""
    family = family_of(number)
    recipes = FAMILIES[family]
    order = np.random.default_rng([seed, list(FAMILIES).index(family)]).permutation(len(recipes))
    recipe = recipes[order[number // len(FAMILIES) % len(recipes)]]
    return family, recipe(np.random.default_rng([seed, number, 1]))


def _inputs(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink())


def run_case(case: Case, folder: Path, bodies: Bodies) -> tuple[str, str, Outcome]:
    """Prepare, run and judge a case below a folder, which must be new."""
    place = Place(folder / "here", bodies)
    place.folder.mkdir(parents=True)
    case.prepare(place)
    before = files_of(place.folder)
    outcome = child.run(case, place.folder, _inputs(place.folder))
    try:
        kind, message = classify(case, place, outcome, before)
    except Exception:  # a judge met what it cannot read: the program wrote that
        kind, message = "silent", f"what was written cannot be judged: {traceback.format_exc()[-300:]}"
    return kind, message, outcome


def judged(seed: int, number: int, folder: Path, bodies: Bodies) -> tuple[Verdict, Outcome]:
    """Draw and run one case, and remove its folder."""
    family, case = draw(seed, number)
    below = folder / f"case-{number:04d}"
    try:
        kind, message, outcome = run_case(case, below, bodies)
    finally:
        shutil.rmtree(below, ignore_errors=True)
    return Verdict(number, family, case.name, kind, message, outcome.seconds, outcome.peak), outcome


def heed_signals() -> None:
    """Let children end by the signals that whoever started us had us ignore."""
    if threading.current_thread() is threading.main_thread():
        for number, usual in ((signal.SIGHUP, signal.SIG_DFL), (signal.SIGINT, signal.default_int_handler)):
            if signal.getsignal(number) == signal.SIG_IGN:
                signal.signal(number, usual)


def run(
    seed: int, wanted: Iterable[int], told: Callable[[Verdict, Outcome], None] = lambda verdict, outcome: None
) -> list[Verdict]:
    """Run the cases of these numbers, two at a time; `told` hears of each as it ends."""
    heed_signals()
    verdicts = []
    with tempfile.TemporaryDirectory(prefix="attack-") as name, ThreadPoolExecutor(WORKERS) as pool:
        folder = Path(name)
        bodies = Bodies(folder)
        for future in [pool.submit(judged, seed, number, folder, bodies) for number in wanted]:
            verdict, outcome = future.result()
            told(verdict, outcome)
            verdicts.append(verdict)
    return verdicts
