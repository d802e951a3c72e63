// Blocks of the matrix in memory, as ENTRIES, COLUMNS and COEFFICIENTS say.
#ifndef QUADGRAPH_LAYOUTS_ENTRIES_GLSL
#define QUADGRAPH_LAYOUTS_ENTRIES_GLSL

#include "vectors.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer AlignedUvec4s {
  uvec4 at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer AlignedUvec2s {
  uvec2 at[];
};

#define GEOMETRIC (ENTRIES == ENTRIES_GEOMETRY || ENTRIES == ENTRIES_MIXED || ENTRIES == ENTRIES_GEOMETRY_HALF)

// What a row knows before its entries are read.
struct Row {
  uint i;
  uvec2 base;  // of 16-bit columns
  Field own;
#if GEOMETRIC || ENTRIES == ENTRIES_STIFFNESS_HALF || ENTRIES == ENTRIES_HALF
  LayoutConstants constants;
#endif
#if COEFFICIENTS == COEFFICIENTS_EDGE
  LayoutCoefficients coefficients;
#endif
};

uint column_of(Row row, uint code) {
  return row.base[code >> 15u] + (code & 0x7fffu);
}

Entry block(vec3 stiffness, vec3 absorption, vec3 relaxation, LayoutConstants k, float b) {
#if MOMENTS == 1
  return Entry(stiffness + absorption + k.k11 * b);
#else
  return Entry(stiffness + absorption + k.k11 * b, (2.0 / 3.0) * stiffness + k.k12 * b,
               (55.0 / 63.0) * stiffness + relaxation + k.k22 * b);
#endif
}

// The column's value, if the matrix is that of a start from zero: d = c0 D^-1 b is not stored but found again.
Field neighbour(uint j) {
#ifdef FROM_ZERO
  return scaled(vec3(push.c0), solved(Entries(push.diagonal).at[j], Fields(push.b).at[j]));
#else
  return load(push.x, j);
#endif
}

Field add_entry(Field sum, Row row, Entry entry, uint j) {
  return add(sum, times(entry, difference(neighbour(j), row.own)));
}

#if GEOMETRIC
Entry geometric_block(Row row, uint j, float g, float m, float b) {
#if COEFFICIENTS == COEFFICIENTS_EVEN
  LayoutConstants k = row.constants;
  return block(k.kappa * g, k.sigma_a * m, k.relaxation * m, k, b);
#else
  LayoutCoefficients other = push.coefficients.at[j];
  float half_g = 0.5 * g, half_m = 0.5 * m;
#if MOMENTS == 1
  vec3 relaxation = vec3(0);
#else
  vec3 relaxation = (row.coefficients.relaxation + other.relaxation) * half_m;
#endif
  return block((row.coefficients.kappa + other.kappa) * half_g, (row.coefficients.sigma_a + other.sigma_a) * half_m,
               relaxation, row.constants, b);
#endif
}

Field add_geometry(Field sum, Row row, uint j, float g, float m, float b) {
  return add_entry(sum, row, geometric_block(row, j, row.constants.g * g, row.constants.m * m, row.constants.b * b), j);
}
#endif

