// Products with operator rows; include after fields.glsl.
#include "stored_entries.glsl"

// (A x)_i.
Field row_times(RowsRef rows, Fields x, uint i) {
  uint slice = i / SLICE_ROWS;
  uint end = load_row_uint(rows.slice_offset, slice + 1u);
  Field own = load_field(x, i);
  Field sum = times(load_block(rows.row_sum, i), own);
  for (uint e = load_row_uint(rows.slice_offset, slice) + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    StoredEntry stored = stored_entry(rows, e);
    sum = add(sum, times(entry_in(stored), difference(load_field(x, column_of(stored)), own)));
  }
  return sum;
}

// (b - A x)_i.
Field residual(RowsRef rows, Fields b, Fields x, uint i) {
  return difference(load_field(b, i), row_times(rows, x, i));
}
