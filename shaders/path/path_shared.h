// Types of the shortest-path method that GLSL and C++ share, in scalar layout; tests/cpp/path/layout_test.cpp compares
// them with the compiled shaders. docs/shortest-path.md tells what the passes do.
#ifndef QUADGRAPH_PATH_SHARED_H
#define QUADGRAPH_PATH_SHARED_H

#include "material/edits.h"
#include "path/path_tools.h"

// Cells along the side of a block, which one workgroup of its square relaxes.
#define PATH_BLOCK 8
#define PATH_GROUP 64

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Vertices are rounded to this share of a cell, so that which column a triangle covers is exact in 32 bits for up to
// LARGEST_PATH_CELLS along a side.
const int PATH_SUBCELLS = 64;
const uint LARGEST_PATH_CELLS = 160u;

// Length of no path.
const float PATH_FAR = 1e30f;

// What a cell is.
const uint CELL_SOLID = 1u;    // a node of the graph
const uint CELL_INSIDE = 2u;   // its middle is inside the surface
const uint CELL_SURFACE = 4u;  // the surface crosses one of the three lines through its middle, within the cell
const uint CELL_CUT = 8u;      // solid beside what is cut away

// Cubes along the axes; cell (x, y, z) is number x + size.x (y + size.y z). Sizes are multiples of PATH_BLOCK.
struct PathGrid {
  vec3 origin;  // mm, the low corner of cell (0, 0, 0)
  float cell;   // mm, side of a cell
  uvec3 size;   // cells
};

QG_INLINE uint cell_count(PathGrid grid) {
  return grid.size.x * grid.size.y * grid.size.z;
}

QG_INLINE uint cell_number(PathGrid grid, uvec3 cell) {
  return cell.x + grid.size.x * (cell.y + grid.size.y * cell.z);
}

QG_INLINE uvec3 cell_at(PathGrid grid, uint number) {
  return uvec3(number % grid.size.x, number / grid.size.x % grid.size.y, number / (grid.size.x * grid.size.y));
}

// mm.
QG_INLINE vec3 middle_of(PathGrid grid, uvec3 cell) {
  return grid.origin + grid.cell * (vec3(cell) + vec3(0.5f));
}

// path_box.comp: the box around vertices, as numbers that order as the coordinates do (sortable_float).
struct PathBoxPush {
  QG_REF(Vec3s) vertices;  // mm
  QG_REF(Uints) box;       // 6: low, high; begun at the largest and smallest number
  uint count;
};

// path_crossings.comp: where the lines through the middles of cells cross triangles. Per axis and cell, in the first
// cell whose middle lies behind a crossing: their number times 65536 plus the change of the winding number along the
// axis.
struct PathCrossingsPush {
  PathGrid grid;
  QG_REF(Vec3s) vertices;  // mm
  QG_REF(Uvec3s) triangles;
  QG_REF(Uints) crossings;  // 3 per cell, axis after axis; added to
  QG_REF(Uints) flags;      // CELL_SURFACE, or-ed
  QG_REF(Uints) triangle;   // per cell that the surface crosses: 1 + the largest of the triangles that do
  uint triangle_count;
  uint stripes;  // invocations per triangle and axis
  PathTools tools;
};

// path_winding.comp: along the lines of one axis, in how many of its two directions a cell's middle is inside: where
// the changes of the winding number along the line add up to 0, in both where that is not 0 here; else, where a
// surface is open or does not know its outside, where an odd number of crossings lies on the way.
struct PathWindingPush {
  PathGrid grid;
  QG_REF(Uints) crossings;  // of the axis, replaced
  uint axis;
};

// What is counted of the cells.
struct PathCounts {
  uint solid;
  uint lit;  // of them, in some channel
};

// path_solid.comp: which cells are solid.
struct PathSolidPush {
  PathGrid grid;
  QG_REF(Uints) votes;  // path_winding.comp's, axis after axis
  QG_REF(Uints) flags;
  QG_REF(Uints) wanted;  // PathRelaxPush; 0 where a cell of the block is solid
  QG_REF(Uints) counts;  // PathCounts
  PathTools tools;
};

// path_flood.comp: for all cells one that the surface crosses, the nearest but for rare exceptions, by jump flooding
// (Rong and Tan 2006): the nearest of those that the 27 cells in steps of `step` know. With step 0: the cell itself.
struct PathFloodPush {
  PathGrid grid;
  QG_REF(Uints) triangle;
  QG_REF(Uints) from;
  QG_REF(Uints) to;  // number of a cell; NO_CELL
  uint step;
};
const uint NO_CELL = 0xffffffffu;

