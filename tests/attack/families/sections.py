"""Sealed `.qgraph` files whose sections contradict each other or are not those that a bake writes."""

from __future__ import annotations

from typing import Any

import numpy as np

from attack import texts
from attack.case import Case, Outcome, Place
from attack.families.sealed import BODY, INFO, Sections, changed, commands
from attack.physics import PICTURED, SOLVE_OUTPUTS, SOLVED, pictured_as, solve, solved, solved_as
from attack.texts import Rng

RENDER = ("quadgraph", "render", "body.qgraph", "-o", "out.png", *PICTURED)
FV = ("--method", "quadgraph-fv", *SOLVED)
NODES = 0.05  # what quadgraph-fv, which has nodes alone, may be off


def _shuffled(array: np.ndarray, draw: int, share: float = 1.0) -> None:
    """Exchange rows of an array with each other."""
    generator = np.random.default_rng(draw)
    rows = generator.permutation(len(array))[: max(2, int(share * len(array)))]
    array[rows] = array[generator.permutation(rows)]


def display_vertices(rng: Rng) -> Case:
    """Vertices of the displayed mesh that lie elsewhere."""
    kind = texts.pick(rng, ["one far", "one point", "shuffled", "scaled", "moved", "noise"])
    draw, size = int(rng.integers(2**31)), float(10 ** rng.uniform(-3, 3))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        vertices = sections["display/vertices"]
        if kind == "one far":
            vertices[draw % len(vertices), draw % 3] = np.float32(10 ** (30 * np.random.default_rng(draw).random()))
        elif kind == "one point":
            vertices[:] = vertices[draw % len(vertices)]
        elif kind == "shuffled":
            _shuffled(vertices, draw)
        elif kind == "scaled":
            vertices *= 1 + size
        else:
            shape = (1, 3) if kind == "moved" else vertices.shape
            vertices += np.random.default_rng(draw).normal(size=shape).astype("f4") * np.float32(size)

    name = f"display vertices {kind} {draw} {size:.3g}"
    return Case(name, RENDER, BODY, changed(change), ("out.png",), judge=pictured_as("ring"))


def display_normals(rng: Rng) -> Case:
    """Normals of the displayed mesh turned, lengthened or gone."""
    kind = texts.pick(rng, ["inwards", "zero", "long", "random", "one", "shuffled"])
    draw = int(rng.integers(2**31))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        normals = sections["display/normals"]
        generator = np.random.default_rng(draw)
        if kind == "shuffled":
            _shuffled(normals, draw)
        elif kind == "random":
            normals[:] = generator.normal(size=normals.shape)
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        elif kind == "one":
            normals[draw % len(normals)] *= -1
        else:
            normals *= np.float32({"inwards": -1, "zero": 0, "long": 10 ** generator.uniform(0.1, 30)}[kind])

    return Case(
        f"display normals {kind} {draw}", RENDER, BODY, changed(change), ("out.png",), judge=pictured_as("ring")
    )


def display_maps(rng: Rng) -> Case:
    """Triangles of the displayed mesh and what ties it to the faces."""
    kind = texts.pick(rng, ["inside out", "triangles", "face zero", "face shuffled", "barycentric", "one face"])
    draw = int(rng.integers(2**31))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        if kind == "inside out":
            sections["display/triangles"] = np.ascontiguousarray(sections["display/triangles"][:, ::-1])
        elif kind == "triangles":
            _shuffled(sections["display/triangles"].reshape(-1), draw)
        elif kind == "face shuffled":
            _shuffled(sections["display/face"], draw)
        elif kind == "barycentric":
            _shuffled(sections["display/barycentric"], draw)
        else:
            sections["display/face"][slice(None) if kind == "face zero" else draw % 100] = 0

    return Case(f"display {kind} {draw}", RENDER, BODY, changed(change), ("out.png",), judge=pictured_as("ring"))


