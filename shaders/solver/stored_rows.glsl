// The blocks of an operator's rows beside its entries (RowsRef): reading and writing.
#ifndef QUADGRAPH_STORED_ROWS_GLSL
#define QUADGRAPH_STORED_ROWS_GLSL

#include "solver/entries.glsl"
#include "solver/solve_shared.h"
#include "solver/stored_entries.glsl"

#if MOMENTS == 2
// Rows beside packed entries (packing.h).
QG_HEADED_ARRAY(Sp3Rows, Sp3Head, head, Sp3Row);

#endif

struct Row {
  Entry sum, diagonal;
};

// Row i of RowsRef's row_sum and diagonal, which may be the same.
Row load_row(Entries row_sum, Entries diagonal, uint i) {
#if MOMENTS == 2
  if (ENTRIES == ENTRIES_PACKED) {
    Sp3Row row = Sp3Rows(uvec2(row_sum)).at[i];
    Sp3Head head = Sp3Rows(uvec2(row_sum)).head;
    Boundary boundary = Boundaries(head.boundaries).at[floatBitsToUint(row.area) & head.bodies];
    return Row(sum_of(entry_of(vec3(0), row.absorption, row.relaxation), boundary_entry(boundary, vec3(row.area))),
               sum_of(entry_of(row.stiffness, 0.4 * row.absorption, 0.4 * row.relaxation),
                      boundary_entry(boundary, vec3(0.5 * row.area))));
  }
#endif
  return Row(row_sum.at[i], diagonal.at[i]);
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

// Boundaries of all bodies, and the body of a row, 0 of one without a surface. bodies: as of Sp3Head.
struct RowBoundary {
  Boundaries all;
  uint body, bodies;
};

// Row i of linear elements, from the sums of its masses, its measure of the surface, and the sum of its entries off the
// diagonal as they are stored.
void store_row(RowsRef rows, uint i, vec3 absorption, vec3 relaxation, float area, RowBoundary own, Entry entries) {
  Boundary boundary = own.all.at[own.body];
#if MOMENTS == 2
  if (ENTRIES == ENTRIES_PACKED) {
    Sp3Rows sp3_rows = Sp3Rows(uvec2(rows.row_sum));
    vec3 stiffness = 0.6 * absorption + 0.5 * boundary.k11 * area - entries.a11;
    sp3_rows.at[i] = Sp3Row(stiffness, absorption, relaxation, area_of_body(area, own.body, own.bodies));
    if (i == 0u) sp3_rows.head = Sp3Head(uvec2(own.all), own.bodies);
    return;
  }
#endif
  Entry sum = sum_of(entry_of(vec3(0), absorption, relaxation), boundary_entry(boundary, vec3(area)));
  rows.row_sum.at[i] = sum;
  rows.diagonal.at[i] = difference_of(sum, entries);
}

#endif
