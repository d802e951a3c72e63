// Walks that know where light matters: the importance of a place, what light scattered there brings to where it is
// looked for, steers them without bias (docs/physics.md, "Certificate"). The shader that includes it has FIELD's BODY
// and push constants `push` with importance as CertifyPush has it.
#ifndef QUADGRAPH_IMPORTANCE_GLSL
#define QUADGRAPH_IMPORTANCE_GLSL

#include "source/tet_ray.glsl"
#include "transport/phase_function.glsl"

// What a direction is worth at least, as a share of its place.
const float LEAST_WORTH = 0.25;

// A walk without importance that counts with less of the unit goes on by chance, with this much.
const float PLAIN_LEAST = 0.05;

// Times its importance, a walk counts with no less and no more than this of the unit: it ends by chance, or goes on as
// several.
const float GUIDED_LEAST = 0.3;
const float GUIDED_MOST = 2.0;

// Walks that wait for the present one to end; where more would, none divides.
const uint MOST_WAITING = 12u;

// At the corners of a tet, of a channel.
vec4 importance_at_corners(uint tet, uint channel) {
  uvec4 ids = BODY.tets.at[tet];
  return vec4(push.importance.at[ids.x][channel], push.importance.at[ids.y][channel],
              push.importance.at[ids.z][channel], push.importance.at[ids.w][channel]);
}

// Of two directions that are as likely, by chance the one that leads to more, as P1 has the importance of directions:
// I + grad I / sigma_tr. sigma: of scattering and absorption, 1/mm. Returns what its light counts with, so that the mean
// stays what it is.
float turn_to_more(TetPoint at, vec3 from, uint channel, float g, vec2 sigma, inout vec3 direction,
                   inout uint state) {
  vec3 other = g == 0.0 ? -direction : 2.0 * dot(direction, from) * from - direction;
  vec4 corners = importance_at_corners(at.tet, channel);
  vec3 slope = vec3(dot(corners, BODY.cells.at[at.tet].along_x), dot(corners, BODY.cells.at[at.tet].along_y),
                    dot(corners, BODY.cells.at[at.tet].along_z));
  slope /= ((1.0 - g) * sigma.x + sigma.y) * dot(at.l, corners);
  vec2 worth = max(1.0 + vec2(dot(direction, slope), dot(other, slope)), vec2(LEAST_WORTH));
  float mean = 0.5 * (worth.x + worth.y);
  if (2.0 * mean * uniform_number(state) < worth.x) return mean / worth.x;
  direction = other;
  return mean / worth.y;
}

#endif
