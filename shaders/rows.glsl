// Products with operator rows; include after fields.glsl.

// (A x)_i.
Field row_times(RowsRef rows, Fields x, uint i) {
  uint slice = i / SLICE_ROWS;
  uint end = rows.slice_offset.at[slice + 1u];
  Field own = x.at[i];
  Field sum = times(rows.row_sum.at[i], own);
  for (uint e = rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    sum = add(sum, times(rows.weight.at[e], difference(x.at[rows.column.at[e]], own)));
  }
  return sum;
}

// (b - A x)_i.
Field residual(RowsRef rows, Fields b, Fields x, uint i) {
  return difference(b.at[i], row_times(rows, x, i));
}
