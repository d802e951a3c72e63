// load_TYPE(array, i): array.at[i], the way that is fast on the device (engine/vk/arena.h). Arrays that are loaded so
// lie in buffers of Place::read. TEXELS: all of them are one buffer of 32-bit texels, the first of which has the
// address TEXELS_AT, of which the low word is enough.
#extension GL_EXT_buffer_reference_uvec2 : require

layout(constant_id = 0) const bool TEXELS = false;
layout(constant_id = 1) const uint TEXELS_AT = 0u;
layout(set = 0, binding = 0, r32ui) coherent readonly uniform uimageBuffer texels;

// The texel that an address means.
uint texel_of(uvec2 address) {
  return (address.x - TEXELS_AT) >> 2u;
}

uint texel(uint i) {
  return imageLoad(texels, int(i)).x;
}

uvec2 texels2(uint i) {
  return uvec2(texel(i), texel(i + 1u));
}

uvec3 texels3(uint i) {
  return uvec3(texel(i), texel(i + 1u), texel(i + 2u));
}

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
