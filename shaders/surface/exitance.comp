#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// phi and M = k11 phi + k12 phi2 - reflected q per outside face, 0 at reflecting ones. fem: the mean
// over the face's vertices; graph methods: the surface node, x at tet_count + face. With `clipped` 1 negative values at
// vertices or nodes count as 0, and the factor is found that restores the power.
struct ExitancePush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Boundaries boundaries;  // by body
  Fields x;
  Vec3s to_phi;
  Vec3s q;
  Scales scale;
  Vec3s phi;
  Vec3s exitance;
  Clips clip;
  Reduction reduction;
  uint count;
  uint tet_count;
  uint fem;  // 1: fem, 0: graph methods
  uint clipped;
};
layout(push_constant, scalar) uniform Block { ExitancePush push; };

// phi, and the outward flux as it is and without what is negative at the carriers, in units of the scale.
struct Surface {
  vec3 phi, raw, positive;
};

Surface at_face(uint f, Boundary boundary) {
  if (push.fem == 0u) {
    uint node = push.tet_count + f;
    Field x = scaled(element_or_one(push.to_phi, node), push.x.at[node]);
    vec3 flux = outward_flux(boundary, x);
    return Surface(x.phi, flux, max(flux, vec3(0)));
  }
  Surface mean = Surface(vec3(0), vec3(0), vec3(0));
  uvec3 corners = push.faces.at[f];
  for (int k = 0; k < 3; ++k) {
    Field x = scaled(element_or_one(push.to_phi, corners[k]), push.x.at[corners[k]]);
    vec3 flux = outward_flux(boundary, x);
    mean.phi += x.phi / 3.0;
    mean.raw += flux / 3.0;
    mean.positive += max(flux, vec3(0)) / 3.0;
  }
  return mean;
}

float area_of(uint f) {
  uvec3 corners = push.faces.at[f];
  vec3 p = push.vertices.at[corners.x];
  return 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
}

void main() {
  vec3 negative = vec3(0), positive = vec3(0);  // integrals over the face
  EACH(f, push.count) {
    Surface surface = Surface(vec3(0), vec3(0), vec3(0));
    Boundary boundary = push.boundaries.at[body_behind(push.face_kinds, f)];
    if (is_open(push.face_kinds, f)) surface = at_face(f, boundary);
    vec3 scale = push.scale.at[0].scale;
    push.phi.at[f] = surface.phi * scale;
    if (push.clipped == 1u) {
      float area = area_of(f);
      negative += area * (surface.positive - surface.raw);
      positive += area * surface.positive;
      push.exitance.at[f] = surface.positive * scale;
    } else {
      bool open = is_open(push.face_kinds, f);
      vec3 reflected = open ? boundary.reflected * push.q.at[f] : vec3(0);
      push.exitance.at[f] = surface.raw * scale - reflected;
    }
  }
  vec3 total_negative, total_positive;
  if (!reduce_dispatch_pair(push.reduction, negative, positive, total_negative, total_positive)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  // What linear elements put below zero is taken from all that is above, so that the power stays what was solved for.
  vec3 share = mix(vec3(0), min(total_negative / total_positive, vec3(1)), greaterThan(total_positive, vec3(0)));
  push.clip.at[0] = Clip(1.0 - share, share);
}
