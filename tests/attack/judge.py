"""Which class the end of a case belongs to."""

from __future__ import annotations

import fnmatch
import hashlib
import re
import stat
from collections.abc import Iterable
from pathlib import Path

from attack.case import Case, Outcome, Place

MESSAGE = 500  # characters, fewer than which a refusal takes
NOT_CONVERGED = 3  # the exit code that says so
ENDS = 2.0  # s of wall time within which a signal ends a program ...
COMPUTES = 1.0  # ... of which so many are of the processor; a program that waits may take
WAITS = 10.0  # ... so long
CRASHES = ("terminate called", "Segmentation fault", "Fatal Python error", "Sanitizer", "Aborted (core")
CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
ERROR = re.compile(r"^quadgraph(?:-engine)?[a-z ]*: ", re.MULTILINE)
LARGE = 2**26  # bytes, above which a file's size stands for its contents

Files = dict[str, str]


def files_of(folder: Path) -> Files:
    """What lies below a folder: kind and contents by path, links not followed."""
    found = {}
    for path in sorted(folder.rglob("*")):
        mode = path.lstat().st_mode
        if stat.S_ISLNK(mode):
            text = f"link to {path.readlink()}"
        elif stat.S_ISREG(mode):
            size = path.lstat().st_size
            text = f"file of {size} bytes"
            if size <= LARGE:
                text += " " + hashlib.sha256(path.read_bytes()).hexdigest()
        else:
            text = f"type {stat.S_IFMT(mode):o}"
        found[path.relative_to(folder).as_posix()] = text
    return found


def matches(name: str, patterns: Iterable[str]) -> bool:
    """Whether a path is one of the outputs, or a folder of one."""
    return any(fnmatch.fnmatch(name, pattern) or pattern.startswith(f"{name}/") for pattern in patterns)


def refusal(stderr: str) -> str:
    """The message of a refusal: from the last line that a program begins with its name, else everything."""
    places = [match.start() for match in ERROR.finditer(stderr)]
    return stderr[places[-1] :].strip() if places else stderr.strip()


def without_progress(text: str) -> str:
    """Its last line, shortened, for reports."""
    lines = text.strip().splitlines()
    return lines[-1][:300] if lines else "(nothing)"


def _limits(case: Case, outcome: Outcome) -> tuple[str, str] | None:
    if outcome.limit == "memory":
        return "memory", f"{outcome.peak / 1e6:.0f} MB"
    if outcome.limit:
        return "slow", f"ended after {outcome.seconds:.1f} s"
    if outcome.after is not None:
        wall, computed = outcome.after
        if (wall > ENDS and computed > COMPUTES) or wall > WAITS:
            return "slow", f"ended {wall:.1f} s after a signal, of which {computed:.1f} s were computed"
    return None


def _ended_by_ours(case: Case, outcome: Outcome) -> bool:
    codes = {code for _, number in case.signals for code in (-number, 128 + number)}
    return outcome.after is not None and outcome.code in codes


def _broken(case: Case, outcome: Outcome) -> tuple[str, str] | None:
    if (outcome.code < 0 and not _ended_by_ours(case, outcome)) or any(word in outcome.stderr for word in CRASHES):
        return "crash", f"exit code {outcome.code}: {without_progress(outcome.stderr)}"
    if "Traceback (most recent call last)" in outcome.stderr:
        return "traceback", without_progress(outcome.stderr)
    if found := CONTROL.search(outcome.stdout + outcome.stderr):
        return "traceback", f"prints the control character {found[0]!r}"
    return None


def _left(case: Case, place: Place, before: Files, failed: bool) -> tuple[str, str] | None:
    after = files_of(place.folder)
    allowed = case.outputs if not failed or case.partial else ()
    changed = [name for name in before.keys() | after.keys() if before.get(name) != after.get(name)]
    wrong = sorted(name for name in changed if not matches(name, allowed))
    if wrong:
        name = wrong[0]
        return "left", f"{name}: was {before.get(name, 'not there')}, is {after.get(name, 'gone')}"[:300]
    if case.litter:
        return None
    temporary = sorted(path.name for path in (place.folder.parent / "tmp").iterdir())
    return ("left", f"temporary {temporary[0]}") if temporary else None


def _message(case: Case, outcome: Outcome) -> tuple[str, str]:
    text = refusal(outcome.stderr)
    if not text:
        return "traceback", f"exit code {outcome.code} without a word"
    if len(text) >= MESSAGE:
        return "traceback", f"message of {len(text)} characters: {text[:200]}"
    if case.names and not any(name in text for name in case.names):
        return "traceback", f"names none of {', '.join(case.names)}: {text}"
    return "refused", text


def classify(case: Case, place: Place, outcome: Outcome, before: Files) -> tuple[str, str]:
    """The class of a case and why; `before`: what lay in its folder."""
    if found := _limits(case, outcome) or _broken(case, outcome):
        return found
    failed = outcome.code not in (0, NOT_CONVERGED)
    if outcome.orphans and not case.litter:
        return "left", f"{outcome.orphans} processes outlived it"
    if found := _left(case, place, before, failed):
        return found
    if _ended_by_ours(case, outcome):
        wrong = case.judge(place, outcome) if case.partial else ""
        return ("left", wrong) if wrong else ("fine", f"ended by the signal, exit code {outcome.code}")
    if failed:
        kind, text = _message(case, outcome)
        return ("denied", text) if kind == "refused" and case.expect == "fine" else (kind, text)
    if case.expect == "refused":
        return "silent", f"exit code {outcome.code}, a refusal was due"
    if outcome.code == NOT_CONVERGED:
        return "fine", "said not to be converged"
    wrong = case.judge(place, outcome)
    return ("silent", wrong) if wrong else ("fine", "")
