#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/shaped.glsl"
#include "material/fresnel.glsl"
#include "light/environment.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// What the body hides of every environment from the faces of the level whose rays are known, as q over its power.
struct EnvironmentHiddenPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Uvec2s rows;  // as ExchangePush
  Uints entries;
  LightRecords lights;
  LightShapes shapes;
  Vec3s hidden;  // written
  uint face_count;
  uint light_count;
  float rays;  // per face
};
layout(push_constant, scalar) uniform Block { EnvironmentHiddenPush push; };

struct Place {
  vec3 centre, normal;
};

Place place_of(uint face) {
  uvec3 ids = push.faces.at[face];
  vec3 a = push.vertices.at[ids.x], b = push.vertices.at[ids.y], c = push.vertices.at[ids.z];
  return Place((a + b + c) / 3.0, normalize(cross(b - a, c - a)));
}

// The rays of a face are cosine-weighted: each stands for pi / rays of irradiance over radiance. What a ray met is kept,
// not the ray: it went about towards the middle of that face.
vec3 hidden_from(uint face, LightShape shape) {
  Place own = place_of(face);
  uvec2 row = push.rows.at[face];
  OpticalSurface surface = surface_of(push.face_kinds, face);
  vec3 sum = vec3(0);
  for (uint k = row.x; k < row.y; ++k) {
    vec3 way = normalize(place_of(push.entries.at[k]).centre - own.centre);
    float cosine = clamp(dot(way, own.normal), 0.0, 1.0);
    sum += surface_transmittance(cosine, surface) * environment_at(shape, ENVIRONMENT_RAYS, way);
  }
  return 3.14159265 / push.rays * sum;
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.face_count) return;
  uint environment = 0u;
  for (uint i = 0u; i < push.light_count; ++i) {
    if (push.lights.at[i].kind != LIGHT_ENVIRONMENT) continue;
    push.hidden.at[environment++ * push.face_count + f] = hidden_from(f, push.shapes.at[i]);
  }
}
