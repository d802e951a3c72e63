// Products with operator rows.
#ifndef QUADGRAPH_ROWS_GLSL
#define QUADGRAPH_ROWS_GLSL

#include "material/optics.h"
#include "solver/fields.glsl"
#include "solver/stored_rows.glsl"

// (A x)_i; `row_sum` is of row i.
Field row_times(RowsRef rows, Entry row_sum, Fields x, uint i) {
  uint slice = i / SLICE_ROWS;
  uint end = rows.slice_offset.at[slice + 1u];
  Field own = x.at[i];
  Field sum = times(row_sum, own);
  for (uint e = rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    StoredEntry stored = stored_entry(rows, e);
    sum = add(sum, times(entry_in(stored), difference(x.at[column_of(stored)], own)));
  }
  return sum;
}

// (b - A x)_i.
Field residual(RowsRef rows, Entry row_sum, Fields b, Fields x, uint i) {
  return difference(b.at[i], row_times(rows, row_sum, x, i));
}

#endif
