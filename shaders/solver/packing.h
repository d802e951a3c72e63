// Entries of an operator as they are stored: the column in 22 bits, and the numbers of a block as whole ones, three
// channels with one exponent, so that an entry takes 64 bits instead of 128 (diffusion), or 128 instead of 320 (SP3).
// The largest channel is rounded by at most 2^-11, or of SP3's a11 2^-12. An entry is rounded as its mirror image is,
// and sums of rows are kept in single precision (RowsRef), so products keep the energy; docs/layouts.md has what the
// exitance changes by.
//
// What linear elements say about an edge is stiffness s, masses a and r, and a measure of the surface
// (engine/reference/operator.h): a11 = s + a, a12 = 2/3 s, a22 = 55/63 s + r. So with SP3 a12 and a22 are these shares
// of a11 and a rest, which needs fewer bits. Rounding a11 is then as if the stiffness were another in both equations
// alike.
//
//   diffusion  word 0: column, low 20 bits | red 12          word 1: column, high 2 | exponent 6 | green 12 | blue 12
//   SP3        word 0: column 22 | rest12 red 8 | exponent of rest22, high 2
//              word 1: a11 red 13 | rest12 green 8, blue 8 | exponent of rest12 3
//              word 2: a11 green 13, blue 13 | exponent of a11 6
//              word 3: rest22 red 10, green 10, blue 10 | exponent of rest22, low 2
#ifndef QUADGRAPH_PACKING_H
#define QUADGRAPH_PACKING_H

#include "shared/shared.h"

// Formats of entries: as above, or plain: the column and three or nine numbers in single precision
// (stored_entries.glsl).
#define ENTRIES_PACKED 0
#define ENTRIES_PLAIN 1

// On a processor packed entries of diffusion lie there as plain ones, rounded as packed ones are: it takes much longer
// to unpack them than to read them, twice as many bytes or not.
#if defined(QG_PROCESSOR) && MOMENTS == 1
#define UNPACKED_ENTRIES 1
#else
#define UNPACKED_ENTRIES 0
#endif

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::abs;
using glm::clamp;
using glm::floatBitsToUint;
using glm::ivec3;
using glm::max;
using glm::roundEven;
using glm::uintBitsToFloat;
using glm::uvec3;
using glm::uvec4;
#endif

// Three numbers below 2^(bits-1) in size, times 2^(exponent - PACKED_BIAS).
struct PackedBlock {
  ivec3 number;
  uint exponent;  // 6 bits
};

// From 2^-33 on every number has all its bits, up to 2^31 it is not clamped.
const int PACKED_BIAS = 43;
const int DIFFUSION_BITS = 12;
// Rows that packed entries can name; with SP3 it could be more.
const uint PACKED_COLUMNS = 1u << 22u;

QG_INLINE float power_of_two(int exponent) {
  return uintBitsToFloat(uint(exponent + 127) << 23u);
}

// The exponent with which the largest of three numbers has all its bits.
QG_INLINE int exponent_of(vec3 block, int bits) {
  vec3 size = abs(block);
  return int(floatBitsToUint(max(size.x, max(size.y, size.z))) >> 23u) - 127 - (bits - 2);
}

QG_INLINE ivec3 rounded(vec3 block, int bits, int exponent) {
  float most = float((1 << (bits - 1)) - 1);
  return ivec3(roundEven(clamp(block * power_of_two(-exponent), vec3(-most), vec3(most))));
}

QG_INLINE PackedBlock pack(vec3 block, int bits) {
  int exponent = clamp(exponent_of(block, bits), -PACKED_BIAS, 63 - PACKED_BIAS);
  PackedBlock packed;
  packed.number = rounded(block, bits, exponent);
  packed.exponent = uint(exponent + PACKED_BIAS);
  return packed;
}

QG_INLINE vec3 unpack(ivec3 number, uint exponent) {
  return vec3(number) * power_of_two(int(exponent) - PACKED_BIAS);
}

// A block of SP3 as it is stored: a12 and a22 are the rests and these shares of a11.
struct Sp3Block {
  vec3 a11, rest12, rest22;
};
const float SP3_SHARE12 = 2.0f / 3.0f, SP3_SHARE22 = 55.0f / 63.0f;

