// What a surface that two bodies share does to a ray, where one lies within the other and has another index of
// refraction: smooth, it mirrors and bends (docs/physics.md, "Bodies within others"). Power passes as it is, and so
// does radiance over the square of the index, which is what sweeps and view rays are about. See tet_ray.glsl, which
// BODY is for.
#ifndef QUADGRAPH_INNER_SURFACE_GLSL
#define QUADGRAPH_INNER_SURFACE_GLSL

#include "material/fresnel.glsl"
#include "source/tet_ray.glsl"

// BODY.etendue is of a tet the square of its index of refraction over that of the outermost body around it: so many times
// its volume counts.

// Whether light is bent on its way from one tet into another that it touches.
bool bends(uint tet, uint across) {
  return uvec2(BODY.etendue) != uvec2(0) && BODY.etendue.at[tet] != BODY.etendue.at[across];
}

// Where a ray meets such a surface.
struct InnerSurface {
  vec3 normal;      // unit, onward
  float cosine;     // of the ray with it, at least 0
  float ratio;      // index of refraction here over that across
  float reflected;  // share
};

// Unit normal of the face opposite a corner of a tet, out of the tet. By comparison, not by index: of vectors in memory
// Mesa 22's lavapipe takes other components than those that invocations side by side ask for.
vec3 normal_across(uint tet, uint place) {
  vec4 own = mix(vec4(0), vec4(1), corner_at(place));
  return -normalize(vec3(dot(own, BODY.cells.at[tet].along_x), dot(own, BODY.cells.at[tet].along_y),
                         dot(own, BODY.cells.at[tet].along_z)));
}

// Of that normal, between a tet and the one across.
InnerSurface inner_surface(uint tet, uint across, vec3 direction, vec3 normal) {
  InnerSurface met;
  met.normal = normal;
  met.cosine = clamp(dot(direction, normal), 0.0, 1.0);
  met.ratio = sqrt(BODY.etendue.at[tet] / BODY.etendue.at[across]);
  bool from_denser = met.ratio > 1.0;
  float sine2 = from_denser ? met.ratio * met.ratio * (1.0 - met.cosine * met.cosine) : 0.0;  // across
  float thinner = from_denser ? sqrt(max(1.0 - sine2, 0.0)) : met.cosine;  // cosine in the medium of less index
  met.reflected = sine2 >= 1.0 ? 1.0 : fresnel_reflectance(thinner, from_denser ? met.ratio : 1.0 / met.ratio);
  return met;
}

vec3 mirrored(InnerSurface met, vec3 direction) {
  return normalize(direction - 2.0 * met.cosine * met.normal);
}

// Of light that goes through.
vec3 bent(InnerSurface met, vec3 direction) {
  float cosine = sqrt(max(1.0 - met.ratio * met.ratio * (1.0 - met.cosine * met.cosine), 0.0));
  return normalize(met.ratio * (direction - met.cosine * met.normal) + cosine * met.normal);
}

// Turns a ray that leaves a tet by the face opposite a corner, by a chance that is even in [0, 1). Returns whether it
// goes through.
bool goes_through(uint tet, uint place, uint across, float chance, inout vec3 direction) {
  InnerSurface met = inner_surface(tet, across, direction, normal_across(tet, place));
  bool through = chance >= met.reflected;
  direction = through ? bent(met, direction) : mirrored(met, direction);
  return through;
}

#endif
