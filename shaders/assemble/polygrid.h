// Weights of the Laplacian at the nodes of a polygrid [PG Appendix B], by the same code on the GPU, in single
// precision, and in the CPU reference, in double. python/quadgraph/tets/polygrid/weights.py tells what they are.
#ifndef QUADGRAPH_POLYGRID_H
#define QUADGRAPH_POLYGRID_H

#include "shared/shared.h"

#ifdef __cplusplus
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
namespace quadgraph::gpu {
using real = double;
using real3 = glm::dvec3;
using real33 = glm::dmat3;
using glm::abs;
using glm::inverse;
using glm::length;
using glm::max;
using glm::min;
using glm::transpose;
#else
#define real float
#define real3 vec3
#define real33 mat3
#endif

const int GRID_LINKS = 6;

// To the six neighbours, mm; the last is 0 where that link is missing.
struct GridOffsets {
  real3 at[GRID_LINKS];
};

// 1/mm^2.
struct GridWeights {
  real at[GRID_LINKS];
};

// Weights below this share of the largest count as not positive.
const real GRID_LEAST_WEIGHT = real(1e-3);
const real GRID_LEAST_PIVOT = real(1e-5);
// Steps of Newton's iteration for the nearest orthonormal frame, which converges quadratically.
const int GRID_FRAME_STEPS = 10;

QG_INLINE real3 grid_direction(real3 offset) {
  return offset / max(length(offset), real(1e-30));
}

// Orthonormal columns nearest to the directions of the pairs of links.
QG_INLINE real33 grid_frame(GridOffsets d) {
  real33 axes;
  for (int k = 0; k < 3; ++k) axes[k] = grid_direction(grid_direction(d.at[2 * k + 1]) - grid_direction(d.at[2 * k]));
  for (int step = 0; step < GRID_FRAME_STEPS; ++step) axes = real(0.5) * (axes + inverse(transpose(axes)));
  return axes;
}

QG_INLINE bool grid_link_missing(GridOffsets d) {
  return d.at[GRID_LINKS - 1] == real3(0);
}

// Weights as if both links of each pair lay on a straight line: never negative.
QG_INLINE GridWeights grid_straight_weights(GridOffsets d) {
  GridWeights w;
  for (int k = 0; k < GRID_LINKS; ++k) {
    real own = length(d.at[k]);
    w.at[k] = real(2) / (own * (own + length(d.at[k ^ 1])));
  }
  if (!grid_link_missing(d)) return w;
  // Three links of a plane at equal angles.
  for (int k = 2; k < 5; ++k) w.at[k] = real(4) / (real(3) * real(length(d.at[k]) * length(d.at[k])));
  w.at[5] = real(0);
  return w;
}

// The weights of Appendix B if all of them are positive, else those of straight lines.
QG_INLINE GridWeights grid_weights(GridOffsets d) {
  real size = real(0);
  for (int k = 0; k < GRID_LINKS; ++k) size += length(d.at[k]) / real(GRID_LINKS);
  real33 to_frame = transpose(grid_frame(d));
  bool missing = grid_link_missing(d);
  // Rows: the equations of x, x^2 / 2, y, y^2 / 2, z, z^2 / 2; columns: links, then the right-hand side.
  real m[GRID_LINKS][GRID_LINKS + 1];
  for (int k = 0; k < GRID_LINKS; ++k) {
    real3 local = to_frame * d.at[k] / size;
    for (int axis = 0; axis < 3; ++axis) {
      m[2 * axis][k] = local[axis];
      m[2 * axis + 1][k] = real(0.5) * local[axis] * local[axis];
    }
  }
  for (int row = 0; row < GRID_LINKS; ++row) m[row][GRID_LINKS] = real(row & 1);
  if (missing) {
    // The axes of the second and third pair share an equation; the sixth weight is 0.
    for (int k = 0; k <= GRID_LINKS; ++k) {
      m[3][k] += m[5][k];
      m[5][k] = k == GRID_LINKS - 1 ? real(1) : real(0);
    }
  }
  bool regular = true;
  for (int column = 0; column < GRID_LINKS; ++column) {
    int pivot = column;
    for (int row = column + 1; row < GRID_LINKS; ++row) {
      if (abs(m[row][column]) > abs(m[pivot][column])) pivot = row;
    }
    for (int k = 0; k <= GRID_LINKS; ++k) {
      real other = m[pivot][k];
      m[pivot][k] = m[column][k];
      m[column][k] = other;
    }
    regular = regular && abs(m[column][column]) > GRID_LEAST_PIVOT;
    for (int row = 0; row < GRID_LINKS; ++row) {
      if (row == column) continue;
      real factor = m[row][column] / m[column][column];
      for (int k = column; k <= GRID_LINKS; ++k) m[row][k] -= factor * m[column][k];
    }
  }
  GridWeights w;
  real least = real(1e30), largest = real(0);
  for (int k = 0; k < GRID_LINKS; ++k) {
    w.at[k] = m[k][GRID_LINKS] / (m[k][k] * size * size);
    largest = max(largest, w.at[k]);
    if (!(missing && k == GRID_LINKS - 1)) least = min(least, w.at[k]);
  }
  if (regular && least > GRID_LEAST_WEIGHT * largest) return w;
  return grid_straight_weights(d);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
