// Functions of GLSL; engine/cpu/glsl.h says what they are for.
#pragma once

#include "engine/cpu/vectors.h"

namespace quadgraph::cpu::QG_LEVEL {

template <typename T>
struct SameType {
  using Type = T;
};
// For an argument that says nothing about T.
template <typename T>
using Same = typename SameType<T>::Type;

// A function of each component of vectors, where that of numbers is there already.
#define QG_OF_VECTORS(name)                              \
  template <typename T>                                  \
  inline Vec2<T> name(Vec2<T> a) {                       \
    return {name(a.x), name(a.y)};                       \
  }                                                      \
  template <typename T>                                  \
  inline Vec3<T> name(Vec3<T> a) {                       \
    return {name(a.x), name(a.y), name(a.z)};            \
  }                                                      \
  template <typename T>                                  \
  inline Vec4<T> name(Vec4<T> a) {                       \
    return {name(a.x), name(a.y), name(a.z), name(a.w)}; \
  }                                                      \
  static_assert(true)
#define QG_OF_VECTOR_PAIRS(name)                                             \
  template <typename T>                                                      \
  inline Vec2<T> name(Vec2<T> a, Vec2<T> b) {                                \
    return {name(a.x, b.x), name(a.y, b.y)};                                 \
  }                                                                          \
  template <typename T>                                                      \
  inline Vec3<T> name(Vec3<T> a, Vec3<T> b) {                                \
    return {name(a.x, b.x), name(a.y, b.y), name(a.z, b.z)};                 \
  }                                                                          \
  template <typename T>                                                      \
  inline Vec4<T> name(Vec4<T> a, Vec4<T> b) {                                \
    return {name(a.x, b.x), name(a.y, b.y), name(a.z, b.z), name(a.w, b.w)}; \
  }                                                                          \
  template <typename T>                                                      \
  inline Vec2<T> name(Vec2<T> a, Same<T> b) {                                \
    return name(a, Vec2<T>(b));                                              \
  }                                                                          \
  template <typename T>                                                      \
  inline Vec3<T> name(Vec3<T> a, Same<T> b) {                                \
    return name(a, Vec3<T>(b));                                              \
  }                                                                          \
  template <typename T>                                                      \
  inline Vec4<T> name(Vec4<T> a, Same<T> b) {                                \
    return name(a, Vec4<T>(b));                                              \
  }                                                                          \
  static_assert(true)

// One that the compiler has for numbers; functions of the standard library would be shared with code for other levels.
#define QG_BUILTIN(name, builtin)  \
  inline float name(float x) {     \
    return __builtin_##builtin(x); \
  }                                \
  QG_OF_VECTORS(name)

QG_BUILTIN(sqrt, sqrtf);
QG_BUILTIN(floor, floorf);
QG_BUILTIN(ceil, ceilf);
QG_BUILTIN(trunc, truncf);
QG_BUILTIN(round, roundf);
QG_BUILTIN(roundEven, rintf);
QG_BUILTIN(exp, expf);
QG_BUILTIN(exp2, exp2f);
QG_BUILTIN(log, logf);
QG_BUILTIN(log2, log2f);
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
inline float fma(float a, float b, float c) {
  return __builtin_fmaf(a, b, c);
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
inline float abs(float x) {
  return __builtin_fabsf(x);
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
QG_OF_VECTORS(abs);
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
QG_OF_VECTOR_PAIRS(pow);
QG_OF_VECTOR_PAIRS(mod);

#define QG_CLAMP_AND_MIX(Vector)                                                \
  template <typename T>                                                         \
  inline Vector<T> clamp(Vector<T> x, Vector<T> low, Vector<T> high) {          \
    return min(max(x, low), high);                                              \
  }                                                                             \
  template <typename T>                                                         \
  inline Vector<T> clamp(Vector<T> x, Same<T> low, Same<T> high) {              \
    return min(max(x, low), high);                                              \
  }                                                                             \
  inline Vector<float> mix(Vector<float> a, Vector<float> b, float t) {         \
    return a * (1.0f - t) + b * t;                                              \
  }                                                                             \
  inline Vector<float> mix(Vector<float> a, Vector<float> b, Vector<float> t) { \
    return a * (1.0f - t) + b * t;                                              \
  }                                                                             \
  static_assert(true)

QG_CLAMP_AND_MIX(Vec2);
QG_CLAMP_AND_MIX(Vec3);
QG_CLAMP_AND_MIX(Vec4);

inline float mix(float a, float b, float t) {
  return a * (1.0f - t) + b * t;
}
inline float mix(float a, float b, bool t) {
  return t ? b : a;
}
template <typename T>
inline Vec2<T> mix(Vec2<T> a, Vec2<T> b, bvec2 t) {
  return {t.x ? b.x : a.x, t.y ? b.y : a.y};
}
template <typename T>
inline Vec3<T> mix(Vec3<T> a, Vec3<T> b, bvec3 t) {
  return {t.x ? b.x : a.x, t.y ? b.y : a.y, t.z ? b.z : a.z};
}
inline float smoothstep(float low, float high, float x) {
  float t = clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

inline vec3 frexp(vec3 a, ivec3& e) {
  return {__builtin_frexpf(a.x, &e.x), __builtin_frexpf(a.y, &e.y), __builtin_frexpf(a.z, &e.z)};
}
inline float ldexp(float a, int e) {
  return __builtin_ldexpf(a, e);
}
inline vec3 ldexp(vec3 a, ivec3 e) {
  return {ldexp(a.x, e.x), ldexp(a.y, e.y), ldexp(a.z, e.z)};
}

inline float dot(vec2 a, vec2 b) {
  return a.x * b.x + a.y * b.y;
}
inline float dot(vec3 a, vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float dot(vec4 a, vec4 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}
inline vec3 cross(vec3 a, vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(vec2 a) {
  return sqrt(dot(a, a));
}
inline float length(vec3 a) {
  return sqrt(dot(a, a));
}
inline float distance(vec3 a, vec3 b) {
  return length(a - b);
}
inline float distance(vec2 a, vec2 b) {
  return length(a - b);
}
inline vec2 normalize(vec2 a) {
  return a * (1.0f / length(a));
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

#define QG_COMPARE(name, op)                                 \
  template <typename T>                                      \
  constexpr bvec2 name(Vec2<T> a, Vec2<T> b) {               \
    return {a.x op b.x, a.y op b.y};                         \
  }                                                          \
  template <typename T>                                      \
  constexpr bvec3 name(Vec3<T> a, Vec3<T> b) {               \
    return {a.x op b.x, a.y op b.y, a.z op b.z};             \
  }                                                          \
  template <typename T>                                      \
  constexpr bvec4 name(Vec4<T> a, Vec4<T> b) {               \
    return {a.x op b.x, a.y op b.y, a.z op b.z, a.w op b.w}; \
  }                                                          \
  static_assert(true)

QG_COMPARE(lessThan, <);
QG_COMPARE(lessThanEqual, <=);
QG_COMPARE(greaterThan, >);
QG_COMPARE(greaterThanEqual, >=);
QG_COMPARE(equal, ==);
QG_COMPARE(notEqual, !=);

inline bool any(bvec2 a) {
  return a.x || a.y;
}
inline bool any(bvec3 a) {
  return a.x || a.y || a.z;
}
inline bool any(bvec4 a) {
  return a.x || a.y || a.z || a.w;
}
inline bool all(bvec2 a) {
  return a.x && a.y;
}
inline bool all(bvec3 a) {
  return a.x && a.y && a.z;
}
inline bool all(bvec4 a) {
  return a.x && a.y && a.z && a.w;
}
inline bvec3 isnan(vec3 a) {
  return {isnan(a.x), isnan(a.y), isnan(a.z)};
}
inline bvec3 isinf(vec3 a) {
  return {isinf(a.x), isinf(a.y), isinf(a.z)};
}

inline float uintBitsToFloat(uint x) {
  return __builtin_bit_cast(float, x);
}
inline uint floatBitsToUint(float x) {
  return __builtin_bit_cast(uint, x);
}
inline vec2 uintBitsToFloat(uvec2 a) {
  return {uintBitsToFloat(a.x), uintBitsToFloat(a.y)};
}
inline vec3 uintBitsToFloat(uvec3 a) {
  return {uintBitsToFloat(a.x), uintBitsToFloat(a.y), uintBitsToFloat(a.z)};
}
inline vec4 uintBitsToFloat(uvec4 a) {
  return {uintBitsToFloat(a.x), uintBitsToFloat(a.y), uintBitsToFloat(a.z), uintBitsToFloat(a.w)};
}
inline uvec3 floatBitsToUint(vec3 a) {
  return {floatBitsToUint(a.x), floatBitsToUint(a.y), floatBitsToUint(a.z)};
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
