"""The whole way from a mesh file to a `.qgraph` file."""

from __future__ import annotations

import importlib.metadata
import platform
import resource
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.baking import inside, surface_changes
from quadgraph.baking.embedding import Embedded, LevelSurfaces, Nest
from quadgraph.baking.inside import LevelSizes
from quadgraph.baking.report import BakeReport
from quadgraph.baking.workers import workers
from quadgraph.base import child_process, outputs
from quadgraph.base.errors import InputError, QuadGraphError, ToolError
from quadgraph.base.progress import ProgressCallback
from quadgraph.base.version import __version__
from quadgraph.core import load_core
from quadgraph.file import qgraph_file, sections
from quadgraph.mesh import front, mesh_io, solid, subdivide, wrap
from quadgraph.mesh.looks import file_normals
from quadgraph.mesh.looks.file_normals import COMPUTED, FoundNormals
from quadgraph.mesh.surface import MesherInfo, Repair, SourceMesh, Surface
from quadgraph.tets import exchange, graph, ordering, relax
from quadgraph.tets.polygrid import build as polygrid
from quadgraph.tets.tetrahedralise import (
    DEFAULT_GRADING,
    DEFAULT_MEMORY_LIMIT_BYTES,
    DEFAULT_TIME_LIMIT_S,
    tetrahedralise,
)

ORDERS = {"blocks": ordering.in_blocks, "random": ordering.at_random}
MOST_STEPS = 10000  # that spread the inner nodes
_PACKAGES = ("numpy", "scipy", "pymeshlab", "trimesh")
_OPTIONS = ("up", "wrap", "levels", "surface_vertices", "refine", "interior", "for_materials", "relax_nodes", "order",
            "visibility_rays", "cubes", "cells", "normals")  # fmt: skip


@dataclass(frozen=True)
class BakeOptions:
    """Options of a bake.

    unit ("mm", "cm", "m"), height_mm, longest_mm: the body's size as mesh_io.read_surface takes it, at most one; up:
    the mesh's axis that points up, "y" or "z"; wrap: mm, or "auto": bake a closed surface around a mesh that is no
    solid (`quadgraph.mesh.wrap`); levels: None for as many as make sense; mesher: "tetgen", "cgal" or "polygrid";
    grading: K of the paper's sizing field, for cgal; cubes and cells: of a polygrid (tets/polygrid/build.py), None for
    the usual; relax_nodes: steps that spread the inner nodes; order: "blocks" or "random"; surface_vertices: about how
    many the finest simulation surface has, None for all of the input's; refine: times that every triangle of the
    simulation surface is cut into four, curved where the body is smooth; interior: how large tets are deep inside,
    "auto" by the shape, "surface" as the surface makes them, or an edge length in mm (of coarser levels twice that,
    four times, ...), None for "auto" with tetgen and "surface" with cgal; for_materials: materials that they are sized
    for instead, texts or files of volumes, and for which triangles are cut where they change (`surface_changes`);
    visibility_rays: from each face of one level, to find what sees what, 0 for none; normals: of the displayed surface,
    "file" for those of the mesh file where it gives some that can be true, "angle" for smooth ones up to edges of 40
    degrees, as all others get; limits hold for each run of the mesher; front: azimuth in degrees from where the body is
    shown when nobody says so, None for `quadgraph.mesh.front.azimuth`.
    """

    unit: str | None = None
    height_mm: float | None = None
    longest_mm: float | None = None
    up: str = "y"
    wrap: float | str | None = None
    levels: int | None = None
    mesher: str = "tetgen"
    grading: float | None = None
    cubes: int | None = None
    cells: int | None = None
    relax_nodes: int = relax.DEFAULT_STEPS
    order: str = "blocks"
    surface_vertices: int | None = None
    refine: int = 0
    interior: str | float | None = None
    for_materials: tuple[str, ...] = ()
    visibility_rays: int = exchange.DEFAULT_RAYS
    normals: str = "file"
    time_limit_s: float = DEFAULT_TIME_LIMIT_S
    memory_limit_bytes: int = DEFAULT_MEMORY_LIMIT_BYTES
    front: float | None = None


