// How a point moves, by the same code on the GPU, in single precision, and in the CPU reference, in double.
#ifndef QUADGRAPH_DEFORM_H
#define QUADGRAPH_DEFORM_H

#include "deform/deform_shared.h"

#ifdef __cplusplus
#include <cmath>
namespace quadgraph::gpu {
using real = double;
using real2 = glm::dvec2;
using real3 = glm::dvec3;
using glm::abs;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::max;
// NOLINTNEXTLINE: the record says where they are
#define CONTROL(record, i) (reinterpret_cast<const glm::dvec3*>(record.control)[i])

inline real2 sine_cosine(real angle) {
  return {std::sin(angle), std::cos(angle)};
}
#else
#define real float
#define real2 vec2
#define real3 vec3
#define CONTROL(record, i) (record).control.at[i]

// To 1e-7; what GLSL has need not be better than 5e-4. Reduction and polynomials: Cephes, sinf.c.
vec2 sine_cosine(float angle) {
  float quarter = round(angle * 0.63661977);
  float x = ((angle - quarter * 1.5703125) - quarter * 4.837512969970703e-4) - quarter * 7.549789954891882e-8;
  float z = x * x;
  float s = x + x * z * (-1.6666654611e-1 + z * (8.3321608736e-3 - z * 1.9515295891e-4));
  float c = 1.0 - 0.5 * z + z * z * (4.166664568298827e-2 + z * (-1.388731625493765e-3 + z * 2.443315711809948e-5));
  int turn = int(quarter) & 3;
  return turn == 0 ? vec2(s, c) : turn == 1 ? vec2(c, -s) : turn == 2 ? vec2(-s, -c) : vec2(-c, s);
}
#endif

// sin x / x.
QG_INLINE real sine_over(real x) {
  return abs(x) < real(1e-3) ? real(1) - x * x / real(6) : sine_cosine(x).x / x;
}

// How far along its range a point at `s` mm is, mm.
QG_INLINE real along_range(DeformRecord r, real s) {
  return clamp(s - real(r.begin), real(0), real(r.extent));
}

QG_INLINE real3 twisted(DeformRecord r, real3 p) {
  real3 axis = real3(r.a), v = p - real3(r.c);
  real s = dot(v, axis);
  real3 across = v - s * axis;
  real2 turn = sine_cosine(real(r.amount) * along_range(r, s) / real(r.extent));
  return p + (turn.y - real(1)) * across + turn.x * cross(axis, across);
}

// The axis becomes an arc towards b, its length kept; what lies before the range stays (Barr 1984).
QG_INLINE real3 bent(DeformRecord r, real3 p) {
  real3 axis = real3(r.a), towards = real3(r.b), v = p - real3(r.c);
  real s = dot(v, axis), y = dot(v, towards), begin = real(r.begin);
  real u = along_range(r, s), beyond = s - begin - u;
  real angle = real(r.amount) * u / real(r.extent);
  real2 turn = sine_cosine(angle);
  real along = begin + u * sine_over(angle) - y * turn.x + beyond * turn.y;
  real half_sine = sine_cosine(real(0.5) * angle).x;
  real across = y * turn.y + u * half_sine * sine_over(real(0.5) * angle) + beyond * turn.x;
  return p + (along - s) * axis + (across - y) * towards;
}

QG_INLINE real3 tapered(DeformRecord r, real3 p) {
  real3 axis = real3(r.a), v = p - real3(r.c);
  real s = dot(v, axis);
  return p + real(r.amount) * along_range(r, s) / real(r.extent) * (v - s * axis);
}

QG_INLINE real3 stretched(DeformRecord r, real3 p) {
  real3 axis = real3(r.a);
  return p + real(r.amount) * along_range(r, dot(p - real3(r.c), axis)) * axis;
}

QG_INLINE real3 transformed(DeformRecord r, real3 p) {
  return real3(dot(real3(r.a), p), dot(real3(r.b), p), dot(real3(r.c), p)) + real3(r.d);
}

// Weight of control point i of n at t in [0, 1]: Bernstein's polynomial, or a hat function.
QG_INLINE real lattice_weight(uint basis, uint n, uint i, real t) {
  if (n == 1u) return real(1);
  if (basis == LATTICE_LINEAR) return max(real(1) - abs(t * real(n - 1u) - real(i)), real(0));
  real w = real(1);
  for (uint k = 0u; k < i; ++k) w *= t * real(n - 1u - k) / real(k + 1u);
  for (uint k = i; k + 1u < n; ++k) w *= real(1) - t;
  return w;
}

// Sederberg and Parry 1986; what lies outside the lattice moves with the nearest point of its box.
QG_INLINE real3 in_lattice(DeformRecord r, real3 p) {
  real3 t = clamp((p - real3(r.a)) / real3(r.b), real3(0), real3(1));
  uint nx = r.count & 255u, ny = (r.count >> 8u) & 255u, nz = (r.count >> 16u) & 255u, basis = r.count >> 24u;
  real wx[LATTICE_MOST];
  real wy[LATTICE_MOST];
  for (uint i = 0u; i < nx; ++i) wx[i] = lattice_weight(basis, nx, i, t.x);
  for (uint j = 0u; j < ny; ++j) wy[j] = lattice_weight(basis, ny, j, t.y);
  real3 sum = real3(0);
  for (uint k = 0u; k < nz; ++k) {
    real wz = lattice_weight(basis, nz, k, t.z);
    for (uint j = 0u; j < ny; ++j) {
      for (uint i = 0u; i < nx; ++i) sum += wx[i] * wy[j] * wz * CONTROL(r, i + nx * (j + ny * k));
    }
  }
  return p + sum;
}

// `vertex`: its number in the mesh. Cages and bodies are left to the caller.
QG_INLINE real3 deformed_point(DeformRecord r, real3 p, uint vertex) {
  if (r.kind == DEFORM_TWIST) return twisted(r, p);
  if (r.kind == DEFORM_BEND) return bent(r, p);
  if (r.kind == DEFORM_TAPER) return tapered(r, p);
  if (r.kind == DEFORM_STRETCH) return stretched(r, p);
  if (r.kind == DEFORM_TRANSFORM) return transformed(r, p);
  if (r.kind == DEFORM_LATTICE) return in_lattice(r, p);
  return p + CONTROL(r, vertex);
}

#ifdef __cplusplus
#undef CONTROL
}  // namespace quadgraph::gpu
#endif
#endif
