"""Tables of unseen cases, and what of them is put in a few numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.table import Table

FACTOR = 1.5  # within which the printed error is to agree with the true one
_TOLD = ("whole", "unlit", "dimmest")  # parts whose error the engine prints
_JUDGED = ("lit", "unlit")
_MOVING = {"true": "true, moving", "still": "a second after", "flicker": "flicker"}
_SPREAD = ("median", "most", "worst")


def summary(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """For each number of sweeps: median, 90% and worst of the true errors by part, and how printed errors agree."""
    found = []
    for number, asked in enumerate(solve["sweeps"] for solve in (rows[0]["solves"] if rows else [])):
        solves = [row["solves"][number] for row in rows]
        true = {part: _spread([s["true"][part] for s in solves if part in s["true"]]) for part in _JUDGED}
        ratios = {part: _agreement([(row["noise"], row["solves"][number]) for row in rows], part) for part in _TOLD}
        found.append({"sweeps": asked, "true": true, "ratios": ratios})
    return found


def _spread(errors: list[float]) -> dict[str, float] | None:
    if not errors:
        return None
    return {"median": float(np.median(errors)), "most": float(np.quantile(errors, 0.9)), "worst": max(errors)}


def _agreement(solves: list[tuple[dict[str, float], dict[str, Any]]], part: str) -> dict[str, Any] | None:
    """Of printed over true errors, where the truth's noise is less than the error. solves: each after that noise."""
    ratios = []
    for noise, solve in solves:
        told = solve["true"].get(part, 0) > noise.get(part, np.inf) and part in solve["printed"]
        ratios += [solve["printed"][part] / solve["true"][part]] if told else []
    if not ratios:
        return None
    within = [1 / FACTOR <= ratio <= FACTOR for ratio in ratios]
    return {"cases": len(ratios), "within": float(np.mean(within)), "least": min(ratios), "greatest": max(ratios)}


def motion_summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Median, 90% and worst in motion: true errors, those a second after it, flicker; how printed errors agree; rays'
    segments a frame, and a frame's time over that without the correction.
    """
    frames = [row["motion"] for row in rows]
    found: dict[str, Any] = {
        name: {part: _spread([f[name][part] for f in frames if part in f[name]]) for part in _JUDGED}
        for name in _MOVING
    }
    agree = {part: _agreement([(row["noise"], row["motion"]) for row in rows], part) for part in _TOLD}
    slower = _spread([f["seconds"] / f["plain"] for f in frames])
    return found | {"ratios": agree, "segments": _spread([f["segments"] for f in frames]), "slower": slower}


def tables(record: dict[str, Any]) -> list[Table]:
    """All cases, and the summary; and both in motion, where that was asked for."""
    found = [_cases(record["rows"]), _summary(record["summary"])]
    if "motion" in record:
        found += [_moving(record["rows"]), _moving_summary(record["motion"])]
    return found


def _cases(rows: list[dict[str, Any]]) -> Table:
    case = ("seed", "mm", "mean free paths", "albedo", "η", "medium", "light", "tets")
    errors = ("true: lit / unlit / dimmest", "noise of the truth", "true, whole", "printed: whole / unlit / dimmest")
    title = "relative RMS error of the exitance, %, by patches"
    table = Table(*case, "sweeps", *errors, "power", "s", title=title)
    for row in rows:
        size = (f"{row['length']:.0f}", f"{row['size']:.1f}", f"{row['albedo']:.4f}", f"{row['eta']:.2f}")
        what = [str(row["seed"]), *size, row["kind"], row["light"].partition(":")[0], f"{row['tets']:,}"]
        for number, found in enumerate(row["solves"]):
            table.add_row(
                *(what if number == 0 else [""] * len(what)),
                "default" if found["sweeps"] is None else str(found["sweeps"]),
                _percents(found["true"], ("lit", "unlit", "dimmest")),
                _percents(row["noise"], ("lit", "unlit", "dimmest")),
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
        true = (_percents(row["true"][part] or {}, _SPREAD) for part in _JUDGED)
        ratios = (_ratios(row["ratios"][part]) for part in _TOLD)
        table.add_row("default" if row["sweeps"] is None else str(row["sweeps"]), *true, *ratios)
    return table


def _moving(rows: list[dict[str, Any]]) -> Table:
    errors = [f"{words}: lit / unlit" for words in _MOVING.values()]
    costs = ("segments a frame, million", "s a frame", "s without the correction")
    title = "in motion: relative RMS error of the exitance, %, by patches"
    table = Table("seed", "tets", *errors, "printed: whole / unlit / dimmest", *costs, title=title)
    for row in rows:
        found = row["motion"]
        table.add_row(
            str(row["seed"]),
            f"{row['tets']:,}",
            *(_percents(found[name], _JUDGED) for name in _MOVING),
            _percents(found["printed"], _TOLD),
            f"{found['segments'] / 1e6:.2f}",
            f"{found['seconds']:.2f}",
            f"{found['plain']:.2f}",
        )
    return table


def _moving_summary(found: dict[str, Any]) -> Table:
    table = Table("in motion", "lit: median / 90% / worst", "unlit", title="summary in motion, %")
    for name, words in _MOVING.items():
        table.add_row(words, *(_percents(found[name][part] or {}, _SPREAD) for part in _JUDGED))
    for part in _TOLD:
        table.add_row(f"printed over true, {part}", _ratios(found["ratios"][part]), "")
    for name, words, unit in (("segments", "segments a frame, million", 1e6), ("slower", "times a frame without", 1)):
        table.add_row(words, " / ".join(f"{found[name][kind] / unit:.2f}" for kind in _SPREAD), "")
    return table


def _ratios(found: dict[str, Any] | None) -> str:
    if found is None:
        return "none told"
    return f"{found['cases']}, {found['within']:.0%}, {found['least']:.2f} to {found['greatest']:.2f}"


def _percents(values: dict[str, float], names: tuple[str, ...]) -> str:
    return " / ".join(f"{100 * values[name]:.2f}" if name in values else "-" for name in names)
