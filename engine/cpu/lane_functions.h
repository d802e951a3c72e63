// Functions of GLSL of three and four floats; engine/cpu/glsl.h says what they are for.
#pragma once

#include "engine/cpu/functions.h"

namespace quadgraph::cpu::QG_LEVEL {

// The lesser and the greater of each lane; where one is not a number, a.
#ifdef __SSE4_1__
inline Lanes lesser(Lanes a, Lanes b) {
  return _mm_min_ps(b, a);
}
inline Lanes greater(Lanes a, Lanes b) {
  return _mm_max_ps(b, a);
}
#else
inline Lanes lesser(Lanes a, Lanes b) {
  return b < a ? b : a;
}
inline Lanes greater(Lanes a, Lanes b) {
  return a < b ? b : a;
}
#endif

// 2^whole e^rest for whole numbers from -127, which gives 0, to 128, which gives infinity, and |rest| <= .35: a Taylor
// polynomial to the seventh power, off by 5e-9, of which parts are evaluated side by side.
inline Lanes exp_of_parts(Lanes whole, Lanes rest) {
  const Lanes square = rest * rest;
  const Lanes high = (1.0f / 24 + rest * (1.0f / 120)) + square * (1.0f / 720 + rest * (1.0f / 5040));
  const Lanes sum = (1.0f + rest) + square * ((0.5f + rest * (1.0f / 6)) + square * high);
  return sum * Lanes((__builtin_convertvector(whole, IntLanes) + 127) << 23);
}
// The nearest whole numbers of what is below 2^22 in size.
inline Lanes whole_of(Lanes x) {
  constexpr float shift = 12582912.0f;  // 1.5 * 2^23: what is added to it loses its fraction
  return x + shift - shift;
}
inline Lanes within(Lanes x, float least, float most) {
  return lesser(greater(x, least - Lanes{}), most - Lanes{});
}
inline Lanes exp_of_lanes(Lanes x) {
  x = within(x, -88.0f, 89.0f);
  const Lanes whole = whole_of(x * 1.44269504f);
  // ln 2 in two parts, the first of few bits, so that its product is exact.
  return exp_of_parts(whole, x - whole * 0.693359375f + whole * 2.12194440e-4f);
}
inline Lanes exp2_of_lanes(Lanes x) {
  x = within(x, -127.0f, 128.0f);
  const Lanes whole = whole_of(x);
  return exp_of_parts(whole, (x - whole) * 0.693147181f);
}
inline float exp(float x) {
  return exp_of_lanes(x - Lanes{})[0];
}
inline float exp2(float x) {
  return __builtin_constant_p(x) ? __builtin_exp2f(x) : exp2_of_lanes(x - Lanes{})[0];
}

// x = m 2^e, m from .71 to 1.41, and log m = 2 artanh(s) with s = (m - 1) / (m + 1), of which the series is off by 2e-9
// after five terms. Of 0 minus infinity, of infinity infinity, below 0 and of what is not a number not a number.
struct LogParts {
  Lanes e, log_m;
};
inline LogParts log_parts(Lanes x) {
  const IntLanes shifted = IntLanes(x) - 0x3f3504f3;  // the bits of sqrt(1/2)
  const Lanes m = Lanes((shifted & 0x7fffff) + 0x3f3504f3);
  const Lanes s = (m - 1.0f) / (m + 1.0f), square = s * s;
  const Lanes rest = square * (2.0f / 3 + square * (2.0f / 5 + square * (2.0f / 7 + square * (2.0f / 9))));
  return {__builtin_convertvector(shifted >> 23, Lanes), 2.0f * s + s * rest};
}
inline Lanes log_or_special(Lanes x, Lanes result) {
  constexpr float infinity = __builtin_inff();
  result = x < infinity ? result : x;
  return x > 0.0f ? result : x == 0.0f ? -infinity - Lanes{} : __builtin_nanf("") - Lanes{};
}
inline Lanes log_of_lanes(Lanes x) {
  const LogParts parts = log_parts(x);
  // ln 2 in two parts, as above.
  return log_or_special(x, parts.e * 0.693359375f + (parts.log_m - parts.e * 2.12194440e-4f));
}
inline Lanes log2_of_lanes(Lanes x) {
  const LogParts parts = log_parts(x);
  return log_or_special(x, parts.e + parts.log_m * 1.44269504f);
}
inline float log(float x) {
  return log_of_lanes(x - Lanes{})[0];
}
inline float log2(float x) {
  return __builtin_constant_p(x) ? __builtin_log2f(x) : log2_of_lanes(x - Lanes{})[0];
}

// The sign bits of lanes.
#ifdef __SSE4_1__
inline uint signs_of(IntLanes a) {
  return static_cast<uint>(_mm_movemask_ps(Lanes(a)));
}
#else
inline uint signs_of(IntLanes a) {
  return (a[0] < 0 ? 1u : 0u) | (a[1] < 0 ? 2u : 0u) | (a[2] < 0 ? 4u : 0u) | (a[3] < 0 ? 8u : 0u);
}
#endif
inline bool any(bvec3 a) {
  return (signs_of(a.lanes) & 7u) != 0;
}
inline bool all(bvec3 a) {
  return (signs_of(a.lanes) & 7u) == 7u;
}
inline bool any(bvec4 a) {
  return signs_of(a.lanes) != 0;
}
inline bool all(bvec4 a) {
  return signs_of(a.lanes) == 15u;
}

#define QG_COMPARE_LANES(Vector, Mask, name, op)   \
  inline Mask name(Vector a, Vector b) {           \
    return Mask(Lanes(a.lanes) op Lanes(b.lanes)); \
  }
#define QG_LANE_FUNCTIONS(Vector, Mask)                       \
  QG_COMPARE_LANES(Vector, Mask, lessThan, <)                 \
  QG_COMPARE_LANES(Vector, Mask, lessThanEqual, <=)           \
  QG_COMPARE_LANES(Vector, Mask, greaterThan, >)              \
  QG_COMPARE_LANES(Vector, Mask, greaterThanEqual, >=)        \
  QG_COMPARE_LANES(Vector, Mask, equal, ==)                   \
  QG_COMPARE_LANES(Vector, Mask, notEqual, !=)                \
  inline bool operator==(Vector a, Vector b) {                \
    return all(equal(a, b));                                  \
  }                                                           \
  inline Vector mix(Vector a, Vector b, Mask t) {             \
    return Vector(t.lanes ? Lanes(b.lanes) : Lanes(a.lanes)); \
  }                                                           \
  inline Vector min(Vector a, Vector b) {                     \
    return Vector(lesser(a.lanes, b.lanes));                  \
  }                                                           \
  inline Vector max(Vector a, Vector b) {                     \
    return Vector(greater(a.lanes, b.lanes));                 \
  }                                                           \
  inline Vector min(Vector a, float b) {                      \
    return min(a, Vector(b));                                 \
  }                                                           \
  inline Vector max(Vector a, float b) {                      \
    return max(a, Vector(b));                                 \
  }                                                           \
  inline Vector clamp(Vector x, Vector low, Vector high) {    \
    return min(max(x, low), high);                            \
  }                                                           \
  inline Vector clamp(Vector x, float low, float high) {      \
    return min(max(x, low), high);                            \
  }                                                           \
  inline Vector mix(Vector a, Vector b, Vector t) {           \
    return a * (1.0f - t) + b * t;                            \
  }                                                           \
  inline Vector mix(Vector a, Vector b, float t) {            \
    return a * (1.0f - t) + b * t;                            \
  }                                                           \
  inline Vector exp(Vector a) {                               \
    return Vector(exp_of_lanes(a.lanes));                     \
  }                                                           \
  inline Vector exp2(Vector a) {                              \
    return Vector(exp2_of_lanes(a.lanes));                    \
  }                                                           \
  inline Vector log(Vector a) {                               \
    return Vector(log_of_lanes(a.lanes));                     \
  }                                                           \
  inline Vector log2(Vector a) {                              \
    return Vector(log2_of_lanes(a.lanes));                    \
  }                                                           \
  inline Mask isnan(Vector a) {                               \
    return notEqual(a, a);                                    \
  }                                                           \
  inline Mask isinf(Vector a) {                               \
    return greaterThan(abs(a), Vector(3.402823466e38f));      \
  }
QG_LANE_FUNCTIONS(vec3, bvec3)
QG_LANE_FUNCTIONS(vec4, bvec4)

inline vec3 pow(vec3 a, vec3 b) {
  return {pow(a.x(), b.x()), pow(a.y(), b.y()), pow(a.z(), b.z())};
}
inline float dot(vec3 a, vec3 b) {
  const Lanes products = a.lanes * b.lanes;
  return products[0] + products[1] + products[2];
}
inline float dot(vec4 a, vec4 b) {
  const Lanes products = a.lanes * b.lanes;
  return products[0] + products[1] + products[2] + products[3];
}
inline vec3 cross(vec3 a, vec3 b) {
  return (a * b.yzx() - a.yzx() * b).yzx();
}
inline float length(vec3 a) {
  return sqrt(dot(a, a));
}
inline float distance(vec3 a, vec3 b) {
  return length(a - b);
}
inline vec3 normalize(vec3 a) {
  return a * (1.0f / length(a));
}
inline vec3 reflect(vec3 i, vec3 n) {
  return i - 2.0f * dot(n, i) * n;
}
inline vec3 refract(vec3 i, vec3 n, float eta) {
  float cosine = dot(n, i), k = 1.0f - eta * eta * (1.0f - cosine * cosine);
  return k < 0.0f ? vec3(0.0f) : eta * i - (eta * cosine + sqrt(k)) * n;
}

// Comparisons of pairs and of whole numbers.
#define QG_COMPARE(name, op)                                 \
  template <typename T>                                      \
  inline bvec3 name(Vec3<T> a, Vec3<T> b) {                  \
    return {a.x() op b.x(), a.y() op b.y(), a.z() op b.z()}; \
  }                                                          \
  template <typename T>                                      \
  inline bvec2 name(Vec2<T> a, Vec2<T> b) {                  \
    return {a.x() op b.x(), a.y() op b.y()};                 \
  }
QG_COMPARE(lessThan, <)
QG_COMPARE(lessThanEqual, <=)
QG_COMPARE(greaterThan, >)
QG_COMPARE(greaterThanEqual, >=)
QG_COMPARE(equal, ==)
QG_COMPARE(notEqual, !=)

template <typename T>
inline Vec3<T> mix(Vec3<T> a, Vec3<T> b, bvec3 t) {
  return {t.x() ? b.x() : a.x(), t.y() ? b.y() : a.y(), t.z() ? b.z() : a.z()};
}
inline vec3 ldexp(vec3 a, ivec3 e) {
  return {ldexp(a.x(), e.x()), ldexp(a.y(), e.y()), ldexp(a.z(), e.z())};
}
inline vec3 frexp(vec3 a, ivec3& e) {
  return {__builtin_frexpf(a.x(), &e[0]), __builtin_frexpf(a.y(), &e[1]), __builtin_frexpf(a.z(), &e[2])};
}
inline vec2 uintBitsToFloat(uvec2 a) {
  return {uintBitsToFloat(a.x()), uintBitsToFloat(a.y())};
}
inline vec3 uintBitsToFloat(uvec3 a) {
  return {uintBitsToFloat(a.x()), uintBitsToFloat(a.y()), uintBitsToFloat(a.z())};
}
inline vec4 uintBitsToFloat(uvec4 a) {
  return {uintBitsToFloat(a.x()), uintBitsToFloat(a.y()), uintBitsToFloat(a.z()), uintBitsToFloat(a.w())};
}
inline uvec3 floatBitsToUint(vec3 a) {
  return {floatBitsToUint(a.x()), floatBitsToUint(a.y()), floatBitsToUint(a.z())};
}

}  // namespace quadgraph::cpu::QG_LEVEL
