// Vectors of GLSL; engine/cpu/glsl.h says what they are for.
#pragma once

#include <cstddef>
#include <cstdint>

namespace quadgraph::cpu::QG_LEVEL {

using uint = std::uint32_t;

template <typename T>
struct Vec2;
template <typename T>
struct Vec3;
template <typename T>
struct Vec4;

#define QG_OPERATOR2(op)                              \
  friend constexpr Vec2 operator op(Vec2 a, Vec2 b) { \
    return {T(a.x op b.x), T(a.y op b.y)};            \
  }                                                   \
  friend constexpr Vec2 operator op(Vec2 a, T b) {    \
    return {T(a.x op b), T(a.y op b)};                \
  }                                                   \
  friend constexpr Vec2 operator op(T a, Vec2 b) {    \
    return {T(a op b.x), T(a op b.y)};                \
  }                                                   \
  constexpr Vec2& operator op## = (Vec2 b) {          \
    return *this = *this op b;                        \
  }                                                   \
  constexpr Vec2& operator op## = (T b) {             \
    return *this = *this op b;                        \
  }
#define QG_OPERATOR3(op)                                  \
  friend constexpr Vec3 operator op(Vec3 a, Vec3 b) {     \
    return {T(a.x op b.x), T(a.y op b.y), T(a.z op b.z)}; \
  }                                                       \
  friend constexpr Vec3 operator op(Vec3 a, T b) {        \
    return {T(a.x op b), T(a.y op b), T(a.z op b)};       \
  }                                                       \
  friend constexpr Vec3 operator op(T a, Vec3 b) {        \
    return {T(a op b.x), T(a op b.y), T(a op b.z)};       \
  }                                                       \
  constexpr Vec3& operator op## = (Vec3 b) {              \
    return *this = *this op b;                            \
  }                                                       \
  constexpr Vec3& operator op## = (T b) {                 \
    return *this = *this op b;                            \
  }
#define QG_OPERATOR4(op)                                                 \
  friend constexpr Vec4 operator op(Vec4 a, Vec4 b) {                    \
    return {T(a.x op b.x), T(a.y op b.y), T(a.z op b.z), T(a.w op b.w)}; \
  }                                                                      \
  friend constexpr Vec4 operator op(Vec4 a, T b) {                       \
    return {T(a.x op b), T(a.y op b), T(a.z op b), T(a.w op b)};         \
  }                                                                      \
  friend constexpr Vec4 operator op(T a, Vec4 b) {                       \
    return {T(a op b.x), T(a op b.y), T(a op b.z), T(a op b.w)};         \
  }                                                                      \
  constexpr Vec4& operator op## = (Vec4 b) {                             \
    return *this = *this op b;                                           \
  }                                                                      \
  constexpr Vec4& operator op## = (T b) {                                \
    return *this = *this op b;                                           \
  }

template <typename T>
struct Vec2 {
  T x, y;
  Vec2() = default;
  constexpr explicit Vec2(T a) : x(a), y(a) {}
  template <typename A, typename B>
  constexpr Vec2(A a, B b) : x(T(a)), y(T(b)) {}
  template <typename U>
  constexpr explicit Vec2(Vec2<U> a) : x(T(a.x)), y(T(a.y)) {}
  template <typename U>
  constexpr explicit Vec2(Vec3<U> a) : x(T(a.x)), y(T(a.y)) {}
  constexpr T& operator[](std::size_t i) { return (&x)[i]; }
  constexpr T operator[](std::size_t i) const { return (&x)[i]; }
  friend constexpr bool operator==(Vec2 a, Vec2 b) { return a.x == b.x && a.y == b.y; }
  constexpr Vec2 operator-() const { return {T(-x), T(-y)}; }
  QG_OPERATOR2(+) QG_OPERATOR2(-) QG_OPERATOR2(*) QG_OPERATOR2(/) constexpr Vec2 yx() const { return {y, x}; }
};

