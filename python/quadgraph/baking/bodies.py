"""Several mesh files into one `.qgraph` file, each a body of its own with a name (docs/bodies.md)."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.baking import pipeline
from quadgraph.baking.embedding import Embedded
from quadgraph.baking.pipeline import BakeOptions, Level, Prepared
from quadgraph.baking.placing import BodyPlacement, hosts_of
from quadgraph.baking.report import BakeReport
from quadgraph.base import outputs
from quadgraph.base.errors import InputError, ToolError
from quadgraph.base.progress import ProgressCallback
from quadgraph.file import joined, sections
from quadgraph.mesh import front, mesh_io, mesh_size, named_parts
from quadgraph.mesh.surface import FileFrame, SourceMesh, Surface, joined_surface
from quadgraph.tets import exchange, ordering
from quadgraph.tets.graph import Graph
from quadgraph.tets.tet_geometry import determinants

MOST_NAME_BYTES = 64
LEAST_VERTICES = 4  # of a surface: a tetrahedron's
_NAME_MARKS = "=/~"  # at which command lines and paths into scenes would split a name


@dataclass(frozen=True)
class BodyMesh:
    """A mesh file as one of several bodies.

    name: 1 to 64 bytes without control characters, "=", "/" and "~"; unit, height_mm, longest_mm, up and wrap: as of
    BakeOptions; part: of the file, by its name (`quadgraph.mesh.named_parts`), at the size of the whole file;
    surface_vertices: of this body, None for what BakeOptions say of all; normals: as of BakeOptions.
    """

    name: str
    mesh: Path
    placement: BodyPlacement = field(default_factory=BodyPlacement)
    unit: str | None = None
    height_mm: float | None = None
    longest_mm: float | None = None
    up: str = "y"
    wrap: float | str | None = None
    part: str | None = None
    surface_vertices: int | None = None
    normals: str = "file"


def bake_bodies(
    bodies: Sequence[BodyMesh], output: str | Path, options: BakeOptions, progress: ProgressCallback | None = None
) -> BakeReport:
    """Bake meshes into one file of several bodies, and report.

    options: of each body alike, `surface_vertices` of each by itself; size, `up`, `wrap` and `normals` are those of the
    bodies. A body that lies wholly within another's solid shares its surface with it; the report says so. Raises
    InputError for unusable input or options, and for bodies that cut or touch each other, which it names; ToolError as
    `pipeline.bake`. `output` is written last and at once.
    """
    tell = progress or (lambda text: None)
    check(bodies, options)
    pipeline.check_options(Path(output), options)
    outputs.check_outputs([Path(output)], [body.mesh for body in bodies])
    report, start = BakeReport(str(output)), time.perf_counter()
    prepared = [_prepared(body, options, report, tell) for body in bodies]
    with report.timed("keep apart"):
        hosts = hosts_of([each.surface for each in prepared], [body.name for body in bodies])
    report.notes += [
        f"{body.name}: lies within {bodies[host].name} and shares its surface with it, with no air between"
        for body, host in zip(bodies, hosts, strict=True)
        if host is not None
    ]
    solids = []
    for numbers in _solids(hosts):
        first = bodies[numbers[0]]
        shapes = [
            Embedded(bodies[n].name, prepared[n].surface, bodies[n].surface_vertices or options.surface_vertices)
            for n in numbers
        ]
        with _reporting(first, report) as of_body:
            own = replace(options, surface_vertices=shapes[0].surface_vertices)
            told = _telling(first, tell)
            levels = pipeline.make_levels(shapes[0].surface, own, of_body, told, shapes[1:])
        solids.append(_Solid(numbers, levels))
    _write(bodies, prepared, solids, hosts, options, report)
    report.seconds["total"] = time.perf_counter() - start
    return report


def check(bodies: Sequence[BodyMesh], options: BakeOptions) -> None:
    """Raise InputError for names, places and options that a file of several bodies cannot have."""
    if not 1 <= len(bodies) <= joined.MOST_BODIES:
        raise InputError(f"bodies: {len(bodies)} found, allowed are 1 to {joined.MOST_BODIES}")
    names: set[str] = set()
    for number, body in enumerate(bodies):
        check_name(body.name, f"bodies/{number}/name")
        if body.name in names:
            raise InputError(f"bodies/{number}/name: '{body.name}' found twice, each body has a name of its own")
        names.add(body.name)
        body.placement.check(f"bodies/{number}/")
        if body.surface_vertices is not None and body.surface_vertices < LEAST_VERTICES:
            raise InputError(f"bodies/{number}/surface_vertices: {body.surface_vertices} found, allowed are "
                             f"{LEAST_VERTICES} and more")  # fmt: skip
    if options.mesher == "polygrid":
        raise InputError("mesher: 'polygrid' found with several bodies, allowed are 'tetgen' and 'cgal'")


def check_name(name: str, where: str) -> None:
    """Raise InputError that begins with `where` unless a body can have that name (engine/file/body_names.h)."""
    marks = [mark for mark in name if mark in _NAME_MARKS or not mark.isprintable()]
    if not 1 <= len(name.encode(errors="replace")) <= MOST_NAME_BYTES or marks:
        raise InputError(
            f"{where}: {name[:80]!r} found, 1 to {MOST_NAME_BYTES} bytes are wanted, without "
            f"{', '.join(_NAME_MARKS)} and control characters"
        )


def meshes_as_they_lie(meshes: Sequence[Path], options: BakeOptions) -> list[BodyMesh]:
    """Bodies of files that share their coordinates, named as their files are.

    The size that the options say, or the usual one, is that of all together. Raises InputError.
    """
    read = [mesh_io.read_surface(mesh, unit="mm", up=options.up) for mesh in meshes]
    used = np.concatenate([each.surface.vertices[np.unique(each.surface.triangles)] for each in read])
    scale, _ = mesh_size.scale_of(meshes[0], used, options.unit, options.height_mm, options.longest_mm)
    placement = BodyPlacement(scale=scale)
    own = {name: getattr(options, name) for name in ("up", "wrap", "normals")}
    return [BodyMesh(mesh.stem, mesh, placement, "mm", **own) for mesh in meshes]


def parts_as_bodies(mesh: Path, options: BakeOptions) -> list[BodyMesh]:
    """The parts of a file that names some, as bodies where they lie. Raises InputError, also for one part alone."""
    read = mesh_io.read_surface(mesh, unit="mm", up=options.up)  # complains of all that is wrong
    found = sorted(set(named_parts.names(mesh).tolist()))
    if len(found) < 2:
        raise InputError(f"{mesh}: parts: one found, {found[0]!r}, of {read.triangles:,} triangles; leave them out")
    sizes = {name: getattr(options, name) for name in ("unit", "height_mm", "longest_mm", "up", "wrap", "normals")}
    return [BodyMesh(name, mesh, part=name, **sizes) for name in found]


@dataclass(frozen=True)
class _Solid:
    """What has no air within: numbers of a body and of those within it, which the graphs of its levels count so."""

    numbers: list[int]
    levels: list[Level]


def _solids(hosts: Sequence[int | None]) -> list[list[int]]:
    """Of each outermost body its number, and then those of all that lie within it."""

    def outermost(number: int) -> int:
        host = hosts[number]
        return number if host is None else outermost(host)

    solids: dict[int, list[int]] = {number: [number] for number, host in enumerate(hosts) if host is None}
    for number, host in enumerate(hosts):
        if host is not None:
            solids[outermost(number)].append(number)
    return list(solids.values())


def _telling(body: BodyMesh, tell: ProgressCallback) -> ProgressCallback:
    return lambda text: tell(f"{body.name}: {text}")


@contextmanager
def _reporting(body: BodyMesh, report: BakeReport) -> Iterator[BakeReport]:
    """A report of one body, which goes into that of all, and errors that begin with its name."""
    of_body = BakeReport(report.output)
    try:
        yield of_body
    except (InputError, ToolError) as error:
        raise type(error)(f"{body.name}: {error}") from error
    for stage, seconds in of_body.seconds.items():
        report.seconds[stage] = report.seconds.get(stage, 0.0) + seconds
    report.notes += [f"{body.name}: {note}" for note in of_body.notes]


def _prepared(body: BodyMesh, options: BakeOptions, report: BakeReport, tell: ProgressCallback) -> Prepared:
    """The surface of a body where it is to lie."""
    own = replace(
        options,
        unit=body.unit,
        height_mm=body.height_mm,
        longest_mm=body.longest_mm,
        up=body.up,
        wrap=body.wrap,
        normals=body.normals,
        front=0.0,
    )
    with _reporting(body, report) as of_body:
        made = pipeline.prepare(body.mesh, own, of_body, _telling(body, tell), body.part)
    placed = body.placement
    if made.normals.texture is not None:
        report.notes.append(f"{body.name}: a file of several bodies keeps no normal texture; its own is left out")
        made = replace(made, normals=replace(made.normals, texture=None))
    return replace(made, surface=placed.of(made.surface), normals=made.normals.turned(placed.turned))


def _write(
    bodies: Sequence[BodyMesh],
    prepared: Sequence[Prepared],
    solids: Sequence[_Solid],
    hosts: Sequence[int | None],
    options: BakeOptions,
    report: BakeReport,
) -> None:
    with report.timed("surface"):
        outer = [pipeline.shown(prepared[solid.numbers[0]], options) for solid in solids]
    with report.timed("transfers"):
        parts = [
            sections.whole_file([level.graph for level in solid.levels], each.surface, normals=each.normals)
            for each, solid in zip(outer, solids, strict=True)
        ]
        content = joined.join(parts, [solid.numbers for solid in solids])
    graphs = joined.graphs(content)
    with report.timed("exchange"):
        seen = exchange.bake(graphs, options.visibility_rays)
    if seen is not None:
        report.exchange = exchange.summary(seen, graphs[seen.level].boundary)
    levels = [
        _joined_level(graph, [solid.levels[min(number, len(solid.levels) - 1)] for solid in solids])
        for number, graph in enumerate(graphs)
    ]
    whole = _whole(bodies, prepared, joined_surface([each.surface for each in outer]), options)
    finest = content["level0/tet_bodies"]
    volumes = determinants(graphs[0].vertices, graphs[0].tets) / 6
    tets, volume = np.bincount(finest), np.bincount(finest, volumes)
    within = [{} if host is None else {"within": bodies[host].name} for host in hosts]
    more = {
        "bodies": [
            _metadata(body, each) | {"tets": int(tets[n]), "volume_mm3": float(volume[n])} | within[n]
            for n, (body, each) in enumerate(zip(bodies, prepared, strict=True))
        ]
    }
    pipeline.finish(whole, levels, joined.with_seen(content, seen), options, report, more)


def _joined_level(graph: Graph, parts: Sequence[Level]) -> Level:
    """What made a level of all bodies. Variations of link lengths are means over the tets."""
    tets = [len(part.graph.tets) for part in parts]
    variation = {
        when: {
            key: float(np.average([part.report["link_length_variation"][when][key] for part in parts], weights=tets))
            for key in ("overall", "local")
        }
        for when in ("before", "after")
    }
    stages = parts[0].report["seconds"]
    told = {
        "mesher_tets": sum(part.report["mesher_tets"] for part in parts),
        "seconds": {stage: sum(part.report["seconds"][stage] for part in parts) for stage in stages},
        "link_length_variation": variation,
        "locality": ordering.inner_locality(graph),
    }
    within = [part.inside for part in parts if part.inside is not None]
    edges = [edge for _, edge in within if edge is not None]
    largest = max(edges) if edges and len(edges) == len(parts) else None
    return Level(graph, parts[0].mesher, told, inside=(within[0][0], largest))


def _whole(
    bodies: Sequence[BodyMesh], prepared: Sequence[Prepared], surface: Surface, options: BakeOptions
) -> Prepared:
    """All bodies as one mesh; surface: what is seen of them, mm."""
    digest = hashlib.sha256("".join(each.source.sha256 for each in prepared).encode()).hexdigest()
    name = ", ".join(body.mesh.name for body in bodies)
    counts = (sum(getattr(each.source, what) for each in prepared) for what in ("vertices", "triangles"))
    source = SourceMesh(surface, name, digest, FileFrame(), *counts)
    azimuth = front.azimuth(surface) if options.front is None else options.front
    return Prepared(source, surface, [repair for each in prepared for repair in each.repairs], azimuth)


def _metadata(body: BodyMesh, prepared: Prepared) -> dict[str, Any]:
    """What the file tells of one of its bodies, but for its tets."""
    low, high = prepared.surface.vertices.min(axis=0), prepared.surface.vertices.max(axis=0)
    return {
        "name": body.name,
        "part": body.part,
        "source": prepared.source.metadata(),
        "unit_mm": prepared.source.unit_mm,
        "position": list(body.placement.position),
        "rotation": list(body.placement.rotation),
        "scale": body.placement.scale,
        "surface_vertices": body.surface_vertices,
        "normals": prepared.normals.metadata(),
        "box_mm": [low.tolist(), high.tolist()],
    }
