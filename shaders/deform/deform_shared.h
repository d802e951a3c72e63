// What the passes that move a body share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_DEFORM_SHARED_H
#define QUADGRAPH_DEFORM_SHARED_H

#include "solver/solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

const uint DEFORM_TWIST = 0u;
const uint DEFORM_BEND = 1u;
const uint DEFORM_TAPER = 2u;
const uint DEFORM_STRETCH = 3u;
const uint DEFORM_TRANSFORM = 4u;
const uint DEFORM_LATTICE = 5u;
const uint DEFORM_CAGE = 6u;
const uint DEFORM_DISPLACED = 7u;
const uint DEFORM_PLACED = 8u;

// Control points of a lattice along a side at most.
#define LATTICE_MOST 16
const uint LATTICE_BEZIER = 0u;
const uint LATTICE_LINEAR = 1u;

// A deformer (engine/deform/deformer.h) as deform.h takes it. In C++ `control` is the address of dvec3 in memory.
struct DeformRecord {
  // Lattice: displacement of the control points, x fastest; cage: of its vertices; displaced: of every vertex, mm;
  // placed: three rows and what is added, mm, of each body.
  QG_REF(Vec3s) control;
  QG_REF(Floats) weight;  // cage: of control k at vertex v, at k * vertices + v; placed: the body of vertex v
  vec3 a;                 // axis, unit; transform: first row; lattice: its low corner, mm
  vec3 b;                 // bend: unit, across the axis; transform: second row; lattice: its size, mm
  vec3 c;                 // a point of the axis, mm; transform: third row
  vec3 d;                 // transform: added, mm
  float begin;            // mm along the axis from its point
  float extent;           // mm
  float amount;           // twist, bend: radians over the extent; taper, stretch: factor - 1
  uint kind;              // DEFORM_*
  uint count;             // cage: its vertices; lattice: points in x, y, z, and LATTICE_*, a byte each
};

// Sums over the tets and open faces that one workgroup looked at.
struct ShapeSums {
  float inverted;    // tets turned inside out
  float flat_count;  // tets below the least quality, inverted ones left out
  float worst;       // least quality, signed
  float conduction;  // engine/reference/stored_entries.h, mm^3
  float volume;      // mm^3
  float area;        // mm^2
};

#ifndef __cplusplus
QG_ARRAY(ShapeSumsArray, ShapeSums);
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
