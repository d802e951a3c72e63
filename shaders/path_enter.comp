#version 460
#extension GL_GOOGLE_include_directive : require
#include "path_light_shared.h"
#include "lights.glsl"
#include "fresnel.glsl"
#include "environment.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { PathEnterPush push; };
#define GRID push.grid
#include "path_crossings.glsl"
#include "entering.glsl"

vec3 entering_from(uint number, vec3 position, vec3 normal) {
  LightRecord light = load_light(push.lights, number);
  if (light.kind == LIGHT_AMBIENT) return push.diffuse_transmittance * light.power;
  Lamp lamp = Lamp(light, no_shape(), 0u, push.grid.cell);
  if (SHAPED) lamp.shape = load_light_shape(push.shapes, number);
  if (SHAPED && light.kind == LIGHT_ENVIRONMENT) {
    return environment_at(lamp.shape, ENVIRONMENT_ENTERING, normal) * light.power;
  }
  if (SHAPED && light.kind == LIGHT_PROJECTOR) {
    vec3 share;
    for (lamp.channel = 0u; lamp.channel < 3u; ++lamp.channel) share[lamp.channel] = share_at(lamp, position, normal);
    return share * light.power;
  }
  return share_at(lamp, position, normal) * light.power;
}

// W/mm^2, of all lights.
vec3 entering_at(vec3 position, vec3 normal) {
  vec3 sum = vec3(0);
  for (uint i = 0u; i < push.light_count; ++i) sum += entering_from(i, position, normal);
  return sum;
}

vec3 normal;  // unit, of the triangle, as its corners turn

bool inside(uvec3 cell, uint axis, float at) {
  if (at < 0.0 || at >= float(GRID.size[axis])) return false;
  cell[axis] = uint(at);
  return (load_uint(push.flags, cell_number(GRID, cell)) & CELL_INSIDE) != 0u;
}

void crossed(Crossing crossing) {
  uvec3 cell = crossing.column;
  cell[crossing.axis] = uint(clamp(floor(crossing.at), 0.0, float(GRID.size[crossing.axis]) - 1.0));
  vec3 place = vec3(crossing.column) + 0.5;
  place[crossing.axis] = crossing.at;
  vec3 position = GRID.origin + GRID.cell * place;
  // Out is where the cells are not inside, whatever the corners say; a sheet is lit from both sides.
  bool before = inside(crossing.column, crossing.axis, floor(crossing.at + 0.5) - 1.0);
  bool behind = inside(crossing.column, crossing.axis, floor(crossing.at + 0.5));
  vec3 outward = (normal[crossing.axis] > 0.0) == before ? normal : -normal;
  vec3 entering = entering_at(position, before == behind ? normal : outward);
  if (before == behind) entering = max(entering, entering_at(position, -normal));
  uint at = cell_number(GRID, cell), count = cell_count(GRID);
  for (uint c = 0u; c < 3u; ++c) {
    if (entering[c] > 0.0) atomicMax(push.entering.at[c * count + at], floatBitsToUint(entering[c]));
  }
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= 3u * push.stripes * push.triangle_count) return;
  uvec3 ids = load_uvec3(push.triangles, i / (3u * push.stripes));
  uint rest = i % (3u * push.stripes);
  vec3 a = load_vec3(push.vertices, ids.x), b = load_vec3(push.vertices, ids.y), c = load_vec3(push.vertices, ids.z);
  vec3 doubled = cross(b - a, c - a);
  normal = doubled / max(length(doubled), 1e-30);
  cross_triangle(rounded(a), rounded(b), rounded(c), rest / push.stripes, rest % push.stripes, push.stripes);
}
