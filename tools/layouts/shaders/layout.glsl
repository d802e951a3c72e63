// What every kernel of tools/layouts starts with: one way to keep the matrix and its vectors, chosen by macros.
#ifndef QUADGRAPH_LAYOUTS_LAYOUT_GLSL
#define QUADGRAPH_LAYOUTS_LAYOUT_GLSL

#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "layout_shared.h"
#include "solver/fields.glsl"

#ifndef ROWS
#define ROWS ROWS_SLICED
#endif
#ifndef SLICE
#define SLICE 32u
#endif
#ifndef SORTED
#define SORTED 0
#endif
#ifndef ENTRIES
#define ENTRIES ENTRIES_RGB
#endif
#ifndef COLUMNS
#define COLUMNS 32
#endif
#ifndef COEFFICIENTS
#define COEFFICIENTS COEFFICIENTS_EVEN
#endif
#ifndef VECTORS
#define VECTORS VECTORS_PACKED
#endif

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { LayoutPush push; };

// The row of slot `slot`, in order of storage.
uint row_of(uint slot) {
#if SORTED
  return push.order.at[slot];
#else
  return slot;
#endif
}

#endif
