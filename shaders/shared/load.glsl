// load_TYPE(array, i), and load_row_TYPE and load_assembly_TYPE: array.at[i], the way that is fast on the device
// (engine/vk/arena.h). Arrays that are loaded so lie in buffers of the place that belongs to their type
// (engine/vk/memory.h). An arena whose bit is set in IN_TEXELS is a buffer of 32-bit texels, the first of which has an
// address that ends in ..._AT: of what lies there that is enough.
#ifndef QUADGRAPH_LOAD_GLSL
#define QUADGRAPH_LOAD_GLSL

#extension GL_EXT_buffer_reference_uvec2 : require

#include "shared/buffers.glsl"

layout(constant_id = 0) const uint IN_TEXELS = 0u;
layout(constant_id = 2) const uint READ_AT = 0u;
layout(constant_id = 3) const uint ROWS_AT = 0u;
layout(constant_id = 4) const uint FIELDS_AT = 0u;
layout(constant_id = 5) const uint ASSEMBLY_AT = 0u;
const bool TEXELS = (IN_TEXELS & 1u) != 0u;
const bool ROW_TEXELS = (IN_TEXELS & 2u) != 0u;
const bool FIELD_TEXELS = (IN_TEXELS & 4u) != 0u;
const bool ASSEMBLY_TEXELS = (IN_TEXELS & 8u) != 0u;
layout(set = 0, binding = 0, r32ui) coherent readonly uniform uimageBuffer texels;
layout(set = 0, binding = 1, r32ui) coherent readonly uniform uimageBuffer row_texels;
layout(set = 0, binding = 2, r32ui) coherent readonly uniform uimageBuffer field_texels;
layout(set = 0, binding = 3, r32ui) coherent readonly uniform uimageBuffer assembly_texels;

// The texel that an address means, and texels, of one arena.
#define QG_ARENA(image, first, texel_of, texel, texels2, texels3) \
  uint texel_of(uvec2 address) {                                  \
    return (address.x - first) >> 2u;                             \
  }                                                               \
  uint texel(uint i) {                                            \
    return imageLoad(image, int(i)).x;                            \
  }                                                               \
  uvec2 texels2(uint i) {                                         \
    return uvec2(texel(i), texel(i + 1u));                        \
  }                                                               \
  uvec3 texels3(uint i) {                                         \
    return uvec3(texel(i), texel(i + 1u), texel(i + 2u));         \
  }

QG_ARENA(texels, READ_AT, texel_of, texel, texels2, texels3)
QG_ARENA(row_texels, ROWS_AT, row_texel_of, row_texel, row_texels2, row_texels3)
QG_ARENA(field_texels, FIELDS_AT, field_texel_of, field_texel, field_texels2, field_texels3)
QG_ARENA(assembly_texels, ASSEMBLY_AT, assembly_texel_of, assembly_texel, assembly_texels2, assembly_texels3)

uvec4 texels4(uint i) {
  return uvec4(texel(i), texel(i + 1u), texel(i + 2u), texel(i + 3u));
}

mat4 mat4_in_texels(uint i) {
  return mat4(uintBitsToFloat(texels4(i)), uintBitsToFloat(texels4(i + 4u)), uintBitsToFloat(texels4(i + 8u)),
              uintBitsToFloat(texels4(i + 12u)));
}

uint load_uint(Uints a, uint i) {
  if (TEXELS) return texel(texel_of(uvec2(a)) + i);
  return a.at[i];
}

uvec2 load_uvec2(Uvec2s a, uint i) {
  if (TEXELS) return texels2(texel_of(uvec2(a)) + 2u * i);
  return a.at[i];
}

uvec3 load_uvec3(Uvec3s a, uint i) {
  if (TEXELS) return texels3(texel_of(uvec2(a)) + 3u * i);
  return a.at[i];
}

uvec4 load_uvec4(Uvec4s a, uint i) {
  if (TEXELS) return texels4(texel_of(uvec2(a)) + 4u * i);
  return a.at[i];
}

// a.at[i][k].
uint load_component(Uvec4s a, uint i, uint k) {
  if (TEXELS) return texel(texel_of(uvec2(a)) + 4u * i + k);
  return a.at[i][k];
}

float load_float(Floats a, uint i) {
  if (TEXELS) return uintBitsToFloat(texel(texel_of(uvec2(a)) + i));
  return a.at[i];
}

vec2 load_vec2(Vec2s a, uint i) {
  if (TEXELS) return uintBitsToFloat(texels2(texel_of(uvec2(a)) + 2u * i));
  return a.at[i];
}

vec3 load_vec3(Vec3s a, uint i) {
  if (TEXELS) return uintBitsToFloat(texels3(texel_of(uvec2(a)) + 3u * i));
  return a.at[i];
}

// The same; 1 everywhere if there is no array.
vec3 load_vec3_or_one(Vec3s a, uint i) {
  if (uvec2(a) == uvec2(0)) return vec3(1);
  return load_vec3(a, i);
}

vec4 load_vec4(Vec4s a, uint i) {
  if (TEXELS) return uintBitsToFloat(texels4(texel_of(uvec2(a)) + 4u * i));
  return a.at[i];
}

uint load_row_uint(RowUints a, uint i) {
  if (ROW_TEXELS) return row_texel(row_texel_of(uvec2(a)) + i);
  return a.at[i];
}

float load_row_float(RowFloats a, uint i) {
  if (ROW_TEXELS) return uintBitsToFloat(row_texel(row_texel_of(uvec2(a)) + i));
  return a.at[i];
}

uint load_assembly_uint(AssemblyUints a, uint i) {
  if (ASSEMBLY_TEXELS) return assembly_texel(assembly_texel_of(uvec2(a)) + i);
  return a.at[i];
}

uvec2 load_assembly_uvec2(AssemblyUvec2s a, uint i) {
  if (ASSEMBLY_TEXELS) return assembly_texels2(assembly_texel_of(uvec2(a)) + 2u * i);
  return a.at[i];
}

float load_assembly_float(AssemblyFloats a, uint i) {
  if (ASSEMBLY_TEXELS) return uintBitsToFloat(assembly_texel(assembly_texel_of(uvec2(a)) + i));
  return a.at[i];
}

vec2 load_assembly_vec2(AssemblyVec2s a, uint i) {
  if (ASSEMBLY_TEXELS) return uintBitsToFloat(assembly_texels2(assembly_texel_of(uvec2(a)) + 2u * i));
  return a.at[i];
}

#endif
