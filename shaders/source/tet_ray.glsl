// A ray through the tets of a level. The shader that includes it defines first
//   BODY                     where the BodyRef is, e.g. push.body
//   struct Payload           what a corner carries
//   Payload payload(uint id) that of vertex `id`, when the ray first sees it
//
// The ray's point is carried in barycentric coordinates, which pass from tet to tet with the shared corners: it then
// never leaves the mesh by rounding. The corner that the next tet does not share always sits in slot 3, opposite the
// face that the ray comes in through. Nearly all of the time goes to loads (lavapipe: some 3 loads cost as much as all
// arithmetic of a tet), so that a tet is read only as far as it is new: its crossing, one vertex and, in a varied
// material, its coefficients.
#ifndef QUADGRAPH_TET_RAY_GLSL
#define QUADGRAPH_TET_RAY_GLSL

#include "shared/body_shared.h"

#ifndef BODY
#error "tet_ray.glsl: BODY is not defined"
#endif

struct Corner {
  uint id;
  uint place;     // among the corners of the present tet
  vec3 position;  // mm
  float l;        // barycentric coordinate of the ray's point
  Payload payload;
};

// Where a ray leaves a tet.
struct Exit {
  uint slot;     // of the corner opposite, 0 to 2
  bool found;    // false in a tet so flat that its faces have no side, and in one that is turned inside out
  float time;    // length over six volumes, 1/mm^2
  float path;    // mm
  vec4 rate;     // of the barycentric coordinates per time
  vec3 outward;  // normal, not of unit length
};

Corner corner_0, corner_1, corner_2, corner_3;
Optical optical;  // of the present tet

const float NEVER = 1e37;

// Share of the power that is lost along `tau`, 1 - e^-tau, and the mean place of the loss, 0 at entry to 1 at exit,
// 1/tau - 1/(e^tau - 1). Series where these cancel.
void attenuate(vec3 tau, out vec3 lost, out vec3 place) {
  bvec3 small = lessThan(tau, vec3(0.25));
  vec3 t = min(tau, vec3(0.25));
  vec3 series = t * (1.0 - t * (1.0 / 2.0 - t * (1.0 / 6.0 - t * (1.0 / 24.0 - t * (1.0 / 120.0 - t * (1.0 / 720.0))))));
  vec3 left = exp(-tau);
  lost = mix(1.0 - left, series, small);
  place = mix((lost - tau * left) / (tau * lost), 0.5 - t * (1.0 / 12.0 - t * t * (1.0 / 720.0)), small);
}

// Mean over s from 0 to 1 of mix(a, b, s) exp(-tau s); `lost` is 1 - exp(-tau).
vec3 attenuated_mean(vec3 a, vec3 b, vec3 tau, out vec3 lost) {
  vec3 place;
  tau = max(tau, vec3(1e-20));
  attenuate(tau, lost, place);
  return lost / tau * mix(a, b, place);
}

vec3 extinction() {
  return optical.sigma_s_prime + optical.sigma_a;
}

uint place_of(uint id, uvec4 tet) {
  return id == tet.x ? 0u : id == tet.y ? 1u : id == tet.z ? 2u : 3u;
}

// Corners of an outside face, as columns.
mat3 corners_of(uvec3 ids) {
  return mat3(BODY.vertices.at[ids.x], BODY.vertices.at[ids.y], BODY.vertices.at[ids.z]);
}

// Puts the ray's point on an outside face of `tet`, at the barycentric coordinates `l`.
void start_on_face(uint tet, uvec3 ids, mat3 corners, vec3 l) {
  uvec4 all = BODY.tets.at[tet];
  uint apex = all.x + all.y + all.z + all.w - ids.x - ids.y - ids.z;
  optical = BODY.optical.at[(BODY.flags & BODY_EVEN) != 0u ? 0u : tet];
  corner_0 = Corner(ids.x, place_of(ids.x, all), corners[0], l.x, payload(ids.x));
  corner_1 = Corner(ids.y, place_of(ids.y, all), corners[1], l.y, payload(ids.y));
  corner_2 = Corner(ids.z, place_of(ids.z, all), corners[2], l.z, payload(ids.z));
  corner_3 = Corner(apex, place_of(apex, all), BODY.vertices.at[apex], 0.0, payload(apex));
}

// Whether the present tet, of this signed volume as find_exit takes it, is turned inside out.
bool inside_out(float six_volume) {
  uint p_0 = corner_0.place, p_1 = corner_1.place, p_2 = corner_2.place, p_3 = corner_3.place;
  bool odd = (((p_0 > p_1) != (p_0 > p_2)) != ((p_0 > p_3) != (p_1 > p_2))) != ((p_1 > p_3) != (p_2 > p_3));
  return odd != (six_volume > 0.0);
}

