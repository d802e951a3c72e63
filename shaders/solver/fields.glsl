// Arithmetic of fields and entries, in the variant of MOMENTS (solve_shared.h).
#ifndef QUADGRAPH_FIELDS_GLSL
#define QUADGRAPH_FIELDS_GLSL

#include "solver/solve_shared.h"

Field add(Field a, Field b) {
#if MOMENTS == 1
  return Field(a.phi + b.phi);
#else
  return Field(a.phi + b.phi, a.phi2 + b.phi2);
#endif
}

Field difference(Field a, Field b) {
#if MOMENTS == 1
  return Field(a.phi - b.phi);
#else
  return Field(a.phi - b.phi, a.phi2 - b.phi2);
#endif
}

// a + factor b, per channel.
Field add_scaled(Field a, vec3 factor, Field b) {
#if MOMENTS == 1
  return Field(a.phi + factor * b.phi);
#else
  return Field(a.phi + factor * b.phi, a.phi2 + factor * b.phi2);
#endif
}

Field scaled(vec3 factor, Field a) {
#if MOMENTS == 1
  return Field(factor * a.phi);
#else
  return Field(factor * a.phi, factor * a.phi2);
#endif
}

Field no_field() {
#if MOMENTS == 1
  return Field(vec3(0));
#else
  return Field(vec3(0), vec3(0));
#endif
}

// The field of a source that lights phi alone.
Field lit(vec3 phi) {
#if MOMENTS == 1
  return Field(phi);
#else
  return Field(phi, vec3(0));
#endif
}

vec3 product(Field a, Field b) {
#if MOMENTS == 1
  return a.phi * b.phi;
#else
  return a.phi * b.phi + a.phi2 * b.phi2;
#endif
}

Field times(Entry a, Field x) {
#if MOMENTS == 1
  return Field(a.a11 * x.phi);
#else
  return Field(a.a11 * x.phi + a.a12 * x.phi2, a.a12 * x.phi + a.a22 * x.phi2);
#endif
}

// The inverse of a positive definite entry times r.
Field solved(Entry a, Field r) {
#if MOMENTS == 1
  return Field(r.phi / a.a11);
#else
  // By elimination: the determinant could leave the range of single precision.
  vec3 ratio = a.a12 / a.a11;
  vec3 phi2 = (r.phi2 - ratio * r.phi) / (a.a22 - ratio * a.a12);
  return Field(r.phi / a.a11 - ratio * phi2, phi2);
#endif
}

// Outward flux k11 phi + k12 phi2.
vec3 outward_flux(Boundary boundary, Field x) {
#if MOMENTS == 1
  return boundary.k11 * x.phi;
#else
  return boundary.k11 * x.phi + boundary.k12 * x.phi2;
#endif
}

// b of the diffuse source where `load` is the measure of the surface times q (engine/reference/operator.h).
Field diffuse_source(Boundary boundary, vec3 load) {
#if MOMENTS == 1
  return Field(boundary.source * boundary.k11 * load);
#else
  return Field(boundary.source * boundary.k11 * load, boundary.source * boundary.k12 * load);
#endif
}

#endif
