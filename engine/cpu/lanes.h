// Vectors of three and four floats, in one register each; engine/cpu/glsl.h says what they are for. In a vector of
// three, the last lane holds anything. What lies in memory is packed_vec3; four floats lie there as they are.
#pragma once

#include "engine/cpu/vectors.h"

namespace quadgraph::cpu::QG_LEVEL {

using Lanes = float __attribute__((vector_size(16)));
using StoredLanes = float __attribute__((vector_size(16), aligned(4)));
using LongLanes = long long __attribute__((vector_size(16)));
using IntLanes = int __attribute__((vector_size(16)));

// One lane that can be assigned to.
template <typename Stored>
struct Lane {
  Stored& lanes;
  std::size_t i;

  operator float() const { return lanes[i]; }
  float operator=(float value) const {
    if (__builtin_constant_p(i)) {
      lanes[i] = value;
    } else {  // in the register: of what is written to memory in part, the whole could not be read at once
      lanes = IntLanes{0, 1, 2, 3} == static_cast<int>(i) ? value - Lanes{} : Lanes(lanes);
    }
    return value;
  }
  float operator=(const Lane& other) const { return *this = float(other); }
  float operator+=(float value) const { return *this = lanes[i] + value; }
  float operator-=(float value) const { return *this = lanes[i] - value; }
  float operator*=(float value) const { return *this = lanes[i] * value; }
  float operator/=(float value) const { return *this = lanes[i] / value; }
};

#define QG_LANE(name, i)      \
  float name() const {        \
    return lanes[i];          \
  }                           \
  Lane<Stored> ref_##name() { \
    return {lanes, i};        \
  }
#define QG_LANES                           \
  Lane<Stored> operator[](std::size_t i) { \
    return {lanes, i};                     \
  }                                        \
  float operator[](std::size_t i) const {  \
    return lanes[i];                       \
  }
struct vec4;

struct vec3 {
  using Stored = Lanes;
  Stored lanes;
  vec3() = default;
  explicit vec3(Lanes a) : lanes(a) {}
  explicit vec3(float a) : lanes{a, a, a, a} {}
  vec3(float a, float b, float c) : lanes{a, b, c, 0} {}
  vec3(vec2 a, float b) : vec3(a.x(), a.y(), b) {}
  vec3(float a, vec2 b) : vec3(a, b.x(), b.y()) {}
  template <typename T>
  explicit vec3(Vec3<T> a) : vec3(a.x(), a.y(), a.z()) {}
  explicit vec3(ivec3 a) : lanes(__builtin_convertvector((IntLanes{a.x(), a.y(), a.z(), 0}), Lanes)) {}
  inline explicit vec3(vec4 a);
  vec2 xy() const { return {x(), y()}; }
  vec2 xz() const { return {x(), z()}; }
  vec2 yz() const { return {y(), z()}; }
  vec3 yzx() const { return vec3(__builtin_shuffle(lanes, IntLanes{1, 2, 0, 3})); }
  vec3 zxy() const { return vec3(__builtin_shuffle(lanes, IntLanes{2, 0, 1, 3})); }
  vec3 zyx() const { return vec3(__builtin_shuffle(lanes, IntLanes{2, 1, 0, 3})); }
  QG_LANES QG_LANE(x, 0) QG_LANE(y, 1) QG_LANE(z, 2)
};

struct vec4 {
  using Stored = StoredLanes;
  Stored lanes;
  vec4() = default;
  explicit vec4(Lanes a) : lanes(a) {}
  explicit vec4(float a) : lanes{a, a, a, a} {}
  vec4(float a, float b, float c, float d) : lanes{a, b, c, d} {}
  vec4(vec3 a, float b) : vec4(a.x(), a.y(), a.z(), b) {}
  vec4(float a, vec3 b) : vec4(a, b.x(), b.y(), b.z()) {}
  vec4(vec2 a, vec2 b) : vec4(a.x(), a.y(), b.x(), b.y()) {}
  template <typename T>
  explicit vec4(Vec4<T> a) : vec4(a.x(), a.y(), a.z(), a.w()) {}
  vec3 xyz() const { return vec3(Lanes(lanes)); }
  vec2 xy() const { return {x(), y()}; }
  vec2 zw() const { return {z(), w()}; }
  QG_LANES QG_LANE(x, 0) QG_LANE(y, 1) QG_LANE(z, 2) QG_LANE(w, 3)
};

inline vec3::vec3(vec4 a) : lanes(a.lanes) {}
template <typename T>
inline Vec3<T>::Vec3(vec3 a) : Vec3(a.x(), a.y(), a.z()) {}

#define QG_LANES_OPERATOR(Vector, op)                \
  inline Vector operator op(Vector a, Vector b) {    \
    return Vector(Lanes(a.lanes) op b.lanes);        \
  }                                                  \
  inline Vector operator op(Vector a, float b) {     \
    return Vector(Lanes(a.lanes) op b);              \
  }                                                  \
  inline Vector operator op(float a, Vector b) {     \
    return Vector(a op Lanes(b.lanes));              \
  }                                                  \
  template <typename B>                              \
  inline Vector& operator op## = (Vector & a, B b) { \
    return a = a op b;                               \
  }
#define QG_LANES_OPERATORS(Vector)    \
  QG_LANES_OPERATOR(Vector, +)        \
  QG_LANES_OPERATOR(Vector, -)        \
  QG_LANES_OPERATOR(Vector, *)        \
  QG_LANES_OPERATOR(Vector, /)        \
  inline Vector operator-(Vector a) { \
    return Vector(-Lanes(a.lanes));   \
  }
QG_LANES_OPERATORS(vec3)
QG_LANES_OPERATORS(vec4)

// Three floats in memory.
struct packed_vec3 {
  float values[3];
  packed_vec3& operator=(vec3 a) {
    values[0] = a.x(), values[1] = a.y(), values[2] = a.z();
    return *this;
  }
  operator vec3() const {  // by two loads
    LongLanes words{};
    __builtin_memcpy(&words, values, 8);
    IntLanes last{};
    __builtin_memcpy(&last, values + 2, 4);
    return vec3(Lanes(LongLanes{words[0], LongLanes(last)[0]}));
  }
  float x() const { return values[0]; }
  float y() const { return values[1]; }
  float z() const { return values[2]; }
  vec2 xy() const { return {values[0], values[1]}; }
  float& operator[](std::size_t i) { return values[i]; }
  float operator[](std::size_t i) const { return values[i]; }
  template <typename B>
  packed_vec3& operator+=(B b) {
    return *this = vec3(*this) + b;
  }
  template <typename B>
  packed_vec3& operator*=(B b) {
    return *this = vec3(*this) * b;
  }
};

// Booleans: all bits of a lane, or none. In a vector of three, the last lane holds anything.
#define QG_MASK(Mask)                     \
  IntLanes lanes;                         \
  explicit Mask(IntLanes a) : lanes(a) {} \
  Mask operator!() const {                \
    return Mask(~lanes);                  \
  }                                       \
  bool operator[](std::size_t i) const {  \
    return lanes[i] != 0;                 \
  }

struct bvec3 {
  bvec3(bool a, bool b, bool c) : lanes{-a, -b, -c, 0} {}
  bool x() const { return lanes[0] != 0; }
  bool y() const { return lanes[1] != 0; }
  bool z() const { return lanes[2] != 0; }
  QG_MASK(bvec3)
};
struct bvec4 {
  bvec4(bool a, bool b, bool c, bool d) : lanes{-a, -b, -c, -d} {}
  QG_MASK(bvec4)
};

}  // namespace quadgraph::cpu::QG_LEVEL
