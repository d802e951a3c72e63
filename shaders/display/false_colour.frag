#version 460
#extension GL_GOOGLE_include_directive : require
#include "display/colour_map.h"
#include "display/false_colour_shared.h"

layout(push_constant, scalar) uniform Block { FalseColourPush push; };
layout(location = 0) in vec3 position;  // mm
layout(location = 1) in vec3 barycentric;
layout(location = 2) in float value;
layout(location = 3) in flat uint flags;
layout(location = 0) out vec4 colour_coverage;  // linear display colour, 1
layout(location = 1) out vec4 nothing;
layout(location = 2) out vec4 nothing_either;

const vec3 PLAIN = vec3(0.16, 0.165, 0.175);
const float EDGE_SAMPLES = 1.2;  // half the width of a line

// 1 on an edge that is to be drawn, 0 off it.
float on_edge() {
  vec3 width = fwidth(barycentric);
  float nearest = 1e9;
  for (uint k = 0u; k < 3u; ++k) {
    if ((flags & FALSE_EDGE << k) != 0u) nearest = min(nearest, barycentric[k] / max(width[k], 1e-9));
  }
  return clamp(EDGE_SAMPLES + 0.5 - nearest, 0.0, 1.0);
}

void main() {
  vec3 normal = cross(dFdx(position), dFdy(position));
  float edge = on_edge();
  if ((flags & FALSE_BEHIND) != 0u && dot(push.plane.xyz, position) > push.plane.w) discard;
  vec3 colour = (flags & FALSE_PLAIN) != 0u ? PLAIN : mapped_colour(value, push.diverging);
  float facing = abs(dot(normalize(normal), towards_eye(push.eye, position)));
  if ((flags & FALSE_SHADED) != 0u) colour *= 0.35 + 0.65 * facing;
  colour_coverage = vec4(mix(colour, 0.25 * colour, edge), 1.0);
  nothing = nothing_either = vec4(0);
}
