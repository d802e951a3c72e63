// Light at the surface that it enters by, and uniform light as a bundle of rays.
#ifndef QUADGRAPH_LAMBERTIAN_GLSL
#define QUADGRAPH_LAMBERTIAN_GLSL

#include "material/fresnel.glsl"
#include "shared/beam_shared.h"
#include "source/face_azimuth.glsl"

// Behind the surface: shares p_k of the power at inside cosines mu_k, the Gauss nodes of the outside cosine.
struct Lambertian {
  vec4 share, cosine;
};

Lambertian lambertian(OpticalSurface surface) {
  Lambertian light;
  for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) {
    light.share[k] = LAMBERTIAN_W[k] * surface_transmittance(sqrt(LAMBERTIAN_U[k]), surface);
    light.cosine[k] = cosine_inside(sqrt(LAMBERTIAN_U[k]), surface);
  }
  light.share /= dot(light.share, vec4(1));
  return light;
}

// A unit vector in a face, given one of its edges; it moves with the body, lies along no edge, and differs from face to
// face without order.
vec3 face_tangent(uint face, vec3 normal, vec3 edge) {
  float azimuth = face_azimuth(face, 0u);
  vec3 t = normalize(edge);
  return cos(azimuth) * t + sin(azimuth) * cross(normal, t);
}

// The way that ray `ray` of the bundle travels outside; two rays per node. `tangent` is that of the face.
vec3 lambertian_incoming(uint ray, vec3 normal, vec3 tangent) {
  uint node = ray / 2u;
  float u = LAMBERTIAN_U[node];
  vec3 across = (node & 1u) == 1u ? cross(normal, tangent) : tangent;
  return ((ray & 1u) == 0u ? 1.0 : -1.0) * sqrt(1.0 - u) * across - sqrt(u) * normal;
}

// Light at grazing incidence, or even from behind by rounding, still goes in.
vec3 refracted(vec3 incoming, vec3 normal, float eta) {
  float cos_i = clamp(-dot(incoming, normal), 0.0, 1.0);
  float cos_t = sqrt(max(1.0 - (1.0 - cos_i * cos_i) / (eta * eta), 0.0));
  return normalize(incoming / eta + (cos_i / eta - cos_t) * normal);
}

// As deep as light goes on average by a surface of that normal, rough or smooth.
vec3 refracted_on_average(vec3 incoming, vec3 normal, OpticalSurface surface) {
  vec3 inside = refracted(incoming, normal, surface.eta);
  if (surface.roughness == 0.0) return inside;
  float cosine = cosine_inside(clamp(-dot(incoming, normal), 0.0, 1.0), surface);
  vec3 aside = inside - dot(inside, normal) * normal;
  float sine = length(aside);
  if (sine < 1e-6) return inside;
  return normalize(sqrt(max(1.0 - cosine * cosine, 0.0)) / sine * aside - cosine * normal);
}

// A way inside that a facet of a face gave: never out of the face.
const float LEAST_DOWN = 0.02;

vec3 into_face(vec3 inside, vec3 normal, vec3 facet) {
  float up = dot(inside, normal);
  return facet == normal || up <= -LEAST_DOWN ? inside : normalize(inside - (up + LEAST_DOWN) * normal);
}

// On average, by facets about that unit normal of a leaning face.
vec3 goes_in(vec3 incoming, vec3 normal, vec3 facet, OpticalSurface surface) {
  return into_face(refracted_on_average(incoming, facet, surface), normal, facet);
}

#endif
