#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "material/fresnel.glsl"
#include "source/face_azimuth.glsl"
#include "source/lambertian.glsl"
#include "source/leaning.glsl"
#include "source/beam_light.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Entry and depth of the points.
struct UncollidedPush {
  BodyRefs body;      // one
  Uints start;        // a tet at each vertex
  Uints nearest;      // surface vertex
  Uints face_offset;  // faces around each surface vertex
  Uints face_incidence;
  Beams beams;
  Floats beam_q;
  GatherPoints points;
  uint beam_count;
  uint vertex_count;
  uint surface_vertex_count;
};
layout(push_constant, scalar) uniform Block { UncollidedPush push; };

BodyRef body;
#define BODY body

#include "source/tet_ray.glsl"

// Light that has not scattered: what it would be without loss, and the optical depth of its way.
struct Light {
  vec3 entry, depth;
};

const Light NO_LIGHT = Light(vec3(0), vec3(UNCOLLIDED_DEPTH));
const uint FACE_CENTRE = 3u;  // the quarter in the middle

// Where a ray back to the light meets the surface.
struct Met {
  bool found;
  uint face, quarter;
  vec3 tau;
};

// The quarter of a face that a point of the face is in.
uint quarter_here(uint face, TetPoint at) {
  uvec4 all = BODY.tets.at[at.tet];
  for (uint k = 0u; k < 3u; ++k) {
    if (at.l[place_of(BODY.faces.at[face][k], all)] > 0.5) return k;
  }
  return FACE_CENTRE;
}

Met back_to_surface(uint v, vec3 direction) {
  uint tet = push.start.at[v];
  uvec4 ids = BODY.tets.at[tet];
  TetPoint at = TetPoint(tet, vec4(ids.x == v, ids.y == v, ids.z == v, ids.w == v), vec4(0));
  vec3 tau = vec3(0);
  for (uint step = 0u; step < UNCOLLIDED_STEPS; ++step) {
    Exit exit = find_exit(at, direction);
    if (!exit.found) break;
    tau += extinction(optical_in(at.tet)) * exit.path;
    if (all(greaterThan(tau, vec3(UNCOLLIDED_DEPTH)))) break;
    at.l = exit_point(at, exit);
    uint crossing = crossing_at(at.tet, exit.place), across = crossing >> CROSSING_BITS;
    if (across < BODY.tet_count) {
      enter(at, exit.place, crossing);
      continue;
    }
    uint face = across - BODY.tet_count;
    if (is_open(BODY.face_kinds, face)) return Met(true, face, quarter_here(face, at), tau);
    bar(at, exit.place);
    vec3 n = outward_normal(face);
    direction = normalize(direction - 2.0 * dot(direction, n) * n);
  }
  return Met(false, 0u, 0u, vec3(0));
}

vec3 doubled_normal(uint face) {
  uvec3 ids = BODY.faces.at[face];
  vec3 p = BODY.vertices.at[ids.x];
  return cross(BODY.vertices.at[ids.y] - p, BODY.vertices.at[ids.z] - p);
}

vec3 q_at(uint beam, uint face, uint quarter) {
  return beam_light(push.beams.at[beam], push.beam_q, BODY.face_count, face, quarter);
}

// Unit, but 0 of a face without area.
vec3 normal_of(uint face) {
  vec3 doubled = doubled_normal(face);
  return doubled / max(length(doubled), 1e-30);
}

// The quarter of face `face` at its corner v.
uint quarter_at(uint face, uint v) {
  uvec3 ids = BODY.faces.at[face];
  return v == ids.x ? 0u : v == ids.y ? 1u : 2u;
}

// Unit, of the facets of a face; its own where none lean.
vec3 facet_of(uint face, vec3 normal) {
  uvec3 ids = BODY.faces.at[face];
  vec3 p = BODY.vertices.at[ids.x];
  return facet_normal(
      leaning_of(BODY.face_kinds, face, normal, BODY.vertices.at[ids.y] - p, BODY.vertices.at[ids.z] - p));
}

// Fluence behind a face that `q` enters by, of light that travels along `incoming` outside.
vec3 entry_fluence(uint face, vec3 q, vec3 incoming, vec3 normal, OpticalSurface surface) {
  vec3 inside = goes_in(incoming, normal, facet_of(face, normal), surface);
  return q / max(-dot(inside, normal), LEAST_COSINE);
}

