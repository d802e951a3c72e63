"""What became of the colours of a mesh, in numbers and in words."""

from __future__ import annotations

from dataclasses import dataclass

from quadgraph.baking.colours.cells import ColourGrid
from quadgraph.baking.colours.placed_mesh import PlacedMesh
from quadgraph.baking.colours.reflectances import brightest
from quadgraph.baking.colours.surface_means import SurfaceMeans


@dataclass(frozen=True)
class ColourReport:
    """What became of the colours.

    cells: along x, y, z; spacing: mm; detail: width of the texels, or of edges between coloured vertices, mm, 0 where
    parts have one colour each; edge: median edge of the body's triangles, mm; colour: mean linear RGB of the surface;
    cut: share of it that is brighter than a body can be, which has the brightest such colour; stated: share of the
    surface whose medium the file states; eta: refractive index; roughness: of the file, GGX alpha, mean over the
    surface, None where it says nothing; notes: what was left out, and what is too coarse.
    """

    cells: tuple[int, int, int]
    spacing: float
    detail: float
    edge: float
    colour: tuple[float, float, float]
    cut: float
    stated: float
    eta: float
    roughness: float | None
    notes: tuple[str, ...]

    @property
    def text(self) -> str:
        """The same in words, a line each."""
        size = " x ".join(map(str, self.cells))
        lines = [
            f"{size} cells of {self.spacing:.3g} mm, eta {self.eta:g}; mean colour of the surface "
            f"{'/'.join(f'{c:.2f}' for c in self.colour)} (linear)"
        ]
        if self.stated:
            lines.append(f"{100 * self.stated:.0f}% of the surface have a medium that the file states")
        return "\n".join([*lines, *self.notes])


def report_of(placed: PlacedMesh, grid: ColourGrid, means: SurfaceMeans, eta: float) -> ColourReport:
    """Sum up what was done. means: of the surface, as `surface_means` gives them."""
    area = means.areas / means.areas.sum()
    red, green, blue = (float(area @ means.values[:, channel]) for channel in range(3))
    bright = means.values[:, :3].max(axis=1) > brightest(eta)
    stated, rough = float(area @ means.values[:, 3]), None
    cut = float(area @ (bright & (means.values[:, 3] < 0.5)))
    said = [(part.look.roughness, share) for part, share in zip(placed.looks.parts, placed.part_areas, strict=True)]
    known = [(value, share) for value, share in said if value is not None]
    if known and sum(share for _, share in known) > 0:
        rough = sum(value * share for value, share in known) / sum(share for _, share in known)
    notes = (*placed.looks.notes, *_notes(placed, grid, eta, cut, rough))
    return ColourReport(
        grid.counts, grid.spacing, grid.detail, placed.edge, (red, green, blue), cut, stated, eta, rough, notes
    )


def _notes(placed: PlacedMesh, grid: ColourGrid, eta: float, cut: float, rough: float | None) -> list[str]:
    notes = []
    several = {part.look.eta for part in placed.looks.parts if part.look.eta is not None}
    if len(several) > 1:
        notes.append(f"several refractive indices in the file; a body has one, here {eta:g}")
    if rough is not None:
        notes.append(f"the file has a roughness of {rough:.2g}, no volume has one: --roughness {max(rough, 0.02):.2g}")
    if cut > 0.005:
        notes.append(
            f"{100 * cut:.0f}% of the surface are brighter in a channel than {brightest(eta):.2f}, the brightest that "
            "a body shows, and were taken as that"
        )
    told = max(grid.spacing, placed.edge)
    if 0 < grid.detail < 0.75 * told:
        finer = "bake it finer (--refine 1, or more --surface-vertices)"
        help_with = finer if placed.edge > grid.spacing else "allow more cells (--cells, --spacing)"
        notes.append(
            f"the file has colours every {grid.detail:.2g} mm, of which this body shows averages over about {told:.2g} "
            f"mm: its triangles are {placed.edge:.2g} mm wide, cells {grid.spacing:.2g} mm; {help_with} for more"
        )
    return notes
