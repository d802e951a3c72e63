#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather_shared.h"
#include "fresnel.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { RadianceProbePush push; };

BodyRef body;
#define BODY body
#define POINTS push.points
#include "gather.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  body = push.body.at[0];
  uint face = push.face.at[i];
  uvec3 ids = BODY.faces.at[face];
  vec3 p = BODY.vertices.at[ids.x];
  vec3 normal = normalize(cross(BODY.vertices.at[ids.y] - p, BODY.vertices.at[ids.z] - p));
  Gathered light = leaving(face, vec3(1.0 / 3.0), push.direction.at[i], normal, push.scale, push.radiance_norm);
  push.radiance.at[i] = light.radiance;
  push.transmittance.at[i] = light.seen;
}