@dataclass(frozen=True)
class Level:
    """A level's graph, what made its tets, what the report tells of it, and notes for it.

    inside: what its inner tets are sized by, and their largest edge, mm, None for any; None of polygrids.
    """

    graph: graph.Graph
    mesher: MesherInfo
    report: dict[str, Any]
    notes: list[str] = field(default_factory=list)
    inside: tuple[str, float | None] | None = None


@dataclass(frozen=True)
class Prepared:
    """A mesh file's surface, mm, fit for the mesher, what was repaired for that, its front, degrees, and normals."""

    source: SourceMesh
    surface: Surface
    repairs: list[Repair]
    front: float
    normals: FoundNormals = COMPUTED


def bake(
    mesh: str | Path, output: str | Path, options: BakeOptions, progress: ProgressCallback | None = None
) -> BakeReport:
    """Bake `mesh` into `output` and report.

    mesh: a file that mesh_io.read_surface reads; output: a .qgraph; progress: is told in words what was done.
    The chain of levels ends where a coarser level cannot be made, which a note of the report tells. Raises InputError
    for unusable input or options, ToolError if the finest level cannot be filled with tets. `output` is written last
    and at once: whatever interrupts the bake, it is untouched, and no child program is left.
    """
    tell = progress or (lambda text: None)
    check_options(Path(output), options)
    outputs.check_outputs([Path(output)], [mesh])
    report, start = BakeReport(str(output)), time.perf_counter()
    with naming(mesh):
        prepared = prepare(Path(mesh), options, report, tell)
        write(prepared, make_levels(prepared.surface, options, report, tell), options, report)
    report.seconds["total"] = time.perf_counter() - start
    return report


@contextmanager
def naming(mesh: str | Path) -> Iterator[None]:
    """Let errors of the programs that fill a mesh with tets begin with its name."""
    try:
        yield
    except ToolError as error:
        raise ToolError(f"{mesh}: {error}") from error


def prepare(
    mesh: Path, options: BakeOptions, report: BakeReport, tell: ProgressCallback, part: str | None = None
) -> Prepared:
    """Read a mesh or a part of it, wrap it if that is asked for, repair. Raises InputError; of the wrap ToolError."""
    with report.timed("read"):
        size = {name: getattr(options, name) for name in ("unit", "height_mm", "longest_mm", "up")}
        source = mesh_io.read_surface(mesh, part=part, **size)
    if source.size_note:
        report.notes.append(source.size_note)
    tell(f"read {source.name}: {source.vertices:,} vertices, {source.triangles:,} triangles")
    limits = options.time_limit_s, options.memory_limit_bytes
    with report.timed("repair"):
        surface, repairs, notes = solid.solid(source, options.wrap, limits, tell)
    report.notes += notes
    for entry in repairs:
        tell(f"repaired: {entry.what}: {entry.count:,}")
    with report.timed("front"):
        seen_from = front.azimuth(surface) if options.front is None else options.front
    with report.timed("normals"):
        normals = _normals(mesh, source, surface, options)
    report.notes += [normals.note] if normals.note else []
    return Prepared(source, surface, repairs, seen_from, normals)


def _normals(mesh: Path, source: SourceMesh, surface: Surface, options: BakeOptions) -> FoundNormals:
    """Those that the file gives, if they are wanted and its triangles are shown."""
    if options.normals == "angle":
        return COMPUTED
    if options.wrap is not None:
        return FoundNormals("angle", note="the normals of a wrapped surface are computed")
    return file_normals.find(mesh, surface, source.frame.placed)


def write(
    prepared: Prepared, levels: list[Level], options: BakeOptions, report: BakeReport, budget: dict | None = None
) -> None:
    """Write `levels` below the displayed surface to the report's output, and complete the report.

    budget: what the bake measured for an error that was asked for, kept in the file.
    """
    graphs = [level.graph for level in levels]
    with report.timed("surface"):
        displayed = shown(prepared, options)
    with report.timed("exchange"):
        seen = exchange.bake(graphs, options.visibility_rays)
    if seen is not None:
        report.exchange = exchange.summary(seen, graphs[seen.level].boundary)
    with report.timed("transfers"):
        content = sections.whole_file(graphs, displayed.surface, seen, displayed.normals)
    report.normals = prepared.normals.metadata()
    more = {"normals": report.normals} | ({} if budget is None else {"budget": budget})
    finish(prepared, levels, content, options, report, more)


