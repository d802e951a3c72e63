// The entries of an operator and of the vectors it acts on, in double precision, per RGB channel.
#pragma once

#include <glm/vec3.hpp>

#include "engine/optics/boundary.h"

namespace quadgraph {

// The pair (phi, phi2), or what the equations of both leave; phi2 is 0 with diffusion.
struct Field {
  glm::dvec3 phi{0}, phi2{0};
};

// A symmetric 2x2 matrix; a12 and a22 are 0 with diffusion.
struct Block {
  glm::dvec3 a11{0}, a12{0}, a22{0};
};

// What a method says about a pair of carriers, before the model makes a block of it (operator.h).
struct Terms {
  glm::dvec3 stiffness{0};   // of kappa
  glm::dvec3 absorption{0};  // mass of sigma_a
  glm::dvec3 relaxation{0};  // mass of 5/9 sigma_t
  glm::dvec3 boundary{0};    // of the surface
};

Block block_of(const Terms& terms, Model model, const Boundary& boundary);

inline Field operator+(const Field& a, const Field& b) {
  return {a.phi + b.phi, a.phi2 + b.phi2};
}
inline Field operator-(const Field& a, const Field& b) {
  return {a.phi - b.phi, a.phi2 - b.phi2};
}
inline Field operator*(const glm::dvec3& factor, const Field& a) {
  return {factor * a.phi, factor * a.phi2};
}
inline Field operator*(const Block& a, const Field& x) {
  return {a.a11 * x.phi + a.a12 * x.phi2, a.a12 * x.phi + a.a22 * x.phi2};
}
inline Block operator-(const Block& a, const Block& b) {
  return {a.a11 - b.a11, a.a12 - b.a12, a.a22 - b.a22};
}
inline Block& operator+=(Block& a, const Block& b) {
  a.a11 += b.a11;
  a.a12 += b.a12;
  a.a22 += b.a22;
  return a;
}
inline glm::dvec3 dot(const Field& a, const Field& b) {
  return a.phi * b.phi + a.phi2 * b.phi2;
}

// a / b per channel, 0 where b is not above 0.
inline glm::dvec3 safe_ratio(const glm::dvec3& a, const glm::dvec3& b) {
  glm::dvec3 result{0};
  for (int c = 0; c < 3; ++c) {
    if (b[c] > 0) result[c] = a[c] / b[c];
  }
  return result;
}

// The inverse of a positive definite block times r; with diffusion phi2 stays 0.
Field solve(const Block& a, const Field& r);

}  // namespace quadgraph