const uint COST_TRANSPORT = 0u;
const uint COST_EXTINCTION = 1u;

// Of what the cells are made. Places are those of the mesh at rest.
struct PathMaterial {
  Material material;
  // Instead of it where there are any, x fastest: of points at `spacing` mm from `first` on; beside them the nearest's.
  QG_REF(Opticals) optical;
  uvec3 optical_size;
  vec3 optical_spacing;
  vec3 optical_first;
  QG_REF(MaterialEdits) edits;
  QG_REF(Vec3s) points;  // of their strokes
  QG_REF(Vec3s) texels;  // of their images
  uint edit_count;
  uint cost;  // COST_*
};

#ifndef __cplusplus
QG_ARRAY(PathMaterials, PathMaterial);
#endif

// path_cost.comp: what the cells cost.
struct PathCostPush {
  PathGrid grid;
  QG_REF(Uints) flags;
  QG_REF(Uints) nearest;   // path_flood.comp; null: cells lie where they do at rest, and depth does not matter
  QG_REF(Uints) triangle;  // path_crossings.comp
  QG_REF(Uvec3s) triangles;
  QG_REF(Vec3s) vertices;  // mm
  QG_REF(Vec3s) rest;      // the same at rest
  QG_REF(PathMaterials) body;
  QG_REF(Floats) cost;  // written
};

const uint PATH_NEVER = 0x80000000u;
const uint PATH_SELF = 13u;  // of 27 blocks, x fastest

// path_start.comp: lengths before the first step: -ln of what enters.
struct PathStartPush {
  PathGrid grid;
  QG_REF(Uints) flags;
  QG_REF(Uints) entering;  // 3 per cell, channel after channel: bits of W/mm^2
  QG_REF(Floats) paths;    // the same order, written
  QG_REF(Uints) wanted;
  QG_REF(Uints) list;    // blocks of round 0: block + blocks * channel
  QG_REF(Uints) groups;  // of round 0
  QG_REF(Uints) counts;  // PathCounts
};

// path_relax.comp: relaxes the blocks of a list; those that light arrives at later than it has crossed one of them wait
// for another round, as it may not have come on its shortest way yet.
struct PathRelaxPush {
  PathGrid grid;
  QG_REF(Floats) cost;   // 3 per cell, channel after channel, 1/mm; below 0: not solid
  QG_REF(Floats) paths;  // the same order; falls
  // Of even rounds and then of odd ones, per block and channel: bits of the 27 blocks around that have changed, the
  // block itself in their middle; 0 where it is not listed, PATH_NEVER too where no cell is solid.
  QG_REF(Uints) wanted;
  QG_REF(Uints) list;    // of this round
  QG_REF(Uints) next;    // of the next one
  QG_REF(Uints) groups;  // workgroup counts, 3 per round
  // The same of the blocks' lengths where light arrives and where it has crossed, as numbers that order as they do;
  // without one and begun at the largest.
  QG_REF(Uvec2s) arrivals;
  QG_REF(Uints) fronts;  // 3 per round: least at which a listed block is crossed; the same
  uint round;
};

// path_field.comp: what leaves the surface: exp(-length) in the cells that it crosses. Deeper cells are darker or
// brighter by what a cell costs, and the cells around have no paths: both count only where no other cell is near.
struct PathFieldPush {
  PathGrid grid;
  QG_REF(Uints) flags;
  QG_REF(Floats) paths;
  QG_REF(Vec4s) field;  // W/mm^2 times weight, and the weight; written
};
const float FIELD_BELOW = 1e-3f;   // weight of solid cells below the surface
const float FIELD_BESIDE = 1e-6f;  // of the cells around, which hold means of the solid ones beside them

// What the display needs.
struct PathField {
  PathGrid grid;
  QG_REF(Vec4s) field;
  PathTools tools;
};

#ifndef __cplusplus
QG_ARRAY(PathFields, PathField);

// The only one of an array.
PathField load_path_field(PathFields a) {
  if (!TEXELS) return a.at[0];
  uint t = texel_of(uvec2(a));
  PathGrid grid = PathGrid(uintBitsToFloat(texels3(t)), uintBitsToFloat(texel(t + 3u)), texels3(t + 4u));
  PathTools tools = PathTools(PathToolList(texels2(t + 10u)), texel(t + 12u));
  return PathField(grid, Vec4s(texels2(t + 8u)), tools);
}
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
