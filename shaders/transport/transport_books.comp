#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/fixed_point.glsl"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// What the points of each half are missing. All light that the field scatters is lost on its way through the body or
// leaves, and what leaves is gathered with little noise: so the sum of what the points sample is known.
struct TransportBooksPush {
  TransportBooks books;
  Uints points;  // fixed point, WALK_SUMS times two per half: power that the points found, added, then taken away
  Uints again;   // fixed point, WALK_SUMS times four: what leaves, added and taken away, and what of that enters again
  Vec3s unit;    // one: the scale of what is known
  Scales scale;
  float share;  // of what was found that counts
  float keep;   // of what is known
};
layout(push_constant, scalar) uniform Block { TransportBooksPush push; };

#include "transport/kept.glsl"

vec3 sum_of(Uints sums, uint first, uint step) {
  vec3 sum = vec3(0);
  for (uint k = 0u; k < WALK_SUMS; ++k) sum += power_at(sums, first + step * k);
  return sum;
}

vec3 found_by(uint half_of, vec3 known) {
  uint first = 2u * WALK_SUMS * half_of;
  return push.share * (sum_of(push.points, first, 2u) - sum_of(push.points, first + 1u, 2u)) + kept(known);
}

vec3 ratio(vec3 part, vec3 whole) {
  return mix(part / whole, vec3(0), lessThanEqual(whole, vec3(0)));
}

void main() {
  if (gl_GlobalInvocationID.x != 0u) return;
  TransportBook book = push.books.at[0];
  vec3 left = sum_of(push.again, 0u, 4u) - sum_of(push.again, 1u, 4u) + kept(book.known_left);
  vec3 again = sum_of(push.again, 2u, 4u) - sum_of(push.again, 3u, 4u) + kept(book.known_again);
  vec3 returns = clamp(ratio(again, left), vec3(0), vec3(1)), excess = book.first - book.absorbed;
  vec3 sum_a = excess - (1.0 - returns) * book.leaving_a, sum_b = excess - (1.0 - returns) * book.leaving_b;
  vec3 per_lost = ratio(vec3(1), book.lost);
  push.books.at[0].left = left;
  push.books.at[0].again = again;
  vec3 leaving = 0.5 * (book.leaving_a + book.leaving_b);
  push.books.at[0].gain = 1.0 / (1.0 - min(returns * ratio(leaving, leaving + book.absorbed), vec3(0.9)));
  push.books.at[0].sum_a = sum_a;
  push.books.at[0].sum_b = sum_b;
  push.books.at[0].missing_a = per_lost * (sum_a - found_by(0u, book.known_a));
  push.books.at[0].missing_b = per_lost * (sum_b - found_by(1u, book.known_b));
}
