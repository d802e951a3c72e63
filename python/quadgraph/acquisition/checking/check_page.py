"""What a check of a capture found as one HTML file that needs nothing else."""

from __future__ import annotations

import html
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from quadgraph.acquisition.cameras.placed_body import FLAT, PlacedBody
from quadgraph.acquisition.checking import plan_drawings
from quadgraph.acquisition.checking.capture_check import Checked, JudgedPhotograph
from quadgraph.acquisition.page_parts import figure, srgb
from quadgraph.base.atomic_file import replacing

_WHITE = 0.995  # quantile of what counts of a photograph, that is shown as white
_OUTLINE, _NOT_COUNTED = (255, 140, 0), (90, 60, 160)
_SIDE = 150  # pixels of the pictures of the body
_MOST = 6  # photographs, from which on a place has the last colour
_COLOURS = np.array(
    [[60, 60, 66], [68, 57, 131], [49, 104, 142], [33, 145, 140], [53, 183, 121], [144, 215, 67], [253, 231, 37]], float
)
_STYLE = """
:root { color-scheme: light dark; --ink: #1d2430; --paper: #f6f7f9; --card: #fff; --line: #d9dee5; --soft: #5d6875;
  --fine: #1e8449; --poor: #b9770e; --wrong: #c0392b; --eye: #2471a3; --lamp: #d4a017; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e9ee; --paper: #14171c; --card: #1d2229; --line: #343b45;
  --soft: #9aa5b1; --fine: #58d68d; --poor: #f0b429; --wrong: #ff7b6b; --eye: #6cb6ea; --lamp: #f2cf63; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
main { max-width: 72rem; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.6rem; margin: 0 0 .25rem; } h2 { font-size: 1.15rem; margin: 2.25rem 0 .75rem; }
p { margin: .25rem 0; } .soft { color: var(--soft); }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(10rem, 1fr)); gap: .75rem; margin: 1.25rem 0; }
.tile, .card { background: var(--card); border: 1px solid var(--line); border-radius: .6rem; padding: .8rem 1rem; }
.tile b { display: block; font-size: 1.5rem; line-height: 1.2; font-variant-numeric: tabular-nums; }
.said { border-left: 4px solid var(--poor); padding: .1rem 0 .1rem .8rem; margin: .5rem 0; }
.said.wrong { border-color: var(--wrong); }
.badge { border-radius: 1rem; padding: .1rem .7rem; color: #fff; font-size: 13px; white-space: nowrap; }
.badge.fine { background: #1e8449; } .badge.poor { background: #b9770e; } .badge.wrong { background: #c0392b; }
.row { display: flex; flex-wrap: wrap; gap: .75rem; } .row .card { flex: 0 1 auto; }
.shots { display: grid; grid-template-columns: repeat(auto-fill, minmax(20rem, 1fr)); gap: .9rem; }
.shots .head { display: flex; justify-content: space-between; gap: .5rem; align-items: baseline; }
.shots .row { flex-wrap: nowrap; align-items: flex-start; }
figure { margin: .5rem 0 0; } figcaption { font-size: 12.5px; color: var(--soft); }
img { width: 150px; display: block; background: #000; border-radius: .3rem; }
.covered img { width: 138px; }
svg { display: block; max-width: 100%; height: auto; } svg text { fill: var(--soft); font: 11px system-ui, sans-serif; }
dl { display: grid; grid-template-columns: auto 1fr; gap: 0 .8rem; margin: .5rem 0 0; font-size: 13.5px; }
dt { color: var(--soft); } dd { margin: 0; font-variant-numeric: tabular-nums; }
.key span { display: inline-block; width: 1.1rem; height: .8rem; margin: 0 .25rem 0 .7rem; border-radius: .15rem;
  vertical-align: middle; }
"""


def write(path: Path, checked: Checked) -> None:
    """Write the page. Raises InputError if it cannot be written."""
    with replacing(path) as stream:
        stream.write(page(checked).encode())


def page(checked: Checked) -> str:
    """The whole document; the same capture makes the same page."""
    name = html.escape(checked.capture.path.name)
    kind, verdict = ("wrong", "cannot be used") if checked.unusable else ("fine", "can be used")
    if kind == "fine" and checked.doubts():
        kind, verdict = "poor", "can be used; look at what is said"
    body = [f'<h1>{name} <span class="badge {kind}">{verdict}</span></h1>']
    body.append(f'<p class="soft">{len(checked.judged)} photographs of {html.escape(checked.capture.body.name)}</p>')
    body += [_tiles(checked), *_said(checked)]
    body += ["<h2>Where cameras and lights are</h2>", '<div class="row">', *plan_drawings.plans(checked), "</div>"]
    body += [f"<p><b>{html.escape(name)}</b>: {html.escape(lamp.line())}</p>" for name, lamp in checked.lamps().items()]
    body += [f"<p><b>pose</b>: {html.escape(checked.pose.line())}</p>"] if checked.pose else []
    body += ["<h2>What of the surface is covered</h2>", _covered(checked)]
    body += [
        "<h2>Photographs</h2>",
        _legend(),
        '<div class="shots">',
        *(_shot(each) for each in checked.judged),
        "</div>",
    ]
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{name}</title>'
    head = f"<head>{head}<style>{_STYLE}</style></head>"
    return f'<!doctype html>\n<html lang="en">{head}\n<body><main>{"".join(body)}</main></body></html>\n'


