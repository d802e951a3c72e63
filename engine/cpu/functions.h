// Functions of GLSL of numbers, pairs and whole numbers; engine/cpu/glsl.h says what they are for.
#pragma once

#ifdef __SSE4_1__
#include <smmintrin.h>
#endif

#include "engine/cpu/lanes.h"

namespace quadgraph::cpu::QG_LEVEL {

template <typename T>
struct SameType {
  using Type = T;
};
// For an argument that says nothing about T.
template <typename T>
using Same = typename SameType<T>::Type;

// A function of each component of vectors, where that of numbers is there already.
#define QG_OF_PLAIN_VECTORS(name)                   \
  template <typename T>                             \
  inline Vec2<T> name(Vec2<T> a) {                  \
    return {name(a.x()), name(a.y())};              \
  }                                                 \
  template <typename T>                             \
  inline Vec3<T> name(Vec3<T> a) {                  \
    return {name(a.x()), name(a.y()), name(a.z())}; \
  }                                                 \
  static_assert(true)
#define QG_OF_VECTORS(name)                                      \
  QG_OF_PLAIN_VECTORS(name);                                     \
  inline vec3 name(vec3 a) {                                     \
    return {name(a.x()), name(a.y()), name(a.z())};              \
  }                                                              \
  inline vec4 name(vec4 a) {                                     \
    return {name(a.x()), name(a.y()), name(a.z()), name(a.w())}; \
  }                                                              \
  static_assert(true)
#define QG_OF_VECTOR_PAIRS(name)                                         \
  template <typename T>                                                  \
  inline Vec2<T> name(Vec2<T> a, Vec2<T> b) {                            \
    return {name(a.x(), b.x()), name(a.y(), b.y())};                     \
  }                                                                      \
  template <typename T>                                                  \
  inline Vec3<T> name(Vec3<T> a, Vec3<T> b) {                            \
    return {name(a.x(), b.x()), name(a.y(), b.y()), name(a.z(), b.z())}; \
  }                                                                      \
  template <typename T>                                                  \
  inline Vec2<T> name(Vec2<T> a, Same<T> b) {                            \
    return name(a, Vec2<T>(b));                                          \
  }                                                                      \
  template <typename T>                                                  \
  inline Vec3<T> name(Vec3<T> a, Same<T> b) {                            \
    return name(a, Vec3<T>(b));                                          \
  }                                                                      \
  static_assert(true)

// One that the compiler has for numbers; functions of the standard library would be shared with code for other levels.
#define QG_BUILTIN(name, builtin)  \
  inline float name(float x) {     \
    return __builtin_##builtin(x); \
  }                                \
  QG_OF_VECTORS(name)

// Also one that x86 has for the lanes `x` at once.
#define QG_LANE_BUILTIN(name, builtin, of_lanes) \
  inline float name(float x) {                   \
    return __builtin_##builtin(x);               \
  }                                              \
  QG_OF_PLAIN_VECTORS(name);                     \
  inline vec3 name(vec3 a) {                     \
    const Lanes x = a.lanes;                     \
    return vec3(Lanes(of_lanes));                \
  }                                              \
  inline vec4 name(vec4 a) {                     \
    const Lanes x = a.lanes;                     \
    return vec4(Lanes(of_lanes));                \
  }                                              \
  static_assert(true)

#ifdef __SSE4_1__
QG_LANE_BUILTIN(sqrt, sqrtf, _mm_sqrt_ps(x));
QG_LANE_BUILTIN(floor, floorf, _mm_round_ps(x, _MM_FROUND_FLOOR));
QG_LANE_BUILTIN(ceil, ceilf, _mm_round_ps(x, _MM_FROUND_CEIL));
QG_LANE_BUILTIN(trunc, truncf, _mm_round_ps(x, _MM_FROUND_TRUNC));
QG_LANE_BUILTIN(roundEven, rintf, _mm_round_ps(x, _MM_FROUND_NINT));
QG_LANE_BUILTIN(abs, fabsf, Lanes(IntLanes(x) & 0x7fffffff));
#else
QG_BUILTIN(sqrt, sqrtf);
QG_BUILTIN(floor, floorf);
QG_BUILTIN(ceil, ceilf);
QG_BUILTIN(trunc, truncf);
QG_BUILTIN(roundEven, rintf);
QG_BUILTIN(abs, fabsf);
#endif
QG_BUILTIN(round, roundf);
QG_BUILTIN(sin, sinf);
QG_BUILTIN(cos, cosf);
QG_BUILTIN(tan, tanf);
QG_BUILTIN(asin, asinf);
QG_BUILTIN(acos, acosf);
QG_BUILTIN(atan, atanf);

inline float atan(float y, float x) {
  return __builtin_atan2f(y, x);
}
inline float pow(float x, float y) {
  return __builtin_powf(x, y);
}
inline float mod(float x, float y) {
  return x - y * floor(x / y);
}
inline float step(float edge, float x) {
  return x < edge ? 0.0f : 1.0f;
}
inline float inversesqrt(float x) {
  return 1.0f / sqrt(x);
}
inline float fract(float x) {
  return x - floor(x);
}
inline int abs(int x) {
  return x < 0 ? -x : x;
}
inline float sign(float x) {
  return x > 0 ? 1.0f : x < 0 ? -1.0f : 0.0f;
}
inline int sign(int x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}
inline bool isnan(float x) {
  return x != x;
}
inline bool isinf(float x) {
  return abs(x) > 3.402823466e38f;
}
QG_OF_VECTORS(inversesqrt);
QG_OF_VECTORS(fract);
QG_OF_VECTORS(sign);

#define QG_LEAST_AND_MOST(T)              \
  constexpr T min(T a, T b) {             \
    return b < a ? b : a;                 \
  }                                       \
  constexpr T max(T a, T b) {             \
    return a < b ? b : a;                 \
  }                                       \
  constexpr T clamp(T x, T low, T high) { \
    return min(max(x, low), high);        \
  }                                       \
  static_assert(true)

QG_LEAST_AND_MOST(float);
QG_LEAST_AND_MOST(int);
QG_LEAST_AND_MOST(uint);
QG_OF_VECTOR_PAIRS(min);
QG_OF_VECTOR_PAIRS(max);
QG_OF_VECTOR_PAIRS(mod);

template <typename T>
inline Vec2<T> clamp(Vec2<T> x, Vec2<T> low, Vec2<T> high) {
  return min(max(x, low), high);
}
inline vec2 clamp(vec2 x, float low, float high) {
  return min(max(x, low), high);
}
template <typename T>
inline Vec3<T> clamp(Vec3<T> x, Vec3<T> low, Vec3<T> high) {
  return min(max(x, low), high);
}
inline float smoothstep(float low, float high, float x) {
  const float t = clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}
inline vec2 mix(vec2 a, vec2 b, float t) {
  return a * (1.0f - t) + b * t;
}
inline vec2 mix(vec2 a, vec2 b, bvec2 t) {
  return {t.x() ? b.x() : a.x(), t.y() ? b.y() : a.y()};
}
inline float mix(float a, float b, float t) {
  return a * (1.0f - t) + b * t;
}
inline float mix(float a, float b, bool t) {
  return t ? b : a;
}

inline float ldexp(float a, int e) {
  return __builtin_ldexpf(a, e);
}
inline float dot(vec2 a, vec2 b) {
  return a.x() * b.x() + a.y() * b.y();
}
inline float length(vec2 a) {
  return sqrt(dot(a, a));
}
inline float distance(vec2 a, vec2 b) {
  return length(a - b);
}
inline vec2 normalize(vec2 a) {
  return a * (1.0f / length(a));
}
inline bool any(bvec2 a) {
  return a.x() || a.y();
}
inline bool all(bvec2 a) {
  return a.x() && a.y();
}
inline float uintBitsToFloat(uint x) {
  return __builtin_bit_cast(float, x);
}
inline uint floatBitsToUint(float x) {
  return __builtin_bit_cast(uint, x);
}
inline int bitCount(uint x) {
  return __builtin_popcount(x);
}
inline int findLSB(uint x) {
  return x == 0 ? -1 : __builtin_ctz(x);
}
inline int findMSB(uint x) {
  return x == 0 ? -1 : 31 - __builtin_clz(x);
}
inline uint bitfieldReverse(uint x) {
  x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
  x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
  x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
  return __builtin_bswap32(x);
}
inline int bitfieldExtract(int x, int offset, int bits) {
  return int(uint(x) << (32 - offset - bits)) >> (32 - bits);
}
inline uint bitfieldExtract(uint x, int offset, int bits) {
  return x << (32 - offset - bits) >> (32 - bits);
}

}  // namespace quadgraph::cpu::QG_LEVEL
