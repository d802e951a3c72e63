// Vectors of GLSL, but for those of three and four floats (engine/cpu/lanes.h); engine/cpu/glsl.h says what they are
// for. What GLSL writes as v.x is v.x() here, and v.ref_x() where it is assigned to.
#pragma once

#include <cstddef>
#include <cstdint>

namespace quadgraph::cpu::QG_LEVEL {

using uint = std::uint32_t;
struct vec3;

template <typename T>
struct Vec2;
template <typename T>
struct Vec3;
template <typename T>
struct Vec4;

#define QG_MEMBER(name)       \
  constexpr T name() const {  \
    return name##_value;      \
  }                           \
  constexpr T& ref_##name() { \
    return name##_value;      \
  }

#define QG_OPERATOR2(op)                              \
  friend constexpr Vec2 operator op(Vec2 a, Vec2 b) { \
    return {a.x() op b.x(), a.y() op b.y()};          \
  }                                                   \
  friend constexpr Vec2 operator op(Vec2 a, T b) {    \
    return a op Vec2(b);                              \
  }                                                   \
  friend constexpr Vec2 operator op(T a, Vec2 b) {    \
    return Vec2(a) op b;                              \
  }                                                   \
  constexpr Vec2& operator op## = (Vec2 b) {          \
    return *this = *this op b;                        \
  }                                                   \
  constexpr Vec2& operator op## = (T b) {             \
    return *this = *this op b;                        \
  }
#define QG_OPERATOR3(op)                                     \
  friend constexpr Vec3 operator op(Vec3 a, Vec3 b) {        \
    return {a.x() op b.x(), a.y() op b.y(), a.z() op b.z()}; \
  }                                                          \
  friend constexpr Vec3 operator op(Vec3 a, T b) {           \
    return a op Vec3(b);                                     \
  }                                                          \
  friend constexpr Vec3 operator op(T a, Vec3 b) {           \
    return Vec3(a) op b;                                     \
  }                                                          \
  constexpr Vec3& operator op## = (Vec3 b) {                 \
    return *this = *this op b;                               \
  }                                                          \
  constexpr Vec3& operator op## = (T b) {                    \
    return *this = *this op b;                               \
  }

template <typename T>
struct Vec2 {
  T x_value, y_value;
  Vec2() = default;
  constexpr explicit Vec2(T a) : x_value(a), y_value(a) {}
  template <typename A, typename B>
  constexpr Vec2(A a, B b) : x_value(T(a)), y_value(T(b)) {}
  template <typename U>
  constexpr explicit Vec2(Vec2<U> a) : Vec2(a.x(), a.y()) {}
  template <typename U>
  constexpr explicit Vec2(Vec3<U> a) : Vec2(a.x(), a.y()) {}
  constexpr T& operator[](std::size_t i) { return (&x_value)[i]; }
  constexpr T operator[](std::size_t i) const { return (&x_value)[i]; }
  friend constexpr bool operator==(Vec2 a, Vec2 b) { return a.x() == b.x() && a.y() == b.y(); }
  constexpr Vec2 operator-() const { return {-x(), -y()}; }
  QG_MEMBER(x) QG_MEMBER(y) QG_OPERATOR2(+) QG_OPERATOR2(-) QG_OPERATOR2(*) QG_OPERATOR2(/)
};

template <typename T>
struct Vec3 {
  T x_value, y_value, z_value;
  Vec3() = default;
  constexpr explicit Vec3(T a) : x_value(a), y_value(a), z_value(a) {}
  template <typename A, typename B, typename C>
  constexpr Vec3(A a, B b, C c) : x_value(T(a)), y_value(T(b)), z_value(T(c)) {}
  template <typename A, typename U>
  constexpr Vec3(A a, Vec2<U> b) : Vec3(a, b.x(), b.y()) {}
  template <typename A, typename U>
  constexpr Vec3(Vec2<U> a, A b) : Vec3(a.x(), a.y(), b) {}
  template <typename U>
  constexpr explicit Vec3(Vec3<U> a) : Vec3(a.x(), a.y(), a.z()) {}
  template <typename U>
  constexpr explicit Vec3(Vec4<U> a) : Vec3(a.x(), a.y(), a.z()) {}
  inline explicit Vec3(vec3 a);
  constexpr T& operator[](std::size_t i) { return (&x_value)[i]; }
  constexpr T operator[](std::size_t i) const { return (&x_value)[i]; }
  friend constexpr bool operator==(Vec3 a, Vec3 b) { return a.x() == b.x() && a.y() == b.y() && a.z() == b.z(); }
  constexpr Vec3 operator-() const { return {-x(), -y(), -z()}; }
  constexpr Vec2<T> xy() const { return {x(), y()}; }
  constexpr Vec2<T> yz() const { return {y(), z()}; }
  constexpr Vec3 yzx() const { return {y(), z(), x()}; }
  constexpr Vec3 zyx() const { return {z(), y(), x()}; }
  constexpr Vec3 zxy() const { return {z(), x(), y()}; }
  QG_MEMBER(x) QG_MEMBER(y) QG_MEMBER(z) QG_OPERATOR3(+) QG_OPERATOR3(-) QG_OPERATOR3(*) QG_OPERATOR3(/)
};

template <typename T>
struct Vec4 {
  T x_value, y_value, z_value, w_value;
  Vec4() = default;
  constexpr explicit Vec4(T a) : Vec4(a, a, a, a) {}
  template <typename A, typename B, typename C, typename D>
  constexpr Vec4(A a, B b, C c, D d) : x_value(T(a)), y_value(T(b)), z_value(T(c)), w_value(T(d)) {}
  constexpr T& operator[](std::size_t i) { return (&x_value)[i]; }
  constexpr T operator[](std::size_t i) const { return (&x_value)[i]; }
  constexpr Vec3<T> xyz() const { return {x(), y(), z()}; }
  constexpr Vec2<T> xy() const { return {x(), y()}; }
  constexpr Vec2<T> zw() const { return {z(), w()}; }
  QG_MEMBER(x) QG_MEMBER(y) QG_MEMBER(z) QG_MEMBER(w)
};

using vec2 = Vec2<float>;
using ivec2 = Vec2<int>;
using ivec3 = Vec3<int>;
using ivec4 = Vec4<int>;
using uvec2 = Vec2<uint>;
using uvec3 = Vec3<uint>;
using uvec4 = Vec4<uint>;
using bvec2 = Vec2<bool>;

// Bits and remainders, where shaders use them.
#define QG_BITS_OPERATOR(op)                      \
  template <typename T>                           \
  constexpr Vec3<T> operator op(Vec3<T> a, T b) { \
    return {a.x() op b, a.y() op b, a.z() op b};  \
  }                                               \
  template <typename T>                           \
  constexpr Vec2<T> operator op(Vec2<T> a, T b) { \
    return {a.x() op b, a.y() op b};              \
  }
QG_BITS_OPERATOR(&)
QG_BITS_OPERATOR(>>)
QG_BITS_OPERATOR(<<)
QG_BITS_OPERATOR(%)
template <typename T>
constexpr Vec3<T> operator|(Vec3<T> a, Vec3<T> b) {
  return {a.x() | b.x(), a.y() | b.y(), a.z() | b.z()};
}
template <typename T>
constexpr Vec3<T> operator%(Vec3<T> a, Vec3<T> b) {
  return {a.x() % b.x(), a.y() % b.y(), a.z() % b.z()};
}
constexpr bvec2 operator!(bvec2 a) {
  return {!a.x(), !a.y()};
}

}  // namespace quadgraph::cpu::QG_LEVEL
