// Length of the shortest path to the middle of a cell through the side of the cube of its 26 neighbours, by the same
// code on the GPU, in single precision, and in the CPU reference, in double.
//
// Between the middles of neighbours the length is taken as linear, and the path leaves from the best point of the side:
// Tsitsiklis 1995, section III; OLIM26 of Potter and Cameron 2019. Plane fronts are exact, in whatever direction.
#ifndef QUADGRAPH_PATH_UPDATE_H
#define QUADGRAPH_PATH_UPDATE_H

#include "path/path_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using path_real = double;
#else
#define path_real float
#endif

// A path that leaves from the edge between two neighbours, the first `base` cells away and the second `edge` farther at
// a right angle, `fall` less far from the light, over the cost c of a cell's side: it is shortest, t0 + c base
// sqrt(rest), where it leaves at a right angle to the front. 1 where that is not between the two.
QG_INLINE path_real edge_rest(path_real fall, path_real base_squared, path_real edge_squared) {
  path_real g = fall * fall;
  bool between = fall > path_real(0) && g * (base_squared + edge_squared) < edge_squared * edge_squared;
  return between ? path_real(1) - g / edge_squared : path_real(1);
}

// Update from the triangle of neighbours at distances 1, sqrt(2) and sqrt(3): t0 + c sqrt(rest), with the falls from
// the first to the second and on to the third.
QG_INLINE path_real triangle_rest(path_real a, path_real b) {
  path_real rest = path_real(1) - a * a - b * b;
  bool within = b >= path_real(0) && a >= b && a * a <= rest;
  return within ? rest : path_real(1);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
