"""A hostile input: what lies in its folder, what is run there, and how its end is judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from attack.bodies import Bodies

GIGABYTE = 10**9
# What may become of a case; those after the first two are faults. "denied" is good input that was refused.
CLASSES = ("refused", "fine", "crash", "traceback", "memory", "slow", "silent", "left", "denied")
GOOD = CLASSES[:2]


@dataclass(frozen=True)
class Place:
    """Where a case runs: the folder that it is prepared in, and bodies to copy or to compare with."""

    folder: Path
    bodies: Bodies


@dataclass(frozen=True)
class Outcome:
    """How a child ended. Times in s; peak: bytes of the child and all that it started.

    code: negative for a signal; limit: "memory" or "time" where the runner ended it; after: seconds of wall and of
    processor time between the first signal and the end, None without one; orphans: processes that outlived it.
    """

    code: int
    stdout: str
    stderr: str
    seconds: float
    peak: int
    limit: str = ""
    after: tuple[float, float] | None = None
    orphans: int = 0


@dataclass(frozen=True)
class Case:
    """One hostile input.

    command: run in the folder, its first word `quadgraph`, `quadgraph-engine`, `python` or `sh`; names: one of them is
    in every good refusal; outputs: patterns of files that may be new or other after success; partial: such files may
    also stay, whole, after a failure; judge: after success "" or what is wrong; expect: "fine" where a refusal is
    wrong, "refused" where anything else is; signals: sent so many seconds after the program heeds them; blocks: limit
    of the size of written files, in 512 bytes; files: that may be open; litter: temporary files may stay; memory:
    bytes, besides 20 times those of the folder; seconds: of processor time, a quarter of the wall time allowed.
    """

    name: str
    command: Sequence[str]
    names: tuple[str, ...] = ()
    prepare: Callable[[Place], object] = lambda place: None
    outputs: tuple[str, ...] = ()
    partial: bool = False
    judge: Callable[[Place, Outcome], str] = lambda place, outcome: ""
    expect: str = ""
    signals: tuple[tuple[float, int], ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)
    blocks: int | None = None
    files: int | None = None
    litter: bool = False
    memory: int = GIGABYTE
    seconds: float = 20.0


@dataclass(frozen=True)
class Verdict:
    """What became of a case: its number and family, one of CLASSES, and why."""

    number: int
    family: str
    name: str
    kind: str
    message: str
    seconds: float
    peak: int

    @property
    def good(self) -> bool:
        """Whether it was refused or fine."""
        return self.kind in GOOD
