#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/creases.h"
#include "surface/surface_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Makes the exitance of open faces even. Any two around a vertex exchange power in proportion to their areas, as far as
// they are coarse, lit alike and parted by no crease: what one loses the other gains.
struct EvenExitancePush {
  Uvec3s faces;
  Uints face_kinds;
  Uints face_offset;  // open faces around each surface vertex
  Uints face_incidence;
  EvenFaces even;
  Vec3s exitance;  // W/mm^2
  uint count;
};
layout(push_constant, scalar) uniform Block { EvenExitancePush push; };

// What the faces around a vertex bring a face, W/mm^2.
vec3 brought(EvenFace face, uint v) {
  vec3 sum = vec3(0), weight = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    EvenFace other = push.even.at[push.face_incidence.at[k]];
    vec3 coarse = other.area * other.share;
    weight += coarse;
    if (other.lit == face.lit) sum += smooth_share(dot(face.normal, other.normal)) * coarse * (other.far - face.far);
  }
  return mix(vec3(0), sum / weight, greaterThan(weight, vec3(0)));
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count || !is_open(push.face_kinds, f)) return;
  EvenFace face = push.even.at[f];
  if (face.share == vec3(0)) return;
  uvec3 ids = push.faces.at[f];
  push.exitance.at[f] += face.share / 3.0 * (brought(face, ids.x) + brought(face, ids.y) + brought(face, ids.z));
}
