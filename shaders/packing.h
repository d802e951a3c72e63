// Entries of an operator as they are stored: the column in 22 bits or 25, and the three channels of a block as whole
// numbers with one exponent, so that an entry takes 64 bits instead of 128 (diffusion), or 160 instead of 320 (SP3).
// The largest channel is rounded by at most 2^-11, or 2^-12. An entry is rounded as its mirror image is, and sums of
// rows are kept in single precision (RowsRef), so products keep the energy; docs/layouts.md has what the exitance
// changes by.
//
//   diffusion  word 0: column, low 20 bits | red 12        word 1: column, high 2 | exponent 6 | green 12 | blue 12
//   SP3        word 0: column, low 19 bits | 1st 13        words 1 to 4: 6 bits | two 13s;
//              the six bits: column, high; exponents of a11, a12, a22. The 13s: a11, a12, a22.
#ifndef QUADGRAPH_PACKING_H
#define QUADGRAPH_PACKING_H

#include "shared.h"

// Formats of entries: as above, or the column and then three or nine numbers in single precision.
#define ENTRIES_PACKED 0
#define ENTRIES_PLAIN 1

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::abs;
using glm::clamp;
using glm::floatBitsToUint;
using glm::ivec3;
using glm::max;
using glm::roundEven;
using glm::uintBitsToFloat;
#endif

// Three numbers below 2^(bits-1) in size, times 2^(exponent - PACKED_BIAS).
struct PackedBlock {
  ivec3 number;
  uint exponent;  // 6 bits
};

// From 2^-33 on every number has all its bits, up to 2^31 it is not clamped.
const int PACKED_BIAS = 43;
// Rows that packed entries can name; with SP3 it could be more.
const uint PACKED_COLUMNS = 1u << 22u;

QG_INLINE float power_of_two(int exponent) {
  return uintBitsToFloat(uint(exponent + 127) << 23u);
}

QG_INLINE PackedBlock pack(vec3 block, int bits) {
  vec3 size = abs(block);
  int exponent = int(floatBitsToUint(max(size.x, max(size.y, size.z))) >> 23u) - 127 - (bits - 2);
  exponent = clamp(exponent + PACKED_BIAS, 0, 63);
  float most = float((1 << (bits - 1)) - 1);
  vec3 number = roundEven(clamp(block * power_of_two(PACKED_BIAS - exponent), vec3(-most), vec3(most)));
  PackedBlock packed;
  packed.number = ivec3(number);
  packed.exponent = uint(exponent);
  return packed;
}

QG_INLINE vec3 unpack(ivec3 number, uint exponent) {
  return vec3(number) * power_of_two(int(exponent) - PACKED_BIAS);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