// Light at a surface vertex from the open faces around it that it enters by. Returns whether there are any.
bool lit_at_surface(uint beam, uint v, vec3 incoming, bool directed, out vec3 entry) {
  float area = 0.0;
  entry = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    vec3 normal = doubled_normal(face);
    float size = length(normal);
    if (directed && dot(incoming, normal) >= 0.0) continue;
    vec3 q = q_at(beam, face, quarter_at(face, v));
    OpticalSurface surface = surface_of(BODY.face_kinds, face);
    entry += size * (directed ? entry_fluence(face, q, incoming, normal / size, surface) : q);
    area += size;
  }
  entry = area > 0.0 ? entry / area : vec3(0);
  return area > 0.0;
}

vec3 surface_normal(uint v) {
  vec3 sum = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    sum += doubled_normal(push.face_incidence.at[k]);
  }
  return sum / max(length(sum), 1e-30);
}

// Fluence over q at a depth of tau below the surface.
vec3 fluence_below(Lambertian light, vec3 tau) {
  vec3 sum = vec3(0);
  for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) sum += light.share[k] / light.cosine[k] * exp(-tau / light.cosine[k]);
  return sum;
}

Lambertian bundle(uint kind, uint face) {
  Lambertian light = lambertian(surface_of(BODY.face_kinds, face));
  return kind == BEAM_MEAN ? Lambertian(vec4(0.25), vec4(dot(light.share, light.cosine))) : light;
}

bool has_direction(BeamRecord way) {
  return way.kind == BEAM_DIRECTIONAL || way.kind == BEAM_POINT || way.kind == BEAM_RECTANGLE;
}

// Where the light of a beam entered that reaches a vertex; `incoming`: the way it travels outside, if it has a direction;
// surface: the one that the straight way ends at.
Met way_in(uint v, bool directed, vec3 incoming, out OpticalSurface surface) {
  Met met = back_to_surface(v, directed ? -incoming : surface_normal(push.nearest.at[v]));
  if (met.found) surface = surface_of(BODY.face_kinds, met.face);
  if (!directed || !met.found || surface.eta == 1.0) return met;
  // By the normal where the straight way ends one knows how the light was bent.
  vec3 normal = normal_of(met.face);
  return back_to_surface(v, -goes_in(incoming, normal, facet_of(met.face, normal), surface));
}

Light light_of(uint beam, uint v) {
  BeamRecord way = push.beams.at[beam].way;
  bool directed = has_direction(way);
  vec3 incoming = way.kind == BEAM_DIRECTIONAL ? way.travel_or_from
                                               : normalize(BODY.vertices.at[v] - way.travel_or_from);
  vec3 entry;
  bool at_surface = v < push.surface_vertex_count && lit_at_surface(beam, v, incoming, directed, entry);
  if (at_surface && directed) return Light(entry, vec3(0));
  OpticalSurface surface;
  Met met = Met(true, 0u, 0u, vec3(0));
  if (at_surface) {
    met.face = push.face_incidence.at[push.face_offset.at[v]];
  } else {
    met = way_in(v, directed, incoming, surface);
    if (!met.found) return NO_LIGHT;
    entry = q_at(beam, met.face, met.quarter);
  }
  if (directed) return Light(entry_fluence(met.face, entry, incoming, normal_of(met.face), surface), met.tau);
  Lambertian light = bundle(way.kind, met.face);
  vec3 whole = fluence_below(light, vec3(0));
  return Light(whole * entry, at_surface ? vec3(0) : -log(fluence_below(light, met.tau) / whole));
}

// How much a beam counts in the entry of all.
vec3 counts_at(vec3 depth) {
  return max(exp(-depth / SHARED_DEPTH) - exp(-UNCOLLIDED_DEPTH / SHARED_DEPTH), vec3(0));
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.vertex_count) return;
  body = push.body.at[0];
  vec3 entry = vec3(0), left = vec3(0), least = vec3(UNCOLLIDED_DEPTH), counted = vec3(0), most = vec3(0);
  for (uint beam = 0u; beam < push.beam_count; ++beam) {
    Light light = light_of(beam, v);
    vec3 counts = mix(vec3(0), counts_at(light.depth), greaterThan(light.entry, vec3(0)));
    entry += light.entry;
    counted += counts * light.entry;
    most = max(most, counts);
    left += light.entry * exp(-light.depth);
    least = min(least, light.depth);
  }
  entry = mix(entry, counted / max(most, vec3(1e-37)), greaterThan(most, vec3(0)));
  vec3 depth = mix(least, -log(max(left, vec3(1e-37)) / entry), greaterThan(left, vec3(0)));
  push.points.at[v].entry = vec4(entry, 0.0);
  push.points.at[v].depth = vec4(depth, 0.0);
  push.points.at[v].uncollided = vec4(entry * exp(-depth), 0.0);
}
