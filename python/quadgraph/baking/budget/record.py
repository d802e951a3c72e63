"""What a bake for an error measured, in words; what a solve of its file takes is engine/scene/measured_error.h."""

from __future__ import annotations

from typing import Any

from quadgraph.base.errors import FormatError

# Words for the shares of a record; docs/accuracy.md says how each is measured.
_PARTS = {"whole": "of the surface", "unlit": "of its unlit part"}


# What reading a record can raise that no bake wrote.
_BROKEN = (KeyError, TypeError, ValueError, AttributeError, ZeroDivisionError)


def sentences(budget: dict[str, Any], file: str) -> list[str]:
    """What was chosen, what was left out, and why.

    budget: as quadgraph.baking.budget.plan writes it. Raises FormatError.
    """
    if "inter_reflection" not in budget:
        return ["error: measured against SP3 alone, by an earlier version: bake again"]
    try:
        return [
            _verdict(budget),
            _surface(budget),
            _model(budget),
            _cycles(budget),
            _sweeps(budget),
            _interior(budget),
            _truth(budget),
        ]
    except _BROKEN as error:
        raise _no_record(file, error) from error


def _no_record(file: str, error: Exception) -> FormatError:
    return FormatError(f"{file}: metadata: 'budget' is not what a bake writes ({error!r})")


def percent(value: float) -> str:
    """Two digits."""
    return f"{100 * value:.2g}%"


def _verdict(budget: dict[str, Any]) -> str:
    worst: dict[str, float] = {}
    for parts in budget["errors"].values():
        for part, error in parts.items():
            worst[part] = max(error, worst.get(part, 0))
    found = ", ".join(f"{percent(error)} {_PARTS[part]}" for part, error in worst.items())
    lights = "the given light" if budget["lights_given"] else f"{len(budget['lights'])} sets of lights"
    head = f"error {percent(budget['error'])}"
    if budget["reached"]:
        return f"{head}: kept, {found}, measured for {budget['material']} in {lights}"
    measured = f"{found}, measured for {budget['material']} in {lights}"
    vertices = f"all of its {budget['judged_vertices']:,} vertices"
    return f"warning: {head}: out of this mesh's reach: {vertices} have {measured}"


def _surface(budget: dict[str, Any]) -> str:
    text = f"surface: {budget['surface_vertices']:,} of {budget['mesh_vertices']:,} vertices"
    if budget["predicted_vertices"] is not None:
        text += f", {budget['predicted_vertices']:,.0f} were expected to do from coarser and finer levels"
    text += f"; the picture shows all {budget['mesh_vertices']:,}"
    if budget["judged_vertices"] < budget["mesh_vertices"]:
        text += f", of which {budget['judged_vertices']:,} stood for it: finer relief was not judged"
    finer = [t for t in budget["trials"] if t["surface_vertices"] > budget["surface_vertices"]]
    same = [t for t in finer if _alike(t, budget)]
    if same:
        best = min(same, key=worst)
        text += (
            f"; {best['surface_vertices']:,} would have {percent(worst(best))} for "
            f"{best['cost'] / budget['cost_bytes']:.1f} times the work"
        )
    return text


def _model(budget: dict[str, Any]) -> str:
    diffusion = percent(budget["diffusion_error"])
    if budget["model"] == "sp3":
        return f"model: sp3; diffusion is {diffusion} off on the finest surface tried"
    rows = [t for t in budget["trials"] if _alike(t, budget | {"model": "sp3"}) and worst(t) <= budget["error"]]
    text = f"model: diffusion instead of sp3, {diffusion} off on the finest surface tried"
    if rows:
        dearer = min(t["cost"] for t in rows) / budget["cost_bytes"]
        text += f"; the cheapest sp3 that keeps the error takes {dearer:.1f} times the work"
    return text


def _cycles(budget: dict[str, Any]) -> str:
    text = f"cycles: {budget['cycles']} on {len(budget['levels'])} levels of {_listed(budget['levels'])} vertices"
    more = [t for t in budget["trials"] if _of_file(t, budget) and _alike(t, budget) and t["cycles"] > budget["cycles"]]
    if more:
        best = min(more, key=worst)
        dearer = best["cost"] / budget["cost_bytes"]
        text += f"; {best['cycles']} would leave {percent(worst(best))} for {dearer:.1f} times the work"
    return text


def _sweeps(budget: dict[str, Any]) -> str:
    least = min((worst(t) for t in budget["trials"] if t["sweeps"] == 0), default=0)
    if budget["sweeps"]:
        return f"sweeps: {budget['sweeps']} of the transport equation; without any the least error was {percent(least)}"
    return "sweeps: none of the transport equation are needed"


def _truth(budget: dict[str, Any]) -> str:
    light = "light that meets the body again" if budget["inter_reflection"] else "nothing that enters again"
    return (
        f"measured against transport on {budget['swept_vertices']:,} vertices with {light}, "
        f"known to {percent(budget['truth_noise'])} (docs/accuracy.md)"
    )


def _listed(counts: list[int]) -> str:
    return ", ".join(f"{count:,}" for count in counts)


def _interior(budget: dict[str, Any]) -> str:
    share = budget["deep_share"]
    if share == 0:
        return "interior: all of it is within two diffusion lengths of the surface, and stays"
    return (
        f"interior: {percent(share)} of the vertices are deeper than two diffusion lengths and would hardly be missed; "
        "they stay, for a hollow shell is not baked"
    )


def _alike(trial: dict[str, Any], budget: dict[str, Any]) -> bool:
    """Whether it is of the model and the sweeps that were chosen."""
    return (trial["model"], trial["sweeps"]) == (budget["model"], budget["sweeps"])


def _of_file(trial: dict[str, Any], budget: dict[str, Any]) -> bool:
    """Whether it was measured on the file that was kept."""
    return (trial["surface_vertices"], trial["levels"]) == (budget["surface_vertices"], len(budget["levels"]))


def worst(trial: dict[str, Any]) -> float:
    return max(max(parts.values()) for parts in trial["errors"].values())
