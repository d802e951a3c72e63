#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/shaped.glsl"
#include "material/fresnel.glsl"
#include "light/environment.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { EnvironmentHiddenPush push; };

struct Place {
  vec3 centre, normal;
};

Place place_of(uint face) {
  uvec3 ids = load_uvec3(push.faces, face);
  vec3 a = load_vec3(push.vertices, ids.x), b = load_vec3(push.vertices, ids.y), c = load_vec3(push.vertices, ids.z);
  return Place((a + b + c) / 3.0, normalize(cross(b - a, c - a)));
}

// The rays of a face are cosine-weighted: each stands for pi / rays of irradiance over radiance. What a ray met is kept,
// not the ray: it went about towards the middle of that face.
vec3 hidden_from(uint face, LightShape shape) {
  Place own = place_of(face);
  uvec2 row = load_uvec2(push.rows, face);
  vec3 sum = vec3(0);
  for (uint k = row.x; k < row.y; ++k) {
    vec3 way = normalize(place_of(load_uint(push.entries, k)).centre - own.centre);
    float cosine = clamp(dot(way, own.normal), 0.0, 1.0);
    sum += fresnel_transmittance(cosine, push.eta) * environment_at(shape, ENVIRONMENT_RAYS, way);
  }
  return 3.14159265 / push.rays * sum;
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.face_count) return;
  uint environment = 0u;
  for (uint i = 0u; i < push.light_count; ++i) {
    if (load_light(push.lights, i).kind != LIGHT_ENVIRONMENT) continue;
    push.hidden.at[environment++ * push.face_count + f] = hidden_from(f, load_light_shape(push.shapes, i));
  }
}
