// Fields in memory, as VECTORS says.
#ifndef QUADGRAPH_LAYOUTS_VECTORS_GLSL
#define QUADGRAPH_LAYOUTS_VECTORS_GLSL

#include "layout.glsl"

struct WideField {
  vec4 phi;
#if MOMENTS == 2
  vec4 phi2;
#endif
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer WideFields {
  WideField at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer HalfFields {
  uvec2 at[];
};

vec3 plane(Uints vectors, uint i, uint first) {
  Floats values = Floats(vectors);
  return vec3(values.at[first * push.count + i], values.at[(first + 1u) * push.count + i],
              values.at[(first + 2u) * push.count + i]);
}

Field load(Uints vectors, uint i) {
#if VECTORS == VECTORS_PACKED
  return Fields(vectors).at[i];
#elif VECTORS == VECTORS_WIDE
  WideField wide = WideFields(vectors).at[i];
#if MOMENTS == 1
  return Field(wide.phi.xyz);
#else
  return Field(wide.phi.xyz, wide.phi2.xyz);
#endif
#elif VECTORS == VECTORS_PLANES
#if MOMENTS == 1
  return Field(plane(vectors, i, 0u));
#else
  return Field(plane(vectors, i, 0u), plane(vectors, i, 3u));
#endif
#elif MOMENTS == 1
  uvec2 halves = HalfFields(vectors).at[i];
  return Field(vec3(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y).x));
#else
  uvec3 halves = Uvec3s(vectors).at[i];
  vec2 middle = unpackHalf2x16(halves.y);
  return Field(vec3(unpackHalf2x16(halves.x), middle.x), vec3(middle.y, unpackHalf2x16(halves.z)));
#endif
}

void store_plane(Uints vectors, uint i, uint first, vec3 value) {
  Floats values = Floats(vectors);
  for (uint c = 0u; c < 3u; ++c) values.at[(first + c) * push.count + i] = value[c];
}

void store(Uints vectors, uint i, Field value) {
#if VECTORS == VECTORS_PACKED
  Fields(vectors).at[i] = value;
#elif VECTORS == VECTORS_WIDE
#if MOMENTS == 1
  WideFields(vectors).at[i] = WideField(vec4(value.phi, 0.0));
#else
  WideFields(vectors).at[i] = WideField(vec4(value.phi, 0.0), vec4(value.phi2, 0.0));
#endif
#elif VECTORS == VECTORS_PLANES
  store_plane(vectors, i, 0u, value.phi);
#if MOMENTS == 2
  store_plane(vectors, i, 3u, value.phi2);
#endif
#elif MOMENTS == 1
  HalfFields(vectors).at[i] = uvec2(packHalf2x16(value.phi.xy), packHalf2x16(vec2(value.phi.z, 0.0)));
#else
  Uvec3s(vectors).at[i] = uvec3(packHalf2x16(value.phi.xy), packHalf2x16(vec2(value.phi.z, value.phi2.x)),
                                packHalf2x16(value.phi2.yz));
#endif
}

#endif
