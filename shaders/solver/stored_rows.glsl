// The blocks of an operator's rows beside its entries (RowsRef): reading and writing.
#ifndef QUADGRAPH_STORED_ROWS_GLSL
#define QUADGRAPH_STORED_ROWS_GLSL

#include "solver/entries.glsl"
#include "solver/solve_shared.h"
#include "solver/stored_entries.glsl"

#if MOMENTS == 2
// With packed entries, which only linear elements have, a row's sum and its diagonal are not stored: both follow from
// what the elements around the vertex say (entries.glsl), as consistent masses have two fifths of a row's sum on the
// diagonal, and faces half.
struct Sp3Row {
  vec3 stiffness;   // on the diagonal
  vec3 absorption;  // of the whole row, like the rest
  vec3 relaxation;
  float area;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Sp3Rows {
  vec3 boundary;  // k11, k12, k22
  Sp3Row at[];
};

Boundary stored_boundary(Entries a) {
  vec3 k = ROW_TEXELS ? uintBitsToFloat(row_texels3(row_texel_of(uvec2(a)))) : Sp3Rows(uvec2(a)).boundary;
  return Boundary(k.x, k.y, k.z, 0.0, 0.0);
}

Sp3Row load_sp3_row(Entries a, uint i) {
  if (!ROW_TEXELS) return Sp3Rows(uvec2(a)).at[i];
  uint t = row_texel_of(uvec2(a)) + SP3_ROWS_HEAD + SP3_ROW_FLOATS * i;
  return Sp3Row(uintBitsToFloat(row_texels3(t)), uintBitsToFloat(row_texels3(t + 3u)),
                uintBitsToFloat(row_texels3(t + 6u)), uintBitsToFloat(row_texel(t + 9u)));
}
#endif

struct Row {
  Entry sum, diagonal;
};

// Row i of RowsRef's row_sum and diagonal, which may be the same.
Row load_row(Entries row_sum, Entries diagonal, uint i) {
#if MOMENTS == 2
  if (ENTRIES == ENTRIES_PACKED) {
    Sp3Row row = load_sp3_row(row_sum, i);
    Boundary boundary = stored_boundary(row_sum);
    return Row(sum_of(entry_of(vec3(0), row.absorption, row.relaxation), boundary_entry(boundary, vec3(row.area))),
               sum_of(entry_of(row.stiffness, 0.4 * row.absorption, 0.4 * row.relaxation),
                      boundary_entry(boundary, vec3(0.5 * row.area))));
  }
#endif
  return Row(load_block(row_sum, i), load_block(diagonal, i));
}

Row load_row(RowsRef rows, uint i) {
  return load_row(rows.row_sum, rows.diagonal, i);
}

// Where only RowsRef's diagonal is known.
Entry load_diagonal(Entries diagonal, uint i) {
  return load_row(diagonal, diagonal, i).diagonal;
}

// Entry e of linear elements, of an edge with this stiffness, these masses and this measure of the surface. Leaves the
// column as it is; returns what is stored.
Entry store_terms(RowsRef rows, uint e, vec3 stiffness, vec3 absorption, vec3 relaxation, float area,
                  Boundary boundary) {
#if MOMENTS == 2
  if (ENTRIES == ENTRIES_PACKED) {
    // The rests from the masses themselves: out of the entry they would come with the noise of the stiffness, and be
    // rounded now this way, now the other.
    float rest12 = boundary.k12 - SP3_SHARE12 * boundary.k11, rest22 = boundary.k22 - SP3_SHARE22 * boundary.k11;
    return store_sp3(rows, e, Sp3Block(stiffness + absorption + boundary.k11 * area,
                                       rest12 * area - SP3_SHARE12 * absorption,
                                       rest22 * area + relaxation - SP3_SHARE22 * absorption));
  }
#endif
  Entry entry = sum_of(entry_of(stiffness, absorption, relaxation), boundary_entry(boundary, vec3(area)));
  return store_entry(rows, e, entry);
}

// Row i of linear elements, from the sums of its masses, its measure of the surface, and the sum of its entries off the
// diagonal as they are stored.
void store_row(RowsRef rows, uint i, vec3 absorption, vec3 relaxation, float area, Boundary boundary, Entry entries) {
#if MOMENTS == 2
  if (ENTRIES == ENTRIES_PACKED) {
    Sp3Rows packed = Sp3Rows(uvec2(rows.row_sum));
    vec3 stiffness = 0.6 * absorption + 0.5 * boundary.k11 * area - entries.a11;
    packed.at[i] = Sp3Row(stiffness, absorption, relaxation, area);
    if (i == 0u) packed.boundary = vec3(boundary.k11, boundary.k12, boundary.k22);
    return;
  }
#endif
  Entry sum = sum_of(entry_of(vec3(0), absorption, relaxation), boundary_entry(boundary, vec3(area)));
  rows.row_sum.at[i] = sum;
  rows.diagonal.at[i] = difference_of(sum, entries);
}

#endif
