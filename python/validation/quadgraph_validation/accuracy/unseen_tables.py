"""Tables of unseen cases, and what of them is put in a few numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.table import Table

FACTOR = 1.5  # within which the printed error is to agree with the true one
_TOLD = ("whole", "unlit")  # parts whose error the engine prints
_JUDGED = ("lit", "unlit")


def summary(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """For each number of sweeps: median, 90% and worst of the true errors by part, and how printed errors agree."""
    found = []
    for number, asked in enumerate(solve["sweeps"] for solve in (rows[0]["solves"] if rows else [])):
        solves = [row["solves"][number] for row in rows]
        true = {part: _spread([s["true"][part] for s in solves if part in s["true"]]) for part in _JUDGED}
        ratios = {part: _agreement(rows, number, part) for part in _TOLD}
        found.append({"sweeps": asked, "true": true, "ratios": ratios})
    return found


def _spread(errors: list[float]) -> dict[str, float] | None:
    if not errors:
        return None
    return {"median": float(np.median(errors)), "most": float(np.quantile(errors, 0.9)), "worst": max(errors)}


def _agreement(rows: list[dict[str, Any]], number: int, part: str) -> dict[str, Any] | None:
    """Of printed over true errors, where the truth's noise is less than the error."""
    ratios = []
    for row in rows:
        solve = row["solves"][number]
        told = solve["true"].get(part, 0) > row["noise"].get(part, np.inf) and part in solve["printed"]
        ratios += [solve["printed"][part] / solve["true"][part]] if told else []
    if not ratios:
        return None
    within = [1 / FACTOR <= ratio <= FACTOR for ratio in ratios]
    return {"cases": len(ratios), "within": float(np.mean(within)), "least": min(ratios), "greatest": max(ratios)}


def tables(record: dict[str, Any]) -> list[Table]:
    """All cases, and the summary."""
    return [_cases(record["rows"]), _summary(record["summary"])]


def _cases(rows: list[dict[str, Any]]) -> Table:
    case = ("seed", "mm", "mean free paths", "albedo", "η", "medium", "light", "tets")
    errors = ("true: lit / unlit / dim", "noise of the truth", "true, whole", "printed: whole / unlit")
    title = "relative RMS error of the exitance, %, by patches"
    table = Table(*case, "sweeps", *errors, "power", "s", title=title)
    for row in rows:
        size = (f"{row['length']:.0f}", f"{row['size']:.1f}", f"{row['albedo']:.4f}", f"{row['eta']:.2f}")
        what = [str(row["seed"]), *size, row["kind"], row["light"].partition(":")[0], f"{row['tets']:,}"]
        for number, found in enumerate(row["solves"]):
            table.add_row(
                *(what if number == 0 else [""] * len(what)),
                "default" if found["sweeps"] is None else str(found["sweeps"]),
                _percents(found["true"], ("lit", "unlit", "dim")),
                _percents(row["noise"], ("lit", "unlit", "dim")),
                _percents(found["true"], ("whole",)),
                _percents(found["printed"], _TOLD),
                f"{found['ratio']:.3f}",
                f"{found['seconds']:.1f}",
                end_section=number == len(row["solves"]) - 1,
            )
    return table


def _summary(rows: list[dict[str, Any]]) -> Table:
    columns = ("sweeps", "true, %, lit: median / 90% / worst", "true, %, unlit")
    told = "printed over true, {}: cases, within a factor {:g}, least to greatest"
    table = Table(*columns, *(told.format(part, FACTOR) for part in _TOLD), title="summary")
    for row in rows:
        true = (_percents(row["true"][part] or {}, ("median", "most", "worst")) for part in _JUDGED)
        ratios = (_ratios(row["ratios"][part]) for part in _TOLD)
        table.add_row("default" if row["sweeps"] is None else str(row["sweeps"]), *true, *ratios)
    return table


def _ratios(found: dict[str, Any] | None) -> str:
    if found is None:
        return "none told"
    return f"{found['cases']}, {found['within']:.0%}, {found['least']:.2f} to {found['greatest']:.2f}"


def _percents(values: dict[str, float], names: tuple[str, ...]) -> str:
    return " / ".join(f"{100 * values[name]:.2f}" if name in values else "-" for name in names)
