// Products with rows as ROWS says.
#ifndef QUADGRAPH_LAYOUTS_ROWS_GLSL
#define QUADGRAPH_LAYOUTS_ROWS_GLSL

#include "entries.glsl"

struct Units {
  uint first, end, step;
};

// What slot `slot` holds, and in `base` the bases of its 16-bit columns.
Units units_of(uint slot, out uvec2 base) {
  base = uvec2(0);
#if ROWS == ROWS_CSR
  return Units(push.offset.at[slot], push.offset.at[slot + 1u], 1u);
#elif ROWS == ROWS_CSR_SUBGROUP
  return Units(push.offset.at[slot] + gl_SubgroupInvocationID, push.offset.at[slot + 1u], gl_SubgroupSize);
#elif ROWS == ROWS_ELL
  return Units(slot, push.width * push.count, push.count);
#elif COLUMNS == 32
  uint slice = slot / SLICE;
  return Units(push.offset.at[slice] + slot % SLICE, push.offset.at[slice + 1u], SLICE);
#else
  uint at = 3u * (slot / SLICE);
  base = uvec2(push.offset.at[at + 1u], push.offset.at[at + 2u]);
  return Units(push.offset.at[at] + slot % SLICE, push.offset.at[at + 3u], SLICE);
#endif
}

Row row_at(uint i, Field own) {
  Row row;
  row.i = i;
  row.own = own;
#if GEOMETRIC || ENTRIES == ENTRIES_STIFFNESS_HALF || ENTRIES == ENTRIES_HALF
  row.constants = push.constants.at[0];
#endif
#if COEFFICIENTS == COEFFICIENTS_EDGE
  row.coefficients = push.coefficients.at[i];
#endif
  return row;
}

// (A x)_i for the row in slot `slot`; with a subgroup for every row, the part of this invocation.
Field row_times(uint slot, inout Row row) {
  Units units = units_of(slot, row.base);
  Field sum = times(row_sum_of(row), row.own);
#if ROWS == ROWS_CSR_SUBGROUP
  if (gl_SubgroupInvocationID != 0u) sum = no_field();
#endif
  for (uint e = units.first; e < units.end; e += units.step) sum = add_unit(sum, row, e);
  return sum;
}

#endif
