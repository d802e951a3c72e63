// What a method says about a pair of carriers becomes an entry of the operator (engine/reference/operator.h):
// stiffness of kappa, mass of sigma_a (absorption), mass of 5/9 sigma_t (relaxation), measure of the surface.
#ifndef QUADGRAPH_ENTRIES_GLSL
#define QUADGRAPH_ENTRIES_GLSL

#include "material/optics.h"
#include "solver/solve_shared.h"

Entry entry_of(vec3 stiffness, vec3 absorption, vec3 relaxation) {
#if MOMENTS == 1
  return Entry(stiffness + absorption);
#else
  return Entry(stiffness + absorption, (2.0 / 3.0) * stiffness, (55.0 / 63.0) * stiffness + relaxation);
#endif
}

// The boundary's entry of a surface area, mm^2.
Entry boundary_entry(Boundary boundary, vec3 measure) {
#if MOMENTS == 1
  return Entry(boundary.k11 * measure);
#else
  return Entry(boundary.k11 * measure, boundary.k12 * measure, boundary.k22 * measure);
#endif
}

Entry sum_of(Entry a, Entry b) {
#if MOMENTS == 1
  return Entry(a.a11 + b.a11);
#else
  return Entry(a.a11 + b.a11, a.a12 + b.a12, a.a22 + b.a22);
#endif
}

Entry difference_of(Entry a, Entry b) {
#if MOMENTS == 1
  return Entry(a.a11 - b.a11);
#else
  return Entry(a.a11 - b.a11, a.a12 - b.a12, a.a22 - b.a22);
#endif
}

// What phi2 loses per volume, 1/mm.
vec3 relaxation_of(Optical optical) {
  return (5.0 / 9.0) * sigma_t(optical);
}

#endif
