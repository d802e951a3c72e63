// A ray through the tets of a level. The shader that includes it defines first
//   BODY  where the BodyRef is, e.g. push.body
// and, where several rays are followed side by side, so that none need ask memory ahead for what comes,
//   RAYS_ABREAST
//
// The ray's point is carried in barycentric coordinates, which pass from tet to tet with the shared corners: it then
// never leaves the mesh by rounding. What belongs to corners stands in the order of the tet's, and is put into that of
// the next where the ray enters it. A step reads one line of a cache (TetCell) and, in a varied material, the
// coefficients; it has no branch but its end, as none could be foretold.
#ifndef QUADGRAPH_TET_RAY_GLSL
#define QUADGRAPH_TET_RAY_GLSL

#include "shared/body_shared.h"

#ifndef BODY
#error "tet_ray.glsl: BODY is not defined"
#endif

const float NEVER = 1e37;
const vec4 PLACES = vec4(0.0, 1.0, 2.0, 3.0);  // of corners in a tet

// Where a ray is.
struct TetPoint {
  uint tet;
  vec4 l;       // barycentric coordinates
  vec4 barred;  // NEVER for the corner opposite the face that the ray came in through, else 0
};

// Where a ray leaves a tet.
struct Exit {
  uint place;  // of the corner opposite
  bool found;  // false in a tet so flat that its faces have no side, and in one that is turned inside out
  float path;  // mm
  vec4 rate;   // of the barycentric coordinates, 1/mm
};

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

Optical optical_in(uint tet) {
  return BODY.optical.at[(BODY.flags & BODY_EVEN) != 0u ? 0u : tet];
}

vec3 extinction(Optical optical) {
  return optical.sigma_s_prime + optical.sigma_a;
}

#ifndef QG_PROCESSOR
// The least component, and its place: the first that is. Processor: engine/cpu/lane_order.h.
float least_of(vec4 v, out uint place) {
  float least = min(min(v.x, v.y), min(v.z, v.w));
  place = v.x == least ? 0u : v.y == least ? 1u : v.z == least ? 2u : 3u;
  return least;
}

// What belongs to the corners of a tet, as they stand in the tet across. Processor: engine/cpu/lane_order.h.
vec4 onward(vec4 v, uint crossing) {
  vec4 across;
  across[crossing & 3u] = v.x;
  across[crossing >> 2u & 3u] = v.y;
  across[crossing >> 4u & 3u] = v.z;
  across[(crossing ^ crossing >> 2u ^ crossing >> 4u) & 3u] = v.w;
  return across;
}
#endif

bvec4 corner_at(uint place) {
  return equal(PLACES, vec4(float(place)));
}

vec4 without(vec4 v, uint place) {
  return mix(v, vec4(0), corner_at(place));
}

// The place of vertex `id` among those of a tet, one of which it is.
uint place_of(uint id, uvec4 tet) {
  return id == tet.x ? 0u : id == tet.y ? 1u : id == tet.z ? 2u : 3u;
}

// Corners of an outside face, as columns.
mat3 corners_of(uvec3 ids) {
  return mat3(BODY.vertices.at[ids.x], BODY.vertices.at[ids.y], BODY.vertices.at[ids.z]);
}

// Of an outside face, unit.
vec3 outward_normal(uint face) {
  mat3 corners = corners_of(BODY.faces.at[face]);
  return normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
}

// Bars the way back through the face opposite a corner, where the ray is.
void bar(inout TetPoint at, uint place) {
  at.barred = mix(vec4(0), vec4(NEVER), corner_at(place));
}

// On an outside face of `tet`, at the barycentric coordinates `l` of the face.
TetPoint start_on_face(uint tet, uvec3 ids, vec3 l) {
  uvec4 all = BODY.tets.at[tet];
  uint apex = all.x + all.y + all.z + all.w - ids.x - ids.y - ids.z;
  TetPoint at;
  at.tet = tet;
  at.l = vec4(0);
  at.l[place_of(ids.x, all)] = l.x;
  at.l[place_of(ids.y, all)] = l.y;
  at.l[place_of(ids.z, all)] = l.z;
  bar(at, place_of(apex, all));
  return at;
}

// Rounded alike on all devices: a ray along a common face of tets is then in the same one.
Exit find_exit(TetPoint at, vec3 direction) {
  precise vec4 rate = direction.x * BODY.cells.at[at.tet].along_x + direction.y * BODY.cells.at[at.tet].along_y +
                      direction.z * BODY.cells.at[at.tet].along_z;
  vec4 path = mix(vec4(NEVER), at.l / -rate, lessThan(rate, vec4(0)));
  Exit exit;
  exit.rate = rate;
  exit.path = least_of(max(path, at.barred), exit.place);
  exit.found = exit.path < NEVER;
  return exit;
}

// Barycentric coordinates at the exit.
vec4 exit_point(TetPoint at, Exit exit) {
  precise vec4 there = at.l + exit.path * exit.rate;
  vec4 l = without(max(there, vec4(0)), exit.place);
  return l / (l.x + l.y + l.z + l.w);
}

// What lies across the face opposite a corner, as a crossing.
uint crossing_at(uint tet, uint place) {
  return BODY.cells.at[tet].crossings[place];
}

#if defined(QG_PROCESSOR) && !defined(RAYS_ABREAST)
#define FETCHES_AROUND
// Asks memory for the tets across the faces of one, before the ray leaves it for one of them.
void fetch_around(uint tet) {
  bool varied = (BODY.flags & BODY_EVEN) == 0u;
  for (uint k = 0u; k < 4u; ++k) {
    int across = int(BODY.cells.at[tet].crossings[k] >> CROSSING_BITS);
    fetch_ahead(BODY.cells, across);
    fetch_ahead(BODY.tets, across);
    if (varied) fetch_ahead(BODY.optical, across);
  }
}
#endif

// Enters the tet across the face opposite the corner at `place`.
void enter(inout TetPoint at, uint place, uint crossing) {
  at.tet = crossing >> CROSSING_BITS;
#ifdef FETCHES_AROUND
  fetch_around(at.tet);
#endif
  bar(at, place);
  at.barred = onward(at.barred, crossing);
  at.l = onward(at.l, crossing);
}

#endif
