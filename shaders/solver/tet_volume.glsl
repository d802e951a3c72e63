// The quality of a tet, and its volume as operators take it. A tet that is turned inside out counts as the one that it
// mirrors, a flat one as if it had a least height: its stiffness is then the same, positive semidefinite sum of
// products of normals, divided by a larger volume, so that operators stay symmetric and positive definite.
#ifndef QUADGRAPH_TET_VOLUME_GLSL
#define QUADGRAPH_TET_VOLUME_GLSL

#include "solver/solve_shared.h"

const float REGULAR = 0.31020161970069987;  // 6 V / (sum of the squares of n_k)^(3/4), n_k of twice the areas

// 1 of a regular tet, 0 of a flat one, below 0 of one that is inside out; `squares`: of the n_k, summed up.
float tet_quality(float six_volume, float squares) {
  return six_volume / max(REGULAR * pow(squares, 0.75), 1e-30);
}

// mm^3, six times.
float bounded_six_volume(float six_volume, float squares, LeastTet least) {
  if (least.quality == 0.0) return abs(six_volume);
  return max(abs(six_volume), max(least.quality * REGULAR * pow(squares, 0.75), 6.0 * least.volume));
}

// Volume of a tet with these edges from one corner.
float tet_volume(vec3 e1, vec3 e2, vec3 e3, LeastTet least) {
  vec3 n1 = cross(e2, e3);
  float six_volume = dot(e1, n1);
  if (least.quality == 0.0) return abs(six_volume) / 6.0;
  vec3 n2 = cross(e3, e1), n3 = cross(e1, e2), n0 = n1 + n2 + n3;
  return bounded_six_volume(six_volume, dot(n0, n0) + dot(n1, n1) + dot(n2, n2) + dot(n3, n3), least) / 6.0;
}

#endif
