// Ways about a normal of the surface, as microfacets.h has them.
#ifndef QUADGRAPH_FACET_FRAME_GLSL
#define QUADGRAPH_FACET_FRAME_GLSL

#include "shared/microfacets.h"

struct FacetFrame {
  vec3 across, up, normal;
};

// Not frame_about, which leaps where n.z is 0: there lie sides of boxes, and rounding would choose their facets.
FacetFrame facet_frame(vec3 n) {
  vec3 across = normalize(cross(abs(n.x) < 0.5 ? vec3(1, 0, 0) : vec3(0, 1, 0), n));
  return FacetFrame(across, cross(n, across), n);
}

// A unit way that points out of the surface, turned so if it does not.
vec3 into_frame(FacetFrame frame, vec3 way) {
  return normalize(vec3(dot(way, frame.across), dot(way, frame.up), max(dot(way, frame.normal), LEAST_SEEN_COSINE)));
}

vec3 out_of_frame(FacetFrame frame, vec3 local) {
  return local.x * frame.across + local.y * frame.up + local.z * frame.normal;
}

#endif
