// Facets that faces of the surface are made of for the light that enters by them, where a normal map leans these. Two
// numbers per face say how: by how much the height that they are the slopes of grows along its first and its last edge,
// mm, which is so in any shape of the body.
#ifndef QUADGRAPH_LEANING_GLSL
#define QUADGRAPH_LEANING_GLSL

#include "material/fresnel.glsl"
#include "shared/refraction.h"

// Of one face.
struct Leaning {
  vec3 across;   // square to the facets, so long as they are larger than the face below them
  float cosine;  // of the angle between both; 1: the face itself, whose normal `across` is
};

Leaning upright(vec3 normal) {
  return Leaning(normal, 1.0);
}

// Of the face a, a + ab, a + ac, whose kinds end with where the numbers of all faces lie, or 0.
Leaning leaning_of(Uints kinds, uint face, vec3 normal, vec3 ab, vec3 ac) {
  uint end = FACE_HEAD + faces_in(kinds);
  uvec2 leans = uvec2(kinds.at[end], kinds.at[end + 1u]);
  float area = dot(normal, cross(ab, ac));
  if (leans == uvec2(0) || area <= 0.0) return upright(normal);
  vec2 rise = vec2(Floats(leans).at[2u * face], Floats(leans).at[2u * face + 1u]);
  if (rise == vec2(0)) return upright(normal);
  vec3 across = normal + (rise.x * cross(ac, normal) + rise.y * cross(normal, ab)) / area;
  return Leaning(across, 1.0 / length(across));
}

// Unit.
vec3 facet_normal(Leaning leaning) {
  return leaning.cosine == 1.0 ? leaning.across : leaning.cosine * leaning.across;
}

// What enters of light from a direction `towards`, outside, at a cosine with the face above 0; per area of the face.
// Facets that turn away get nothing, and others at most twice what the face does: as ridges, one side of which lies in
// the shadow of the other. So as much meets facets that lean to one side and to the other as meets the face.
float let_in_by_facets(Leaning leaning, vec3 towards, float cosine, OpticalSurface surface) {
  if (leaning.cosine == 1.0) return cosine * surface_transmittance(cosine, surface);
  float met = max(dot(leaning.across, towards), 0.0);
  return min(met, 2.0 * cosine) * surface_transmittance(min(leaning.cosine * met, 1.0), surface);
}

#endif
