// Products with operator rows.

// sum_k weight_k x_column_k of row i, without the diagonal.
vec3 off_diagonal(RowsRef rows, Vec3s x, uint i) {
  uint slice = i / SLICE_ROWS;
  uint end = rows.slice_offset.at[slice + 1u];
  vec3 sum = vec3(0);
  for (uint e = rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    sum += rows.weight.at[e] * x.at[rows.column.at[e]];
  }
  return sum;
}

// (b - A x)_i.
vec3 residual(RowsRef rows, Vec3s b, Vec3s x, uint i) {
  return b.at[i] - rows.diagonal.at[i] * x.at[i] - off_diagonal(rows, x, i);
}