template <typename T>
struct Vec3 {
  T x, y, z;
  Vec3() = default;
  constexpr explicit Vec3(T a) : x(a), y(a), z(a) {}
  template <typename A, typename B, typename C>
  constexpr Vec3(A a, B b, C c) : x(T(a)), y(T(b)), z(T(c)) {}
  template <typename U, typename C>
  constexpr Vec3(Vec2<U> a, C c) : x(T(a.x)), y(T(a.y)), z(T(c)) {}
  template <typename U, typename A>
  constexpr Vec3(A a, Vec2<U> b) : x(T(a)), y(T(b.x)), z(T(b.y)) {}
  template <typename U>
  constexpr explicit Vec3(Vec3<U> a) : x(T(a.x)), y(T(a.y)), z(T(a.z)) {}
  template <typename U>
  constexpr explicit Vec3(Vec4<U> a) : x(T(a.x)), y(T(a.y)), z(T(a.z)) {}
  constexpr T& operator[](std::size_t i) { return (&x)[i]; }
  constexpr T operator[](std::size_t i) const { return (&x)[i]; }
  friend constexpr bool operator==(Vec3 a, Vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
  constexpr Vec3 operator-() const { return {T(-x), T(-y), T(-z)}; }
  QG_OPERATOR3(+) QG_OPERATOR3(-) QG_OPERATOR3(*) QG_OPERATOR3(/) constexpr Vec2<T> xy() const { return {x, y}; }
  constexpr Vec2<T> xz() const { return {x, z}; }
  constexpr Vec2<T> yz() const { return {y, z}; }
  constexpr Vec3 yzx() const { return {y, z, x}; }
  constexpr Vec3 zyx() const { return {z, y, x}; }
  constexpr Vec3 zxy() const { return {z, x, y}; }
};

template <typename T>
struct Vec4 {
  T x, y, z, w;
  Vec4() = default;
  constexpr explicit Vec4(T a) : x(a), y(a), z(a), w(a) {}
  template <typename A, typename B, typename C, typename D>
  constexpr Vec4(A a, B b, C c, D d) : x(T(a)), y(T(b)), z(T(c)), w(T(d)) {}
  template <typename U, typename D>
  constexpr Vec4(Vec3<U> a, D d) : x(T(a.x)), y(T(a.y)), z(T(a.z)), w(T(d)) {}
  template <typename U, typename A>
  constexpr Vec4(A a, Vec3<U> b) : x(T(a)), y(T(b.x)), z(T(b.y)), w(T(b.z)) {}
  template <typename U, typename V>
  constexpr Vec4(Vec2<U> a, Vec2<V> b) : x(T(a.x)), y(T(a.y)), z(T(b.x)), w(T(b.y)) {}
  template <typename U>
  constexpr explicit Vec4(Vec4<U> a) : x(T(a.x)), y(T(a.y)), z(T(a.z)), w(T(a.w)) {}
  constexpr T& operator[](std::size_t i) { return (&x)[i]; }
  constexpr T operator[](std::size_t i) const { return (&x)[i]; }
  friend constexpr bool operator==(Vec4 a, Vec4 b) { return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w; }
  constexpr Vec4 operator-() const { return {T(-x), T(-y), T(-z), T(-w)}; }
  QG_OPERATOR4(+) QG_OPERATOR4(-) QG_OPERATOR4(*) QG_OPERATOR4(/) constexpr Vec3<T> xyz() const { return {x, y, z}; }
  constexpr Vec2<T> xy() const { return {x, y}; }
  constexpr Vec2<T> zw() const { return {z, w}; }
};

using vec2 = Vec2<float>;
using vec3 = Vec3<float>;
using vec4 = Vec4<float>;
using ivec2 = Vec2<int>;
using ivec3 = Vec3<int>;
using ivec4 = Vec4<int>;
using uvec2 = Vec2<uint>;
using uvec3 = Vec3<uint>;
using uvec4 = Vec4<uint>;
using bvec2 = Vec2<bool>;
using bvec3 = Vec3<bool>;
using bvec4 = Vec4<bool>;

// Bits and remainders, where shaders use them.
inline uvec3 operator&(uvec3 a, uint b) {
  return {a.x & b, a.y & b, a.z & b};
}
inline uvec3 operator|(uvec3 a, uvec3 b) {
  return {a.x | b.x, a.y | b.y, a.z | b.z};
}
inline uvec3 operator<<(uvec3 a, uint b) {
  return {a.x << b, a.y << b, a.z << b};
}
inline uvec3 operator>>(uvec3 a, uint b) {
  return {a.x >> b, a.y >> b, a.z >> b};
}
inline ivec3 operator&(ivec3 a, int b) {
  return {a.x & b, a.y & b, a.z & b};
}
inline ivec3 operator>>(ivec3 a, int b) {
  return {a.x >> b, a.y >> b, a.z >> b};
}
template <typename T>
inline Vec3<T> operator%(Vec3<T> a, T b) {
  return {a.x % b, a.y % b, a.z % b};
}
template <typename T>
inline Vec3<T> operator%(Vec3<T> a, Vec3<T> b) {
  return {a.x % b.x, a.y % b.y, a.z % b.z};
}
inline uvec2 operator&(uvec2 a, uint b) {
  return {a.x & b, a.y & b};
}
inline uvec2 operator>>(uvec2 a, uint b) {
  return {a.x >> b, a.y >> b};
}
inline bvec3 operator!(bvec3 a) {
  return {!a.x, !a.y, !a.z};
}
inline bvec2 operator!(bvec2 a) {
  return {!a.x, !a.y};
}

}  // namespace quadgraph::cpu::QG_LEVEL
