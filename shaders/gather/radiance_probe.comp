#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "material/fresnel.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Radiance that leaves the centroids of faces.
struct RadianceProbePush {
  SolidRefs solid;  // one
  GatherPoints points;
  GatherScales scale;
  Uints face;
  Vec3s direction;      // unit, outward
  Vec3s radiance;       // W/(mm^2 sr), written: scattered
  Vec3s transmittance;  // written
  uint count;
};
layout(push_constant, scalar) uniform Block { RadianceProbePush push; };

SolidRef solid;
#define BODY solid.body
#define TREE_BODY solid.body
#define TREE solid.tree
#define NORMALS solid.normals
#define FORWARD_LIGHT solid.forward
#define POINTS push.points
#include "gather/leaving.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  solid = push.solid.at[0];
  uint face = push.face.at[i];
  uvec3 ids = BODY.faces.at[face];
  vec3 p = BODY.vertices.at[ids.x];
  vec3 normal = normalize(cross(BODY.vertices.at[ids.y] - p, BODY.vertices.at[ids.z] - p));
  Leaving light = leaving(face, vec3(1.0 / 3.0), push.direction.at[i], normal, push.scale, SMOOTH, VIEW_PARTS);
  push.radiance.at[i] = light.radiance;
  push.transmittance.at[i] = light.seen;
}
