// Types of the shortest-path method that GLSL and C++ share, in scalar layout; see shared.h.
// docs/shortest-path.md tells what the passes do.
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

// What is counted of the cells.
struct PathCounts {
  uint solid;
  uint lit;  // of them, in some channel
};

const uint NO_CELL = 0xffffffffu;

const uint COST_TRANSPORT = 0u;
const uint COST_EXTINCTION = 1u;

// The material of the cells. Places are those of the mesh at rest.
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
QG_COHERENT_ARRAY(CoherentUints, uint);
#endif

const uint PATH_NEVER = 0x80000000u;
const uint PATH_SELF = 13u;  // of 27 blocks, x fastest

// path_relax.comp: relaxes the blocks of a list; those that light arrives at later than it has crossed one of them wait
// for another round, as it may not have come on its shortest way yet.
struct PathRelaxPush {
  PathGrid grid;
  QG_REF(Floats) cost;   // 3 per cell, channel after channel, 1/mm; below 0: not solid
  QG_REF(Floats) paths;  // the same order, twice; falls
  // Per block and channel, of those two copies of its lengths: 2 (1 + the round that wrote it last) + which one that
  // was; 0 at first, for the first.
  QG_REF(CoherentUints) copies;
  // Bits per block and channel, of even rounds and then of odd ones: the 27 blocks around that have changed, the
  // block itself in their middle; 0 where it is not listed, PATH_NEVER too where no cell is solid.
  QG_REF(CoherentUints) wanted;
  QG_REF(Uints) list;    // of this round
  QG_REF(Uints) next;    // of the next one
  QG_REF(Uints) groups;  // workgroup counts, 3 per round
  // Lengths, in such pairs, at which light arrives at a block and has crossed it, as numbers that order as they do;
  // without one and begun at the largest.
  QG_REF(Uvec2s) arrivals;
  QG_REF(Uints) fronts;  // 3 per round: least at which a listed block is crossed; the same
  uint round;
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

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