Exit find_exit(vec3 direction) {
  vec3 a = corner_0.position - corner_3.position;
  vec3 b = corner_1.position - corner_3.position;
  vec3 c = corner_2.position - corner_3.position;
  vec3 n_0 = cross(b, c), n_1 = cross(c, a), n_2 = cross(a, b);
  float six_volume = dot(a, n_0);
  float side = six_volume < 0.0 ? -1.0 : 1.0;
  vec3 rate = side * vec3(dot(n_0, direction), dot(n_1, direction), dot(n_2, direction));
  vec3 l = vec3(corner_0.l, corner_1.l, corner_2.l);
  vec3 time = mix(vec3(NEVER), l / -rate, lessThan(rate, vec3(0)));
  Exit exit;
  exit.time = min(time.x, min(time.y, time.z));
  exit.slot = time.x == exit.time ? 0u : time.y == exit.time ? 1u : 2u;
  exit.found = exit.time < NEVER && ((BODY.flags & BODY_INVERTED) == 0u || !inside_out(six_volume));
  exit.path = exit.time * abs(six_volume);
  exit.rate = vec4(rate, -(rate.x + rate.y + rate.z));
  exit.outward = -side * (exit.slot == 0u ? n_0 : exit.slot == 1u ? n_1 : n_2);
  return exit;
}

// Barycentric coordinates at the exit.
vec4 exit_point(Exit exit) {
  vec4 l = vec4(corner_0.l, corner_1.l, corner_2.l, corner_3.l) + exit.time * exit.rate;
  l = max(l, vec4(0));
  l[exit.slot] = 0.0;
  return l / (l.x + l.y + l.z + l.w);
}

void move_to(vec4 l) {
  corner_0.l = l.x;
  corner_1.l = l.y;
  corner_2.l = l.z;
  corner_3.l = l.w;
}

void swap_with_3(inout Corner corner) {
  Corner other = corner_3;
  corner_3 = corner;
  corner = other;
}

// Puts the corner opposite the exit into slot 3 and returns what lies across, and the places of all corners in it.
uvec2 turn(uint tet, uint slot) {
  if (slot == 0u) {
    swap_with_3(corner_0);
  } else if (slot == 1u) {
    swap_with_3(corner_1);
  } else {
    swap_with_3(corner_2);
  }
  uint crossing = BODY.crossings.at[4u * tet + corner_3.place];
  uint last = (crossing ^ crossing >> 2u ^ crossing >> 4u) & 3u;
  return uvec2(crossing >> CROSSING_BITS, crossing & 63u | last << 6u);
}

// For a ray that begins anywhere in its tet: puts the corner that it moves towards fastest into slot 3, which is none of
// those it can leave opposite of.
void face_towards(vec3 direction) {
  vec4 rate = find_exit(direction).rate;
  float most = max(max(rate.x, rate.y), max(rate.z, rate.w));
  if (rate.x == most) {
    swap_with_3(corner_0);
  } else if (rate.y == most) {
    swap_with_3(corner_1);
  } else if (rate.z == most) {
    swap_with_3(corner_2);
  }
}

// Puts the ray's point into a tet, at the barycentric coordinates `l`.
void start_in_tet(uint tet, vec4 l, vec3 direction) {
  uvec4 ids = BODY.tets.at[tet];
  optical = BODY.optical.at[(BODY.flags & BODY_EVEN) != 0u ? 0u : tet];
  corner_0 = Corner(ids.x, 0u, BODY.vertices.at[ids.x], l.x, payload(ids.x));
  corner_1 = Corner(ids.y, 1u, BODY.vertices.at[ids.y], l.y, payload(ids.y));
  corner_2 = Corner(ids.z, 2u, BODY.vertices.at[ids.z], l.z, payload(ids.z));
  corner_3 = Corner(ids.w, 3u, BODY.vertices.at[ids.w], l.w, payload(ids.w));
  face_towards(direction);
}

#ifdef QG_PROCESSOR
// Asks memory for the tets across the faces of one, before the ray leaves it for one of them.
void fetch_around(uint tet) {
  for (uint k = 0u; k < 4u; ++k) {
    int across = int(BODY.crossings.at[4u * tet + k] >> CROSSING_BITS);
    fetch_ahead(BODY.tets, across);
    fetch_ahead(BODY.crossings, 4 * across);
    fetch_ahead(BODY.optical, across);
  }
}
#endif

// Enters the tet across, whose new corner replaces that in slot 3.
void enter(uvec2 crossing) {
#ifdef QG_PROCESSOR
  fetch_around(crossing.x);
#endif
  if ((BODY.flags & BODY_EVEN) == 0u) optical = BODY.optical.at[crossing.x];
  corner_0.place = crossing.y >> 2u * corner_0.place & 3u;
  corner_1.place = crossing.y >> 2u * corner_1.place & 3u;
  corner_2.place = crossing.y >> 2u * corner_2.place & 3u;
  uint place = crossing.y >> 2u * corner_3.place & 3u;
  uint id = BODY.tets.at[crossing.x][place];
  corner_3 = Corner(id, place, BODY.vertices.at[id], 0.0, payload(id));
}

#endif