def finish(
    prepared: Prepared,
    levels: list[Level],
    content: dict[str, np.ndarray],
    options: BakeOptions,
    report: BakeReport,
    more: dict[str, Any],
) -> None:
    """Write sections with their metadata, of which `more` are added, and complete the report."""
    metadata = _metadata(prepared, levels, options) | more
    if levels[0].inside is not None:
        report.interior = inside.metadata(
            levels[0].inside[0], options.for_materials, [level.inside and level.inside[1] for level in levels]
        )
        metadata["interior"] = report.interior
    if report.polygrid is not None:
        metadata["polygrid"] = report.polygrid
    with report.timed("write"):
        report.byte_size = qgraph_file.write(Path(report.output), metadata, content)
    _complete(report, metadata, levels)


def check_options(output: Path, options: BakeOptions) -> None:
    """Refuse at once what would otherwise be found out after the work."""
    if options.order not in ORDERS:
        raise InputError(f"order: {options.order!r} found, allowed are {', '.join(ORDERS)}")
    if not 0 <= options.relax_nodes <= MOST_STEPS:
        raise InputError(f"relax_nodes: {options.relax_nodes} found, 0 to {MOST_STEPS} allowed")
    exchange.check_rays(options.visibility_rays)
    inside.check_interior(options.interior, options.for_materials, options.mesher)
    front.check(options.front)
    child_process.check_limits(options.time_limit_s, options.memory_limit_bytes)
    _check_polygrid_options(options)
    subdivide.check(options.refine)
    wrap.check(options.wrap)
    file_normals.check(options.normals)
    outputs.check_folder(output)
    outputs.check_kind(output)
    load_core()  # holds what is written to the rules of the file


def _check_polygrid_options(options: BakeOptions) -> None:
    if options.mesher == "polygrid":
        for name in ("surface_vertices", "grading", "refine"):
            if getattr(options, name):
                raise InputError(f"{name}: found with mesher 'polygrid', whose cubes and cells say how fine it is")
        return
    for name in ("cubes", "cells"):
        if getattr(options, name) is not None:
            raise InputError(f"{name}: found with mesher {options.mesher!r}, only 'polygrid' has them")


def make_levels(
    surface: Surface,
    options: BakeOptions,
    report: BakeReport,
    tell: ProgressCallback,
    within: Sequence[Embedded] = (),
) -> list[Level]:
    """Levels of a surface and of those within it, whose numbers from 1 on are the regions of the graphs, finest first.

    Raises InputError or ToolError where there is no finest level.
    """
    surface = surface.rounded()
    if options.mesher == "polygrid":
        return _polygrid_levels(surface, options, report, tell)
    with workers() as submit:
        with report.timed("simplify"):
            nest = Nest(surface, within, options.refine, options.surface_vertices)
        sizes = inside.sizes_of(nest.finest.outer, options.interior, options.for_materials, options.mesher)
        with report.timed("surface"):
            cut = surface_changes.refined(nest.finest.outer, options.for_materials, options.mesher)
            report.notes += nest.take(cut)
        # The finest level takes longest: its tets are made while the chain below it is.
        jobs = [submit(_make_level, nest.finest, options, sizes, 0)]
        with report.timed("simplify"):
            chain, notes = nest.chain(options.levels, tell)
        report.notes += notes
        jobs += [submit(_make_level, coarse, options, sizes, number) for number, coarse in enumerate(chain[1:], 1)]
        with report.timed("tetrahedra and graphs"):
            return _collect(jobs, report, tell)


def shown(prepared: Prepared, options: BakeOptions) -> Prepared:
    """With the displayed triangles cut as those of the simulation are, of which each shows one; they stay flat."""
    surface = prepared.surface.rounded()
    cut = surface_changes.refined(surface, options.for_materials, options.mesher)
    if not cut.cuts:
        return prepared
    return replace(prepared, surface=cut.straight(surface), normals=prepared.normals.cut(surface, cut.cuts))


