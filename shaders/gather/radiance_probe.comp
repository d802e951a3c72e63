#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "material/fresnel.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { RadianceProbePush push; };

SolidRef solid;
#define BODY solid.body
#define TREE_BODY solid.body
#define TREE solid.tree
#define POINTS push.points
#include "gather/leaving.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  solid = load_solid(push.solid);
  uint face = load_uint(push.face, i);
  uvec3 ids = load_uvec3(BODY.faces, face);
  vec3 p = load_vec3(BODY.vertices, ids.x);
  vec3 normal = normalize(cross(load_vec3(BODY.vertices, ids.y) - p, load_vec3(BODY.vertices, ids.z) - p));
  Leaving light = leaving(face, vec3(1.0 / 3.0), load_vec3(push.direction, i), normal, push.scale, push.radiance_norm);
  push.radiance.at[i] = light.radiance;
  push.transmittance.at[i] = light.seen;
}