def _tiles(checked: Checked) -> str:
    told = [each.imported.reprojection for each in checked.judged if each.imported]
    errors = [error for error in told if error is not None]
    tiles = [
        (f"{np.median(errors):.2f} px" if errors else "none", "reprojection error, median of the photographs"),
        (f"{max(errors):.2f} px" if errors else "none", "of the worst one"),
        (f"{checked.seen:.0%}", "of the surface seen"),
        (f"{checked.used:.0%}", "seen and lit in one photograph"),
        (f"{checked.widest:.0f}°", "between the two cameras furthest apart"),
        (f"{min((each.counts for each in checked.judged), default=0):.0%}", "of the body counts where least does"),
    ]
    cells = "".join(f'<div class="tile"><b>{value}</b><span class="soft">{what}</span></div>' for value, what in tiles)
    return f'<div class="tiles">{cells}</div><p>Scale: {html.escape(checked.scale())}.</p>'


def _said(checked: Checked) -> Iterator[str]:
    for text in checked.reasons():
        yield f'<p class="said wrong">Cannot be used: {html.escape(text)}</p>'
    for text in checked.doubts():
        yield f'<p class="said">{html.escape(text)}</p>'


def _legend() -> str:
    return (
        '<p class="soft">Each as the capture has it, with the outline of the body in orange, which should lie on it, '
        "and what does not count in violet; beside it how far the board's corners lie off, 100 times as large.</p>"
    )


def _shot(one: JudgedPhotograph) -> str:
    stated = one.measured.stated
    kind = {"fine": "fine", "unusable": "wrong"}.get(one.verdict, "poor")
    head = f"<b>{html.escape(stated.path)}</b><span class='badge {kind}'>{one.verdict}</span>"
    rows = [
        ("file", stated.file.name),
        ("lights", ", ".join(stated.lights)),
        ("body", f"{one.body:.0%} of the picture"),
    ]
    rows += [("counts", f"{one.counts:.0%} of the body"), ("signal", f"{one.signal:.0f} standard deviations")]
    if one.brightness is not None:
        rows.append(("brightness", f"{one.brightness:.2f} of the others"))
    if one.imported is not None and one.imported.reprojection is not None:
        rows.append(("corners", f"{len(one.imported.corners)}, {one.imported.reprojection:.3f} px off (RMS)"))
        rows.append(("moved", f"{one.imported.moved:.2f} px between exposures"))
    listed = "".join(f"<dt>{name}</dt><dd>{html.escape(value)}</dd>" for name, value in rows)
    said = "".join(
        f'<p class="said {"wrong" if text in one.wrong else ""}">{html.escape(text)}</p>'
        for text in [*one.wrong, *one.poor]
    )
    picture = figure(_picture(one), "the body in it", stated.file.name)
    corners = plan_drawings.corners(one.imported) if one.imported is not None else ""
    shown = f'<div class="head">{head}</div><div class="row">{picture}{corners}</div>'
    return f'<div class="card">{shown}<dl>{listed}</dl>{said}</div>'


def _picture(one: JudgedPhotograph) -> np.ndarray:
    """(h, w, 3) bytes: the photograph, what does not count, and the outline of the body."""
    counts = one.measured.usable.all(axis=2)
    values = one.measured.values
    white = float(np.quantile(values[counts], _WHITE)) if counts.any() else 1.0
    picture = srgb(values / (white or 1.0))
    picture[~counts] = (picture[~counts] // 2 + np.array(_NOT_COUNTED) // 2).astype(np.uint8)
    thick = one.outline.copy()
    for step in range(1, max(picture.shape[0] // 160, 1)):
        thick |= np.roll(one.outline, step, 0) | np.roll(one.outline, step, 1)
    picture[thick] = _OUTLINE
    return picture


def _covered(checked: Checked) -> str:
    """The body from six sides, coloured by how many photographs see each place lit."""
    key = "".join(
        f'<span style="background:rgb{tuple(int(x) for x in colour)}"></span>{number}{"+" if number == _MOST else ""}'
        for number, colour in enumerate(_COLOURS)
    )
    parts = [f'<p class="soft key">photographs that see a place lit:{key}</p><div class="row covered">']
    for axis in range(3):
        for sign in (1.0, -1.0):
            name = f"{'+' if sign > 0 else '-'}{'xyz'[axis]}"
            picture = _from_side(checked, axis, sign)
            parts.append(f'<div class="card">{figure(picture, f"from {name}", "the body")}</div>')
    return "".join(parts) + "</div>"


def _from_side(checked: Checked, axis: int, sign: float) -> np.ndarray:
    body = checked.body
    towards = np.zeros(3)
    towards[axis] = -sign
    up = np.array([0.0, 0, 1]) if axis != 2 else np.array([0.0, 1, 0])
    right = np.cross(towards, up)
    steps = (np.arange(_SIDE) + 0.5) / _SIDE * 2 - 1
    across, down = np.meshgrid(steps * body.radius, steps * body.radius)
    origins = body.middle - 3 * body.radius * towards + across[..., None] * right - down[..., None] * up
    origins = origins.reshape(-1, 3)
    triangles, places = body.hit(origins, np.broadcast_to(towards, origins.shape))
    met = triangles >= 0
    picture = np.full((len(origins), 3), 24.0)
    if met.any():
        counts = _counts(checked, body, places[met], triangles[met])
        shade = 0.45 + 0.55 * np.abs(body.normals[triangles[met]] @ towards)
        picture[met] = _COLOURS[np.minimum(counts, _MOST)] * shade[:, None]
    return picture.reshape(_SIDE, _SIDE, 3).astype(np.uint8)


def _counts(checked: Checked, body: PlacedBody, places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(n,) how many photographs see places lit."""
    lit = {name: body.lit_by(places, triangles, light) > FLAT for name, light in checked.capture.lights.items()}
    counts = np.zeros(len(places), int)
    for each in checked.judged:
        if each.view is not None:
            lights = np.any([lit[name] for name in each.measured.stated.lights], axis=0)
            counts += lights & (body.cosine_to(places, triangles, each.view.eye) > FLAT)
    return counts