def _collect(jobs: list[Future[Level]], report: BakeReport, tell: ProgressCallback) -> list[Level]:
    levels: list[Level] = []
    for number, job in enumerate(jobs):
        try:
            levels.append(job.result())
        except QuadGraphError as error:
            if not levels:
                raise
            report.notes.append(f"level {number} was left out, and all below it: {error}")
            break
        tell(f"level {number}: {len(levels[-1].graph.tets):,} tets")
        report.notes += levels[-1].notes
    return levels


def _polygrid_levels(surface: Surface, options: BakeOptions, report: BakeReport, tell: ProgressCallback) -> list[Level]:
    with report.timed("polygrid"):
        made = polygrid.build(surface, options.cubes, options.cells, options.levels, tell)
    report.polygrid = made.report
    return [_ordered_level(built, made.mesher, len(built.tets), {}, options) for built in made.graphs]


def _make_level(surfaces: LevelSurfaces, options: BakeOptions, sizes: LevelSizes, number: int) -> Level:
    """Tets, graph, even nodes, cache-local order."""
    clock = [time.perf_counter()]
    limits: dict[str, Any] = {"time_limit_s": options.time_limit_s, "memory_limit_bytes": options.memory_limit_bytes}
    mesh, edge, notes = sizes.fill(
        number, surfaces.whole, lambda most: tetrahedralise(surfaces.outer, mesher=options.mesher, inner=surfaces.inner,
                                                            grading=options.grading, limits=most, **limits)
    )  # fmt: skip
    clock.append(time.perf_counter())
    built = graph.build(mesh)
    clock.append(time.perf_counter())
    seconds = {"tetrahedra": clock[1] - clock[0], "graph": clock[2] - clock[1]}
    level = _ordered_level(built, mesh.mesher, len(mesh.tets), seconds, options)
    return replace(level, notes=notes, inside=(sizes.rule, edge))


def _ordered_level(
    built: graph.Graph, mesher: MesherInfo, mesher_tets: int, seconds: dict[str, float], options: BakeOptions
) -> Level:
    clock = [time.perf_counter()]
    relaxed = relax.relax(built, options.relax_nodes)
    clock.append(time.perf_counter())
    ordered = ORDERS[options.order](relaxed)
    if ordered.grid_links is not None:
        ordered = polygrid.by_layers(ordered)
    clock.append(time.perf_counter())
    variation = {when: relax.link_length_variation(which) for when, which in (("before", built), ("after", relaxed))}
    report = {
        "mesher_tets": mesher_tets,
        "seconds": seconds | {"relax": clock[1] - clock[0], "order": clock[2] - clock[1]},
        "link_length_variation": variation,
        "locality": ordering.inner_locality(ordered),
    }
    return Level(ordered, mesher, report)


def _metadata(prepared: Prepared, levels: list[Level], options: BakeOptions) -> dict[str, Any]:
    source, mesher = prepared.source, levels[0].mesher
    packages = (*_PACKAGES, "embreex") if options.visibility_rays else _PACKAGES
    grading = None
    if options.mesher == "cgal":
        grading = DEFAULT_GRADING if options.grading is None else options.grading
    return {
        "generator": f"quadgraph {__version__}",
        "source": source.metadata(),
        "unit_mm": source.unit_mm,
        "mesher": {"name": mesher.name, "version": mesher.version, "options": mesher.options, "grading": grading},
        "options": {key: getattr(options, key) for key in _OPTIONS},
        "repairs": [asdict(entry) for entry in prepared.repairs],
        "front": prepared.front,
        "levels": [sections.level_metadata(level.graph) for level in levels],
        "tools": {
            "python": platform.python_version(),
            mesher.name: mesher.version,
            **{package: importlib.metadata.version(package) for package in packages},
        },
    }


def _complete(report: BakeReport, metadata: dict[str, Any], levels: list[Level]) -> None:
    # Linux counts ru_maxrss in KiB, macOS in bytes.
    unit = 1 if sys.platform == "darwin" else 1024
    report.source = metadata["source"]
    report.unit_mm = metadata["unit_mm"]
    report.repairs = metadata["repairs"]
    report.levels = [entry | level.report for entry, level in zip(metadata["levels"], levels, strict=True)]
    report.peak_memory = {
        "self": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit,
        "largest_child": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * unit,
    }
