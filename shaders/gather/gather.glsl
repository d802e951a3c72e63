// Radiance gathered along a view ray, and its scale. The shader that includes it defines
// first BODY and POINTS (gather_fields.glsl).
#ifndef QUADGRAPH_GATHER_GLSL
#define QUADGRAPH_GATHER_GLSL

#include "gather/gather_fields.glsl"
#include "gather/gather_shared.h"
#include "material/fresnel.glsl"

// Where most of a ray leaves the body, to go on outside.
struct Escape {
  vec3 share;      // of the light there that comes through, this surface included
  uint face;       // that it leaves by
  vec3 point;      // mm
  vec3 direction;  // unit, outside
};

struct Gathered {
  vec3 radiance;  // W/(mm^2 sr)
  vec3 seen;      // share of the light behind the body that comes through, both surfaces but the first included
  Escape escape;  // by which most of it does
};

float largest(vec3 v) {
  return max(v.x, max(v.y, v.z));
}

// At the ray's point, on the face opposite slot 3.
Escape escape_here(vec3 share, uint face, vec3 direction, vec3 n, float cosine) {
  vec3 point = corner_0.l * corner_0.position + corner_1.l * corner_1.position + corner_2.l * corner_2.position;
  float cos_o = sqrt(max(1.0 - BODY.eta * BODY.eta * (1.0 - cosine * cosine), 0.0));
  return Escape(share, face, point, normalize(BODY.eta * (direction - cosine * n) + cos_o * n));
}

// One step of transport: collided and uncollided fluence scattered into a ray that goes from its point into the body.
Gathered gather(uint tet, vec3 direction) {
  Gathered sum = Gathered(vec3(0), vec3(0), Escape(vec3(0), 0u, vec3(0), vec3(0)));
  vec3 left = vec3(1);
  GatherPoint here = fields_here();
  for (uint step = 0u; step < GATHER_STEPS; ++step) {
    Exit exit = find_exit(direction);
    if (!exit.found) break;
    vec4 l = exit_point(exit);
    GatherPoint there = fields_at(l);
    vec3 lost, fluence = fluence_along(here, there, extinction() * exit.path, lost);
    vec3 last = left * optical.sigma_s_prime * (exit.path / FOUR_PI) * fluence;
    sum.radiance += last;
    left -= left * lost;
    here = there;
    move_to(l);
    if (ends(left, sum.radiance, last, lost)) break;
    uvec2 crossing = turn(tet, exit.slot);
    if (crossing.x < BODY.tet_count) {
      tet = crossing.x;
      enter(crossing);
      continue;
    }
    vec3 n = exit.outward / length(exit.outward);
    float cosine = dot(direction, n);
    if (BODY.face_kinds.at[crossing.x - BODY.tet_count] == FACE_OPEN) {
      float reflected = internal_reflectance(cosine, BODY.eta);
      vec3 through = left * (1.0 - reflected);
      sum.seen += through;
      if (largest(through) > largest(sum.escape.share)) {
        sum.escape = escape_here(through, crossing.x - BODY.tet_count, direction, n, cosine);
      }
      left *= reflected;
      if (reflected == 0.0) break;
    }
    direction = normalize(direction - 2.0 * cosine * n);
  }
  sum.radiance += left * even_radiance(here);
  return sum;
}

#endif