const int SP3_BITS11 = 13, SP3_BITS12 = 8, SP3_BITS22 = 10;
// Exponents of the rests count from this much below that of a11: 0 to 7, and 0 to 30 in steps of two. Masses of a
// coarse level may be far above the stiffness in a22, but not what they do to a12.
const int SP3_BELOW = 2, SP3_RANGE12 = 7, SP3_RANGE22 = 30;

// Words 0 to 3 of an entry.
QG_INLINE uvec4 pack_sp3(uint column, Sp3Block block) {
  int e12 = exponent_of(block.rest12, SP3_BITS12) + SP3_BELOW, e22 = exponent_of(block.rest22, SP3_BITS22) + SP3_BELOW;
  // The exponent of a11 is at least what the rests need, so that theirs are not clamped.
  int e11 = max(exponent_of(block.a11, SP3_BITS11), max(e12 - SP3_RANGE12, e22 - SP3_RANGE22));
  e11 = clamp(e11, -PACKED_BIAS, 63 - PACKED_BIAS);
  int d12 = clamp(e12 - e11, 0, SP3_RANGE12), d22 = (clamp(e22 - e11, 0, SP3_RANGE22) + 1) / 2;
  uvec3 n11 = uvec3(rounded(block.a11, SP3_BITS11, e11)) & 0x1fffu;
  uvec3 n12 = uvec3(rounded(block.rest12, SP3_BITS12, e11 - SP3_BELOW + d12)) & 0xffu;
  uvec3 n22 = uvec3(rounded(block.rest22, SP3_BITS22, e11 - SP3_BELOW + 2 * d22)) & 0x3ffu;
  return uvec4(column | n12.x << 22u | uint(d22 >> 2) << 30u, n11.x | n12.y << 13u | n12.z << 21u | uint(d12) << 29u,
               n11.y | n11.z << 13u | uint(e11 + PACKED_BIAS) << 26u,
               n22.x | n22.y << 10u | n22.z << 20u | uint(d22 & 3) << 30u);
}

// The signed number of `bits` bits from bit `first` on.
QG_INLINE int number_at(uint word, int first, int bits) {
  return int(word << uint(32 - bits - first)) >> (32 - bits);
}

QG_INLINE Sp3Block unpack_sp3(uvec4 word) {
  int e11 = int(word.z >> 26u) - PACKED_BIAS, least = e11 - SP3_BELOW;
  int e12 = least + int(word.y >> 29u), e22 = least + 2 * int((word.x >> 30u) << 2u | word.w >> 30u);
  ivec3 n11 = ivec3(number_at(word.y, 0, 13), number_at(word.z, 0, 13), number_at(word.z, 13, 13));
  ivec3 n12 = ivec3(number_at(word.x, 22, 8), number_at(word.y, 13, 8), number_at(word.y, 21, 8));
  ivec3 n22 = ivec3(number_at(word.w, 0, 10), number_at(word.w, 10, 10), number_at(word.w, 20, 10));
  Sp3Block block;
  block.a11 = vec3(n11) * power_of_two(e11);
  block.rest12 = vec3(n12) * power_of_two(e12);
  block.rest22 = vec3(n22) * power_of_two(e22);
  return block;
}

// With packed entries of SP3, which only linear elements have, a row's sum and its diagonal are not stored: both follow
// from what the elements around the vertex say (entries.glsl), as consistent masses have two fifths of a row's sum on
// the diagonal, and faces half. The boundary is that of the body that the last bits of the area name, as many as
// `bodies` has: none where all bodies have one boundary.
struct Sp3Row {
  vec3 stiffness;   // on the diagonal
  vec3 absorption;  // of the whole row, like the rest
  vec3 relaxation;
  float area;
};

// Before the first row.
struct Sp3Head {
  uvec2 boundaries;  // address of a Boundary for each body
  uint bodies;       // bits of the area
};

// The area of a row with the number of its body, 0 where there is no area.
QG_INLINE float area_of_body(float area, uint body, uint bodies) {
  return uintBitsToFloat((floatBitsToUint(area) & ~bodies) | (body & bodies));
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
