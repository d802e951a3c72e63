// What the kernels of tools/layouts share with C++, in scalar layout. Every kernel has the same push constants and
// reads of them what its layout has.
#ifndef QUADGRAPH_LAYOUT_SHARED_H
#define QUADGRAPH_LAYOUT_SHARED_H

#include "solver/solve_shared.h"

// How a row finds its entries.
#define ROWS_CSR 0
#define ROWS_CSR_SUBGROUP 1  // a subgroup for every row
#define ROWS_ELL 2
#define ROWS_SLICED 3  // SLICE rows a slice

// What an entry holds; "pair": with COLUMNS 16 one unit holds two entries.
#define ENTRIES_RGB 0             // fp32 blocks, columns apart; pair
#define ENTRIES_RGB_WORDS 1       // the same, each column beside its block
#define ENTRIES_HALF 2            // half blocks beside their columns; always a pair
#define ENTRIES_GEOMETRY 3        // g, m, b in fp32; pair
#define ENTRIES_MIXED 4           // g in fp32, m and b in half; pair
#define ENTRIES_GEOMETRY_HALF 5   // g, m, b and the column in 16 bits each
#define ENTRIES_STIFFNESS_HALF 6  // SP3: kappa g in fp32, masses, b and the column in 16 bits each

#define COEFFICIENTS_EVEN 0  // one for the body
#define COEFFICIENTS_EDGE 1  // mean of those at the two vertices

#define VECTORS_PACKED 0  // 12 bytes an RGB value
#define VECTORS_WIDE 1    // 16 bytes
#define VECTORS_PLANES 2  // an array for every channel
#define VECTORS_HALF 3    // 8 bytes; SP3: 12 bytes the pair

#define REDUCTION_TICKET 1    // shared memory, last workgroup combines (reduce.glsl)
#define REDUCTION_SUBGROUP 2  // subgroup sums, last workgroup combines
#define REDUCTION_DISPATCH 3  // subgroup sums, a second dispatch combines

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// An entry made of geometry is kappa g + sigma_a m + k11 b and so on (engine/reference/block.h). The factors undo the
// powers of two by which half values were brought into range.
struct LayoutConstants {
  vec3 kappa;       // mm
  vec3 sigma_a;     // 1/mm
  vec3 relaxation;  // 1/mm, 5/9 sigma_t
  float k11, k12, k22;
  float g, m, b;  // factors
  vec3 weight;    // factor of half blocks
};

// Coefficients at a vertex.
struct LayoutCoefficients {
  vec3 kappa;    // mm
  vec3 sigma_a;  // 1/mm
#if defined(__cplusplus) || MOMENTS == 2
  vec3 relaxation;  // 1/mm
#endif
};

#ifndef __cplusplus
QG_ARRAY(Constants, LayoutConstants);
QG_ARRAY(Coefficients, LayoutCoefficients);
#endif

// Rows of a slice start at unit offset[slice]; with COLUMNS 16, at offset[3 slice], followed by two bases: a column is
// base[code >> 15] + (code & 32767). `row_sum` and `diagonal` are blocks, or (m, b) and (g, m, b) of the row.
struct LayoutPush {
  QG_REF(Uints) offset;
  QG_REF(Uints) column;
  QG_REF(Uints) weight;
  QG_REF(Uints) row_sum;
  QG_REF(Uints) diagonal;
  QG_REF(Uints) order;  // row of every slot, where rows are sorted
  QG_REF(Coefficients) coefficients;
  QG_REF(Constants) constants;
  QG_REF(Uints) x;
  QG_REF(Uints) y;
  QG_REF(Uints) b;
  QG_REF(Uints) d;
  QG_REF(Reduction) reduction;
  uint count;
  uint width;        // ELL: units of a row
  float c0, c1, c2;  // of the Chebyshev steps d = c0 D^-1 b, d = c1 d + c2 D^-1 (b - A x)
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
