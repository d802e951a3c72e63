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
  uint e = rows.slice_offset.at[slice] + i % SLICE_ROWS;
#ifndef QG_PROCESSOR
  // Memory is asked for four entries and what they multiply before any of them is waited for.
  for (; e + 3u * SLICE_ROWS < end; e += 4u * SLICE_ROWS) {
    StoredEntry a = stored_entry(rows, e), b = stored_entry(rows, e + SLICE_ROWS);
    StoredEntry c = stored_entry(rows, e + 2u * SLICE_ROWS), d = stored_entry(rows, e + 3u * SLICE_ROWS);
    Field x_a = x.at[column_of(a)], x_b = x.at[column_of(b)], x_c = x.at[column_of(c)], x_d = x.at[column_of(d)];
    sum = add(sum, times(entry_in(a), difference(x_a, own)));
    sum = add(sum, times(entry_in(b), difference(x_b, own)));
    sum = add(sum, times(entry_in(c), difference(x_c, own)));
    sum = add(sum, times(entry_in(d), difference(x_d, own)));
  }
#endif
  for (; e < end; e += SLICE_ROWS) {
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
