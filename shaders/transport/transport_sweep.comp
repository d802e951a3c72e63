#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "source/fixed_point.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Fluence by the transport equation at every point, less what the solve has there, as a load on the vertices.
struct TransportSweepPush {
  TransportFieldRefs field;  // one
  Uints drawn;               // one: how many points there are
  TransportPoints points;
  Uints load;  // fixed point, of each half for all vertices what is added, then what is taken away
  uint room;
  uint directions;
  uint vertex_count;
};
layout(push_constant, scalar) uniform Block { TransportSweepPush push; };

TransportFieldRef field;
#define FIELD field
#include "transport/transport_ray.glsl"

const float TWO_PI = 6.2831853;

vec3 on_sphere(float z, float azimuth) {
  float s = sqrt(max(1.0 - z * z, 0.0));
  return vec3(s * cos(azimuth), s * sin(azimuth), z);
}

// Uniform in a tet (Rocchini and Cignoni 2000).
vec4 in_tet(inout uint state) {
  float s = uniform_number(state), t = uniform_number(state), u = uniform_number(state);
  if (s + t > 1.0) {
    s = 1.0 - s;
    t = 1.0 - t;
  }
  if (t + u > 1.0) {
    float before = u;
    u = 1.0 - s - t;
    t = 1.0 - before;
  } else if (s + t + u > 1.0) {
    float before = u;
    u = s + t + u - 1.0;
    s = 1.0 - t - before;
  }
  return vec4(1.0 - s - t - u, s, t, u);
}

// Two unit vectors, orthogonal to each other and to the unit vector n (Duff et al. 2017).
void frame_about(vec3 n, out vec3 a, out vec3 b) {
  float side = n.z < 0.0 ? -1.0 : 1.0;
  float c = -1.0 / (side + n.z), d = n.x * n.y * c;
  a = vec3(1.0 + side * n.x * n.x * c, side * d, -side * n.x);
  b = vec3(d, side + n.y * n.y * c, -n.y);
}

// Mean over directions that are spread evenly and turned at random.
vec3 transported(uint tet, vec4 l, inout uint state) {
  float z = 2.0 * uniform_number(state) - 1.0;
  vec3 axis = on_sphere(z, TWO_PI * uniform_number(state)), a, b;
  frame_about(axis, a, b);
  float turned = TWO_PI * uniform_number(state);
  vec3 sum = vec3(0);
  for (uint k = 0u; k < push.directions; ++k) {
    vec3 d = on_sphere(1.0 - (2.0 * float(k) + 1.0) / float(push.directions), turned + GOLDEN_ANGLE * float(k));
    vec3 direction = normalize(d.x * a + d.y * b + d.z * axis);
    start_in_tet(tet, l, direction);
    sum += arriving(tet, direction, state);
  }
  return sum / float(push.directions);
}

void add_load(uint vertex, uint half_of, vec3 load) {
  uint at = 2u * half_of * push.vertex_count + vertex;
  add_power(push.load, at, max(load, vec3(0)));
  add_power(push.load, at + push.vertex_count, max(-load, vec3(0)));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  crossed = 0u;
  if (i >= min(push.drawn.at[0], push.room)) return;
  TransportPoint point = push.points.at[i];
  uint state = point.seed;
  vec4 l = in_tet(state);
  vec3 now = transported(point.tet, l, state);
  uvec4 ids = BODY.tets.at[point.tet];
  optical = BODY.optical.at[(BODY.flags & BODY_EVEN) != 0u ? 0u : point.tet];
  vec3 before = vec3(0);
  for (uint k = 0u; k < 4u; ++k) before += l[k] * field.fluence.at[ids[k]];
  vec3 load = point.volume * optical.sigma_s_prime * (now - before);
  for (uint k = 0u; k < 4u; ++k) add_load(ids[k], point.half_of, l[k] * load);
  atomicAdd(field.segments.at[0], crossed);
}
