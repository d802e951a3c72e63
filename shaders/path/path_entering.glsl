// What of all lights enters a cell at a point of the surface. With the push constants of the passes that do so.
#ifndef QUADGRAPH_PATH_ENTERING_GLSL
#define QUADGRAPH_PATH_ENTERING_GLSL

#include "light/environment.glsl"
#include "light/lights.glsl"
#include "material/fresnel.glsl"
#include "path/path_light_shared.h"

layout(push_constant, scalar) uniform Block { PathEnterPush push; };
#define ENTERED push
#include "light/entering.glsl"

// Whether solid cells lie between a point of the surface and a light.
bool hidden_by_cells(LightRecord light, vec3 position, vec3 normal) {
  vec3 way = light.kind == LIGHT_DIRECTIONAL ? light.towards_or_at : light.towards_or_at - position;
  float far = light.kind == LIGHT_DIRECTIONAL ? 1e30 : length(way) / push.grid.cell;
  way = normalize(way);
  vec3 place = (position - push.grid.origin) / push.grid.cell + 1.5 * normal;
  for (float t = 0.5; t < far; t += 0.5) {
    ivec3 cell = ivec3(floor(place + t * way));
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(push.grid.size)))) return false;
    if ((push.flags.at[cell_number(push.grid, uvec3(cell))] & CELL_SOLID) != 0u) return true;
  }
  return false;
}

float share_seen(Lamp lamp, vec3 position, vec3 normal) {
  if (push.tools.count == 0u) return share_at(lamp, position, normal);
  float share = share_from(lamp, position, normal);
  return share > 0.0 && !hidden_by_cells(lamp.light, position, normal) ? share : 0.0;
}

vec3 entering_from(uint number, vec3 position, vec3 normal) {
  LightRecord light = push.lights.at[number];
  if (light.kind == LIGHT_AMBIENT) return push.diffuse_transmittance * light.power;
  OpticalSurface surface = OpticalSurface(push.eta, push.coat_eta, push.coat, 0.0, 0.0, uvec2(0));
  Lamp lamp = Lamp(light, no_shape(), 0u, push.grid.cell, surface, upright(normal));
  if (SHAPED) lamp.shape = push.shapes.at[number];
  if (SHAPED && light.kind == LIGHT_ENVIRONMENT) {
    return environment_at(lamp.shape, ENVIRONMENT_ENTERING, normal) * light.power;
  }
  vec3 share;
  uint channels = channels_of(light);
  for (lamp.channel = 0u; lamp.channel < channels; ++lamp.channel) share[lamp.channel] = share_seen(lamp, position, normal);
  return (channels == 1u ? vec3(share.x) : share) * light.power;
}

// W/mm^2, of all lights.
vec3 entering_at(vec3 position, vec3 normal) {
  vec3 sum = vec3(0);
  for (uint i = 0u; i < push.light_count; ++i) sum += entering_from(i, position, normal);
  return sum;
}

void enter(uint cell, vec3 entering) {
  uint count = cell_count(push.grid);
  for (uint c = 0u; c < 3u; ++c) {
    if (entering[c] > 0.0) atomicMax(push.entering.at[c * count + cell], floatBitsToUint(entering[c]));
  }
}

#endif
