"""Tables for people: what a solve did, and where the time went."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table

if TYPE_CHECKING:
    from quadgraph.core import Engine


def solve_table(report: dict) -> Table:
    """Return one row per level: unknowns, iterations, residual, converged."""
    table = Table(
        "level",
        "unknowns",
        "iterations",
        "residual",
        "converged",
        title=f"{report['method']} / {report['model']} / {report['source']} / {report['solver']}",
    )
    for level in report["levels"]:
        table.add_row(
            str(level["level"]),
            f"{level['unknowns']:,}",
            str(level["iterations"]),
            f"{level['residual']:.1e}",
            "yes" if level["converged"] else "no",
        )
    return table


def energy_table(report: dict) -> Table:
    """Return the power that entered, entered again with each bounce, left and was absorbed, per channel.

    Last the share of exitance that was clipped.
    """
    energy = report["energy"]
    table = Table("W", "R", "G", "B", title="energy")

    def add(name: str, power: tuple[float, float, float]) -> None:
        table.add_row(name, *(f"{value:.5g}" for value in power))

    add("entered", energy["entered"])
    if report["inter_reflection"]:
        add("entered again", energy["re_entered"])
    for number, bounce in enumerate(report["bounces"], 1):
        add(f"  bounce {number}", bounce)
    for name in ("scattered_out", "absorbed", "unscattered_out"):
        add(name.replace("_", " "), energy[name])
    table.add_row("balance", *(f"{100 * value:+.3f}%" for value in energy["balance"]))
    table.add_row("below zero, clipped", *(f"{100 * value:.3f}%" for value in report["clipped"]))
    return table


def inter_reflection_text(report: dict, wanted: bool) -> str:
    """Say whether inter-reflection was computed, and if not, why."""
    if report["inter_reflection"]:
        return f"inter-reflection: {len(report['bounces'])} bounces"
    if not wanted or report["source"] != "buried" or report["method"] not in ("fem", "quadgraph-fv"):
        return "inter-reflection: left out"
    return "inter-reflection: left out, the file does not say what the faces see (bake it again)"


def error_text(report: dict) -> str:
    """Estimated error of the exitance in words."""
    if report.get("path"):
        return "error: not estimated"
    parts = [f"solver {parts_text(report['algebraic'])}"]
    if report["correction"]:
        parts.append(f"model {parts_text(report['model_error'])}, after {correction_text(report['correction'])}")
    if report["light_error"]:
        parts.append(f"light {parts_text(report['light_error'])}")
    if report["phase_error"]:
        parts.append(f"phase function {parts_text(report['phase_error'])}")
    if report["error"] is None:
        return f"error: of the mesh not estimated (a single level); {'; '.join(parts)} (estimate)"
    parts.insert(0, f"mesh {parts_text(report['mesh_error'])}")
    without = "" if report["correction"] else ", without those of model and light"
    return f"error: {parts_text(report['error'])} (estimate{without}): {'; '.join(parts)}"


def correction_text(correction: dict) -> str:
    """What the transport correction did in words."""
    sweeps = correction["sweeps"]
    changes = ", ".join(f"{100 * sweep['change']['whole']:.2g}%" for sweep in sweeps)
    many = "1 sweep of the transport equation that" if len(sweeps) == 1 else f"{len(sweeps)} sweeps that"
    return (
        f"{many} changed the exitance by {changes}, with {100 * sweeps[-1]['noise']['whole']:.2g}% of noise; "
        f"{correction['segments'] / 1e6:.3g} million ray segments"
    )


def certificate_texts(found: dict) -> list[str]:
    """Say what random walks measured, and where that contradicts the estimate."""

    def of(part: dict) -> str:
        percent = {name: 100 * share for name, share in part.items()}
        power = f"power {percent['power']:+.2g} ± {percent['power_noise']:.2g}%"
        return f"{percent['error']:.2g} ± {percent['error_noise']:.2g}% ({power})"

    names = {"whole": "whole", "unlit": "unlit", "dimmest": "dimmest third"}
    parts = ", ".join(f"{name} {of(found[part])}" for part, name in names.items() if found[part]["power_noise"] > 0)
    against = [f"warning: {found['disagreement']}"] if found["disagreement"] else []
    kind = "guided" if found["guided"] else "random"
    walks = f"{found['walks'] / 1e6:.2g} million {kind} walks in {found['seconds']:.1f} s"
    return [*against, f"error measured by {walks}: {parts}"]


def step_text(step: dict) -> str:
    """One step of a picture that converges in words."""
    solves = "1 solve" if step["solves"] == 1 else f"{step['solves']} solves"
    sweeps = "1 sweep" if step["sweeps"] == 1 else f"{step['sweeps']} sweeps"
    noise = f", of that noise {100 * step['noise']:.2g}%" if step["noise"] > 0 else ""
    error = f"error {100 * step['error']['whole']:.2g}%{noise}"
    return f"{solves} of {sweeps}, {step['samples']} samples a pixel: {error}, {step['seconds']:.1f} s"


def convergence_texts(found: dict) -> list[str]:
    """Say what a picture is the mean of, and why it did not reach the error that was asked for."""
    against = [] if found["reached"] else [f"warning: converge {100 * found['wanted']:.2g}%: {found['limit']}"]
    return [f"mean of {step_text(found['steps'][-1])}", *against]


def parts_text(error: dict | None) -> str:
    """Return the error over the whole surface, its unlit part and its dimmest third in words."""
    if error is None:
        return "unknown"
    of_unlit = f"{100 * error['unlit']:.2g}% unlit" if error["unlit"] > 0 else "nothing unlit"
    of_dimmest = f", {100 * error['dimmest']:.2g}% dimmest third" if error["dimmest"] > 0 else ""
    return f"{100 * error['whole']:.2g}% whole, {of_unlit}{of_dimmest}"


def path_text(path: dict) -> str:
    """What the shortest-path method did in words."""
    size = " x ".join(map(str, path["size"]))
    return (
        f"paths: {path['solver']}, cost {path['cost']}, through {path['solid']:,} voxels of {path['cell']:.3g} mm "
        f"({size}), {path['lit']:,} of them lit, {path['rounds']} rounds"
    )


def solver_texts(report: dict) -> list[str]:
    """Say what a picture is off by, what the bake knows of the error, which solver took another one's place, what warns
    of the answer, whether it did not converge, and where it stopped if not on the finest level.
    """
    picture = report.get("picture_error")
    texts = [f"error of the picture: {parts_text(picture)} (estimate)"] if picture else []
    texts += convergence_texts(report["convergence"]) if report.get("convergence") else []
    texts += certificate_texts(report["certificate"]) if report.get("certificate") else []
    texts += [report["budget"]] if report["budget"] else []
    texts += [path_text(report["path"])] if report.get("path") else []
    if report["replaced"]:
        texts.append(f"solver: {report['replaced']}")
    warnings = [f"{name}_warning" for name in ("mesh", "model", "size", "phase", "light")]
    against = ("missed", "advice", *warnings, "deformed")
    texts += [f"warning: {report[name]}" for name in against if report.get(name)]
    if report["stopped"]:
        texts.append(f"failed: {report['stopped']}")
    if report["finest"] > 0:
        texts.append(f"level: {report['finest']} suffices; its solution is carried to the finest")
    return texts


def size_text(engine: Engine) -> str:
    """Nodes, levels and device memory in words."""
    levels = engine.graph.levels
    memory = f"memory: {engine.peak_device_bytes / 1e6:.0f} MB on {engine.device_name}"
    if not levels:
        return f"surface: {len(engine.graph.display['triangles']):,} triangles, no levels, {memory}"
    return f"nodes: {len(levels[0].nodes):,} (finest of {len(levels)} levels), tets: {len(levels[0].tets):,}, {memory}"
