// Matrices of GLSL, columns first; engine/cpu/glsl.h says what they are for.
#pragma once

#include "engine/cpu/lane_functions.h"

namespace quadgraph::cpu::QG_LEVEL {

struct mat3 {
  vec3 column[3];
  mat3() = default;
  explicit mat3(float d) : column{vec3(d, 0, 0), vec3(0, d, 0), vec3(0, 0, d)} {}
  mat3(vec3 a, vec3 b, vec3 c) : column{a, b, c} {}
  vec3& operator[](std::size_t i) { return column[i]; }
  const vec3& operator[](std::size_t i) const { return column[i]; }
};
inline vec3 operator*(const mat3& m, vec3 v) {
  return m[0] * v.x() + m[1] * v.y() + m[2] * v.z();
}
inline vec3 operator*(vec3 v, const mat3& m) {
  return {dot(v, m[0]), dot(v, m[1]), dot(v, m[2])};
}
inline mat3 operator*(const mat3& a, const mat3& b) {
  return {a * b[0], a * b[1], a * b[2]};
}
inline mat3 operator*(float s, const mat3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline mat3 operator*(const mat3& a, float s) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline mat3 operator/(const mat3& a, float s) {
  return {a[0] / s, a[1] / s, a[2] / s};
}
inline mat3 operator+(const mat3& a, const mat3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline mat3 operator-(const mat3& a, const mat3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline mat3& operator+=(mat3& a, const mat3& b) {
  return a = a + b;
}
inline float determinant(const mat3& m) {
  return dot(m[0], cross(m[1], m[2]));
}
inline mat3 transpose(const mat3& m) {
  return {vec3(m[0].x(), m[1].x(), m[2].x()), vec3(m[0].y(), m[1].y(), m[2].y()), vec3(m[0].z(), m[1].z(), m[2].z())};
}
inline mat3 inverse(const mat3& m) {
  vec3 a = cross(m[1], m[2]), b = cross(m[2], m[0]), c = cross(m[0], m[1]);
  return transpose(mat3(a, b, c)) / dot(m[0], a);
}
inline mat3 outerProduct(vec3 a, vec3 b) {
  return {a * b.x(), a * b.y(), a * b.z()};
}

struct mat4 {
  vec4 column[4];
  mat4() = default;
  mat4(vec4 a, vec4 b, vec4 c, vec4 d) : column{a, b, c, d} {}
  vec4& operator[](std::size_t i) { return column[i]; }
  vec4 operator[](std::size_t i) const { return column[i]; }
};
inline vec4 operator*(const mat4& m, vec4 v) {
  return m[0] * v.x() + m[1] * v.y() + m[2] * v.z() + m[3] * v.w();
}

}  // namespace quadgraph::cpu::QG_LEVEL
