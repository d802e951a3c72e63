"""Whether a solve that was asked for an error has it: bodies that the benchmark does not use."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.table import Table

from quadgraph.baking.budget import finer_levels
from quadgraph.baking.budget.surface_errors import PARTS
from quadgraph_validation.accuracy.judged_levels import Judged, LevelCase, judged
from quadgraph_validation.bodies import level_chains
from quadgraph_validation.bodies.level_chains import ChainSubject

FINER = 1  # the truth has four times the vertices: so few are left where errors of 1% are
ASKED = (0.05, 0.02, 0.01)  # relative RMS error of M

SUBJECTS = (
    ChainSubject("spot", "spot.ply", 4),
    ChainSubject("fertility", "fertility.ply", 6),
    ChainSubject("igea", "igea.ply", 5, 28000),
    ChainSubject("armadillo", "armadillo.ply", 6, 28000),
    ChainSubject("twirl", "twirl.ply", 5),
    ChainSubject("fandisk", "fandisk.ply", 4),
)
CASES = (
    LevelCase("spot", "skin1", "sun and sky"),
    LevelCase("fertility", "ketchup", "three"),
    LevelCase("igea", "skin2", "sun"),
    LevelCase("armadillo", "ketchup", "sun"),
    LevelCase("twirl", "potato", "lamp"),
    LevelCase("fandisk", "ketchup", "sun and sky"),
)


@dataclass(frozen=True)
class Pair:
    """A baked body without its finest level, under two truths: its own mesh cut finer, and that finest level.

    The second has relief that the judged file does not: no solve of that file can tell what it lacks.
    """

    own: Judged
    original: Judged

    @classmethod
    def of(cls, path: Path, device: str) -> Pair:
        """The pair of a baked chain. Raises InputError as Judged does."""
        judged_file = level_chains.without_finest(path, FINER, path.with_name(f"{path.stem}-judged.qgraph"))
        own = finer_levels.refined(judged_file, FINER, path.with_name(f"{path.stem}-refined.qgraph"))
        return cls(Judged(own, device, FINER), Judged(path, device, FINER))

    def light(self, case: LevelCase) -> None:
        """Set the case's material and lights, and find the truths."""
        self.own.light(case)
        self.original.light(case)


def judge(body: Pair, case: LevelCase) -> list[dict[str, Any]]:
    """A row per error asked for: whether the engine says that it got there, and the true error by part."""
    body.light(case)
    return [_row(body, case, asked) for asked in ASKED]


def _row(body: Pair, case: LevelCase, asked: float) -> dict[str, Any]:
    report = body.own.solve(FINER, error=asked)
    beside = body.original.solve(FINER, error=asked)
    return asdict(case) | {
        "model": report["model"],
        "asked": asked,
        "reached": not report["missed"],
        "vertices": body.own.vertices_of(FINER + report["finest"]),
        "work": report["work"],
        "estimate": {part: report["error"][part] for part in PARTS},
        "true": body.own.true_error(FINER, report["finest"]),
        "of_original": body.original.true_error(FINER, beside["finest"]),
    }


def run(device: str, meshes: Path, names: list[str]) -> dict[str, Any]:
    """Judge the named subjects, all if there are none. meshes: folder of the mesh files.

    Raises InputError for an unknown name or a mesh that cannot be read.
    """
    subjects = level_chains.chosen(SUBJECTS, names)
    return record_of(judged(subjects, CASES, meshes, lambda path: Pair.of(path, device), judge))


def record_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The record of a run with these rows."""
    return {"rows": rows}


def tables(record: dict[str, Any]) -> list[Table]:
    """One row per body and error asked for."""
    columns = ("body", "material", "light", "model", "asked", "reached", "vertices", "work")
    found = [(what, part) for what in ("estimate", "true", "of_original") for part in PARTS]
    table = Table(*columns, *(", ".join(pair).replace("_", " ") for pair in found), title="--error")
    for row in record["rows"]:
        numbers = [f"{row[what][part]:.2%}" if part in row[what] else "" for what, part in found]
        names = [row[key] for key in ("subject", "material", "light", "model")]
        reached = "yes" if row["reached"] else "no"
        table.add_row(*names, f"{row['asked']:.0%}", reached, f"{row['vertices']:,}", f"{row['work']:.1f}", *numbers)
    return [table]