def nodes(rng: Rng) -> Case:
    """Nodes that lie elsewhere than in their tets and on their faces."""
    kind, level = texts.pick(rng, ["zero", "moved", "shuffled", "noise", "two"]), int(rng.integers(2))
    draw, size = int(rng.integers(2**31)), float(10 ** rng.uniform(-6, 1.5))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        array = sections[f"level{level}/nodes"]
        if kind in ("shuffled", "two"):
            _shuffled(array, draw, 1.0 if kind == "shuffled" else 0.0)
        elif kind == "zero":
            array[:] = 0
        else:
            shape = (1, 3) if kind == "moved" else array.shape
            array += (np.random.default_rng(draw).normal(size=shape) * size).astype("f4")

    name = f"nodes of level {level} {kind} {draw} {size:.3g} mm"
    judge = solved_as("ring", FV, NODES)
    return Case(name, solve("body.qgraph", *FV), BODY, changed(change), SOLVE_OUTPUTS, judge=judge)


def links(rng: Rng) -> Case:
    """Links in another order, or to others."""
    kind, level = texts.pick(rng, ["inner order", "rows", "one", "face_tets"]), int(rng.integers(2))
    draw = int(rng.integers(2**31))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        array = sections[f"level{level}/links"]
        row = draw % len(array)
        if kind == "inner order":
            array[row] = np.roll(array[row], 1 + draw % 3)
        elif kind == "rows":
            _shuffled(array, draw, 0.1)
        elif kind == "one":
            array[row, draw % 4] = (draw // 4) % len(array)
        else:
            _shuffled(sections[f"level{level}/face_tets"], draw)

    command, outputs = commands(rng)
    judge = solved_as("ring") if command[1] == "solve" else lambda place, outcome: ""
    return Case(f"{command[1]}, links {kind} {draw}", command, BODY, changed(change), outputs, judge=judge)


def seen(rng: Rng) -> Case:
    """Rows of what faces see that name others, or none, or rays without number."""
    kind = texts.pick(rng, ["others", "none", "rays", "some", "counts"])
    draw, share = int(rng.integers(2**31)), float(rng.uniform(0.01, 0.5))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        table, rays = sections["level0/seen"], sections["level0/seen_rays"]
        count = int(table[0]) - 1
        generator = np.random.default_rng(draw)
        if kind == "rays":
            rays[0] = int(10 ** generator.uniform(2, 9))
        elif kind == "none":
            sections["level0/seen"] = np.full(count + 1, count + 1, "<u4")
        elif kind == "counts":
            table[1 : count + 1] = np.sort(generator.integers(count + 1, len(table) + 1, count))
        else:
            for face in generator.permutation(count)[: count if kind == "others" else max(1, int(share * count))]:
                row = slice(int(table[face]), int(table[face + 1]))
                values = generator.integers(0, count, row.stop - row.start)
                values[values == face] = (face + 1) % count
                table[row] = np.sort(values)

    name = f"seen {kind} {draw} {share:.2f}"
    return Case(name, solve(), BODY, changed(change), SOLVE_OUTPUTS, judge=solved_as("ring"))


def scaled(rng: Rng) -> Case:
    """A body of any size: all lengths by one factor, which is right, or refused."""
    power = float(rng.uniform(-32, 32)) if rng.integers(2) else float(rng.uniform(-6, 6))
    factor = 10.0**power

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        with np.errstate(over="ignore", under="ignore"):
            for name in ("level0/vertices", "level0/nodes", "level1/vertices", "level1/nodes", "display/vertices"):
                sections[name] = (sections[name] * np.float64(factor)).astype("<f4")
        for level in metadata["levels"]:
            level["volume_mm3"] *= factor**3
            level["area_mm2"] *= factor**2

    return Case(f"lengths by 1e{power:.2f}", solve(), BODY, changed(change), SOLVE_OUTPUTS, judge=solved())


def transfers(rng: Rng) -> Case:
    """Weights and indices between levels in another order: the answer is that of the finest level."""
    kind = texts.pick(rng, ["inner", "surface", "barycentric"])
    part, draw = texts.pick(rng, ["index", "weight"]), int(rng.integers(2**31))
    share = float(rng.uniform(0, 1))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        _shuffled(sections[f"level0/{kind}_{part}"], draw, share)

    name = f"{kind}_{part} shuffled {draw} {share:.2f}"
    return Case(name, solve(), BODY, changed(change), SOLVE_OUTPUTS, judge=solved_as("ring"))


BITS = (0x7FC00000, 0x7F800000, 0xFF800000, 0x7F7FFFFF, 0x80000000, 0x00000001, 0xFFFFFFFF, 0x7FFFFFFF)


def one_number(rng: Rng) -> Case:
    """A number of any section replaced: NaN, infinite, huge, out of range, or its neighbour's."""
    draw, bits = int(rng.integers(2**31)), texts.pick(rng, [*BITS, None, None])

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        names = sorted(name for name in sections if name != "metadata")
        flat = sections[names[draw % len(names)]].reshape(-1)
        spot = draw // 64 % len(flat)
        if bits is None:
            flat[spot] = flat[(spot + 1) % len(flat)]
        else:
            flat.view("<u4")[spot] = bits

    judge = solved_as("ring", allowed=0.03)
    return Case(f"number {draw} is {bits}", solve(), BODY, changed(change), SOLVE_OUTPUTS, judge=judge)


def other_sections(rng: Rng) -> Case:
    """A section missing, foreign, of another type, or longer."""
    kind, draw = texts.pick(rng, ["missing", "foreign", "type", "longer", "no levels", "cut"]), int(rng.integers(2**31))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        names = [name for name in sections if name != "metadata"]
        name = names[draw % len(names)]
        if kind == "missing":
            del sections[name]
        elif kind == "foreign":
            sections[f"level{draw % 40}/foreign"] = np.zeros(3, "<f4")
        elif kind == "type":
            array = sections[name]
            sections[name] = array.view("<u4" if array.dtype == np.float32 else "<f4")
        elif kind == "longer":
            sections[name] = np.concatenate([sections[name], sections[name][-1:]])
        elif kind == "cut":
            sections[name] = np.ascontiguousarray(sections[name][: max(1, len(sections[name]) // 2)])
        else:
            for name in [name for name in sections if name.startswith("level0")]:
                del sections[name]

    command, outputs = commands(rng)
    return Case(f"{command[1]}, section {draw} {kind}", command, BODY, changed(change), outputs, expect="refused")


def order(rng: Rng) -> Case:
    """Triangles turned round, tets turned inside out."""
    level, kind, draw = int(rng.integers(2)), texts.pick(rng, ["faces", "tets", "rolled"]), int(rng.integers(2**31))

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        array = sections[f"level{level}/{'tets' if kind == 'tets' else 'faces'}"]
        row = draw % len(array)
        array[row] = np.roll(array[row], 1) if kind == "rolled" else array[row][[1, 0, *range(2, array.shape[1])]]

    # With the corners of a face of level 0, those are others that weights of the display mesh name.
    expect = "" if level or kind == "rolled" else "refused"
    judge = solved_as("ring", allowed=0.03)
    name = f"level {level} {kind} {draw}"
    return Case(name, solve(), BODY, changed(change), SOLVE_OUTPUTS, judge=judge, expect=expect)


def polygrids(rng: Rng) -> Case:
    """Links of a polygrid that lead elsewhere."""
    draw, kind = int(rng.integers(2**31)), texts.pick(rng, ["shuffled", "one", "self"])

    def change(metadata: dict[str, Any], sections: Sections) -> None:
        array = sections[f"level{draw % 2}/grid_links"]
        row = draw % len(array)
        if kind == "shuffled":
            _shuffled(array, draw)
        else:
            array[row, draw % 6] = row if kind == "self" else draw // 6 % len(array)

    options = ("--method", "polygrid", *SOLVED)
    command = texts.pick(rng, [solve("body.qgraph", *options), INFO])
    outputs = SOLVE_OUTPUTS if command[1] == "solve" else ()

    def judge(place: Place, outcome: Outcome) -> str:
        return solved_as("polygrid", options, NODES)(place, outcome) if command[1] == "solve" else ""

    name = f"{command[1]}, grid_links {kind} {draw}"
    return Case(name, command, BODY, changed(change, "polygrid"), outputs, judge=judge)


RECIPES = (
    display_vertices,
    display_normals,
    display_maps,
    nodes,
    links,
    seen,
    scaled,
    transfers,
    one_number,
    other_sections,
    order,
    polygrids,
)