// add_unit: entries of unit e.
#if ENTRIES == ENTRIES_RGB && COLUMNS == 32
Field add_unit(Field sum, Row row, uint e) {
  return add_entry(sum, row, Entries(push.weight).at[e], push.column.at[e]);
}
#elif ENTRIES == ENTRIES_RGB
Field add_unit(Field sum, Row row, uint e) {
  uint codes = push.column.at[e];
  sum = add_entry(sum, row, Entries(push.weight).at[2u * e], column_of(row, codes & 0xffffu));
  return add_entry(sum, row, Entries(push.weight).at[2u * e + 1u], column_of(row, codes >> 16u));
}
#elif ENTRIES == ENTRIES_RGB_WORDS
Field add_unit(Field sum, Row row, uint e) {
#if MOMENTS == 1
  uvec4 words = AlignedUvec4s(push.weight).at[e];
  return add_entry(sum, row, Entry(uintBitsToFloat(words.yzw)), words.x);
#else
  uvec2 a = AlignedUvec2s(push.weight).at[5u * e], b = AlignedUvec2s(push.weight).at[5u * e + 1u],
        c = AlignedUvec2s(push.weight).at[5u * e + 2u], d = AlignedUvec2s(push.weight).at[5u * e + 3u],
        f = AlignedUvec2s(push.weight).at[5u * e + 4u];
  Entry entry = Entry(uintBitsToFloat(uvec3(a.y, b)), uintBitsToFloat(uvec3(c, d.x)), uintBitsToFloat(uvec3(d.y, f)));
  return add_entry(sum, row, entry, a.x);
#endif
}
#elif ENTRIES == ENTRIES_HALF
Field add_unit(Field sum, Row row, uint e) {
#if COLUMNS == 16 && MOMENTS == 1
  uvec4 words = AlignedUvec4s(push.weight).at[e];
  uint first = column_of(row, words.x & 0xffffu), second = column_of(row, words.x >> 16u);
  vec2 w[3] = {unpackHalf2x16(words.y), unpackHalf2x16(words.z), unpackHalf2x16(words.w)};
#else
  uint at = e * (COLUMNS == 16 ? 1u + 3u * (2u * MOMENTS - 1u) : 2u + 3u * (2u * MOMENTS - 1u));
#if COLUMNS == 16
  uint codes = push.weight.at[at++];
  uint first = column_of(row, codes & 0xffffu), second = column_of(row, codes >> 16u);
#else
  uint first = push.weight.at[at++], second = push.weight.at[at++];
#endif
  vec2 w[3 * (2 * MOMENTS - 1)];
  [[unroll]] for (uint k = 0u; k < 3u * (2u * MOMENTS - 1u); ++k) w[k] = unpackHalf2x16(push.weight.at[at + k]);
#endif
#if MOMENTS == 1
  Entry a = Entry(row.constants.weight * vec3(w[0], w[1].x));
  Entry b = Entry(row.constants.weight * vec3(w[1].y, w[2]));
#else
  vec3 factor = row.constants.weight;
  Entry a = Entry(factor * vec3(w[0], w[1].x), factor * vec3(w[1].y, w[2]), factor * vec3(w[3], w[4].x));
  Entry b = Entry(factor * vec3(w[4].y, w[5]), factor * vec3(w[6], w[7].x), factor * vec3(w[7].y, w[8]));
#endif
  return add_entry(add_entry(sum, row, a, first), row, b, second);
}
#elif ENTRIES == ENTRIES_GEOMETRY && COLUMNS == 32
Field add_unit(Field sum, Row row, uint e) {
  uvec4 words = AlignedUvec4s(push.weight).at[e];
  vec3 gmb = uintBitsToFloat(words.yzw);
  return add_geometry(sum, row, words.x, gmb.x, gmb.y, gmb.z);
}
#elif ENTRIES == ENTRIES_MIXED && COLUMNS == 32
Field add_unit(Field sum, Row row, uint e) {
  uvec3 words = Uvec3s(push.weight).at[e];
  vec2 masses = unpackHalf2x16(words.z);
  return add_geometry(sum, row, words.x, uintBitsToFloat(words.y), masses.x, masses.y);
}
#elif ENTRIES == ENTRIES_MIXED
Field add_unit(Field sum, Row row, uint e) {
  uint at = 5u * e;
  uint codes = push.weight.at[at];
  vec2 g = uintBitsToFloat(uvec2(push.weight.at[at + 1u], push.weight.at[at + 2u]));
  vec2 first = unpackHalf2x16(push.weight.at[at + 3u]), second = unpackHalf2x16(push.weight.at[at + 4u]);
  sum = add_geometry(sum, row, column_of(row, codes & 0xffffu), g.x, first.x, first.y);
  return add_geometry(sum, row, column_of(row, codes >> 16u), g.y, second.x, second.y);
}
#elif ENTRIES == ENTRIES_GEOMETRY_HALF
Field add_unit(Field sum, Row row, uint e) {
  uvec2 words = AlignedUvec2s(push.weight).at[e];
  vec2 masses = unpackHalf2x16(words.y);
  return add_geometry(sum, row, column_of(row, words.x & 0xffffu), unpackHalf2x16(words.x).y, masses.x, masses.y);
}
#else
Field add_unit(Field sum, Row row, uint e) {
  uint at = 7u * e;
  vec3 stiffness = uintBitsToFloat(uvec3(push.weight.at[at], push.weight.at[at + 1u], push.weight.at[at + 2u]));
  vec2 p = unpackHalf2x16(push.weight.at[at + 3u]), q = unpackHalf2x16(push.weight.at[at + 4u]),
       r = unpackHalf2x16(push.weight.at[at + 5u]);
  uint last = push.weight.at[at + 6u];
  LayoutConstants k = row.constants;
  Entry entry = block(stiffness, k.sigma_a * vec3(p, q.x), k.relaxation * vec3(q.y, r), k,
                      k.b * unpackHalf2x16(last).x);
  return add_entry(sum, row, entry, column_of(row, last >> 16u));
}
#endif

Entry row_sum_of(Row row) {
#if GEOMETRIC && COEFFICIENTS == COEFFICIENTS_EVEN
  LayoutConstants k = row.constants;
  Floats sums = Floats(push.row_sum);
  float m = sums.at[2u * row.i];
  return block(vec3(0), k.sigma_a * m, k.relaxation * m, k, sums.at[2u * row.i + 1u]);
#else
  return Entries(push.row_sum).at[row.i];
#endif
}

Entry diagonal_of(Row row) {
#if GEOMETRIC && COEFFICIENTS == COEFFICIENTS_EVEN
  LayoutConstants k = row.constants;
  vec3 gmb = Vec3s(push.diagonal).at[row.i];
  return block(k.kappa * gmb.x, k.sigma_a * gmb.y, k.relaxation * gmb.y, k, gmb.z);
#else
  return Entries(push.diagonal).at[row.i];
#endif
}

#endif
