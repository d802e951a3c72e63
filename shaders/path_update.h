// Length of the shortest path to the middle of a cell through the side of the cube of its 26 neighbours, by the same
// code on the GPU, in single precision, and in the CPU reference, in double.
//
// Between the middles of neighbours the length is taken as linear, and the path leaves from the best point of the side:
// Tsitsiklis 1995, section III; OLIM26 of Potter and Cameron 2021. Plane fronts are exact, in whatever direction.
#ifndef QUADGRAPH_PATH_UPDATE_H
#define QUADGRAPH_PATH_UPDATE_H

#include "path_shared.h"

#ifdef __cplusplus
#include <cmath>
namespace quadgraph::gpu {
using path_real = double;
using std::sqrt;
#else
#define path_real float
#endif

// The least of t0 + s (t1 - t0) + c sqrt(base^2 + (s edge)^2) over 0 < s < 1, where it has a least: from a point of the
// edge between two neighbours, `base` the distance of the first and the edge at a right angle to it; cells. c > 0 is
// the cost of a cell's side. PATH_FAR where there is none: then it leaves from one of the two.
QG_INLINE path_real from_edge(path_real t0, path_real t1, path_real c, path_real base, path_real edge) {
  path_real g = (t0 - t1) / (c * edge), rest = path_real(1) - g * g;
  // s edge = base g / sqrt(rest).
  bool inside = g > path_real(0) && base * base * g * g < edge * edge * rest;
  return inside ? t0 + c * base * sqrt(rest) : path_real(PATH_FAR);
}

// The same of the triangle of neighbours at distances 1, sqrt(2) and sqrt(3); PATH_FAR where it has no least inside.
QG_INLINE path_real from_triangle(path_real t0, path_real t1, path_real t2, path_real c) {
  path_real a = (t0 - t1) / c, b = (t1 - t2) / c, rest = path_real(1) - a * a - b * b;
  bool inside = b >= path_real(0) && a >= b && a * a <= rest;
  return inside ? t0 + c * sqrt(rest) : path_real(PATH_FAR);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
