// Radiance gathered along a view ray, and its scale. The shader that includes it defines
// first BODY and POINTS (gather_fields.glsl) and
//   NORMALS        where those of the smooth surface are, e.g. those of a SolidRef
//   FORWARD_LIGHT  where the ForwardLight is, the same
#ifndef QUADGRAPH_GATHER_GLSL
#define QUADGRAPH_GATHER_GLSL

#ifndef NORMALS
#error "gather.glsl: NORMALS is not defined"
#endif
#ifndef FORWARD_LIGHT
#error "gather.glsl: FORWARD_LIGHT is not defined"
#endif

#include "gather/gather_fields.glsl"
#include "gather/facets.glsl"
#include "material/rough_surface.glsl"
#include "gather/gather_shared.h"
#include "shared/creases.h"
#include "source/inner_surface.glsl"

// Where a ray leaves the body, to go on outside.
struct Escape {
  vec3 share;      // of the light there that comes through, this surface included
  uint face;       // that it leaves by
  vec3 point;      // mm
  vec3 direction;  // unit, outside
};

const Escape NO_ESCAPE = Escape(vec3(0), 0u, vec3(0), vec3(0));

struct Gathered {
  vec3 radiance;  // W/(mm^2 sr)
  vec3 seen;      // share of the light behind the body that comes through, both surfaces but the first included
  Escape most, second;  // by which most of it does
};

float largest(vec3 v) {
  return max(v.x, max(v.y, v.z));
}

// `way`, unit, turned out of the face of unit normal `n` if it is not.
vec3 outward_of(vec3 n, vec3 way) {
  return normalize(way + max(LEAST_VIEW_COSINE - dot(way, n), 0.0) * n);
}

// Unit normal of the smooth surface at barycentric coordinates `l` of a face.
vec3 smooth_normal(uint face, vec3 l) {
  return normalize(l.x * NORMALS.at[3u * face] + l.y * NORMALS.at[3u * face + 1u] +
                   l.z * NORMALS.at[3u * face + 2u]);
}

// Barycentric coordinates of a face's corners at a point of the face.
vec3 coordinates_on(uvec3 ids, TetPoint at) {
  uvec4 all = BODY.tets.at[at.tet];
  return vec3(at.l[place_of(ids.x, all)], at.l[place_of(ids.y, all)], at.l[place_of(ids.z, all)]);
}

// A surface that a ray meets from inside.
struct Met {
  OpticalSurface surface;  // as rough as it is for the ray
  vec3 normal;             // unit, of the smooth surface
  float reflected;         // share
  uint state;              // of random numbers, where it is rough
};

// Share of a ray at that cosine with the normal that stays inside: of a rough surface that solves know of as they have
// it, else by a facet that is drawn.
float reflected_inside(vec3 direction, vec3 n, OpticalSurface surface, inout Facets facets) {
  float cosine = max(dot(direction, n), 0.0);
  if (is_rough(facets) && surface.roughness > 0.0) return surface_reflectance_inside(cosine, surface);
  if (is_rough(facets)) {
    FacetFrame frame = facet_frame(n);
    vec3 way = into_frame(frame, direction);
    cosine = max(dot(way, visible_facet(way, facets.alpha, spread_facet(facets))), 0.0);
  }
  return internal_reflectance(cosine, surface);
}

// At a point of outside face `face`.
Met met_from_inside(uint face, TetPoint at, vec3 direction, inout Facets facets) {
  vec3 n = smooth_normal(face, coordinates_on(BODY.faces.at[face], at));
  OpticalSurface surface = surface_of(BODY.face_kinds, face);
  float reflected = reflected_inside(direction, n, surface, facets);
  surface.roughness = facets.alpha;
  ++facets.drawn;
  return Met(surface, n, reflected, is_rough(facets) ? random_state(facets) : 0u);
}

// At a point of a face of unit normal `flat_normal`.
Escape escape_here(vec3 share, uint face, TetPoint at, vec3 direction, inout Met met, vec3 flat_normal) {
  vec3 point = corners_of(BODY.faces.at[face]) * coordinates_on(BODY.faces.at[face], at);
  vec3 outside = way_on(direction, met.normal, met.surface, true, met.state);
  return Escape(share, face, point, outward_of(flat_normal, outside));
}

// Keeps the two of three by which most comes through; returns the share of the third.
vec3 keep(inout Escape most, inout Escape second, Escape other) {
  vec3 least = other.share;
  if (largest(other.share) > largest(second.share)) {
    least = second.share;
    second = other;
  }
  if (largest(second.share) > largest(most.share)) {
    Escape swapped = most;
    most = second;
    second = swapped;
  }
  return least;
}

bool scatters_forwards() {
  return uvec2(FORWARD_LIGHT.flows) != uvec2(0);
}

// Light of which a point of a tet scatters as much against a ray of that direction as it would evenly.
LocalLight light_against(TetPoint at, vec3 direction) {
  LocalLight light = fields_at(at.tet, at.l);
  if (!scatters_forwards()) return light;
  uvec4 ids = BODY.tets.at[at.tet];
  mat3 flow = mat3(0.0), ways = mat3(0.0);
  for (uint k = 0u; k < 4u; ++k) {
    uint first = GATHER_FLOWS * ids[k];
    for (uint axis = 0u; axis < 3u; ++axis) {
      flow[axis] += at.l[k] * FORWARD_LIGHT.flows.at[first + axis];
      ways[axis] += at.l[k] * FORWARD_LIGHT.flows.at[first + 3u + axis];
    }
  }
  vec3 straight = sqrt(ways[0] * ways[0] + ways[1] * ways[1] + ways[2] * ways[2]), along = -(ways * direction);
  // What is gathered is scaled to the exitance, so that its moments need not be those of the sweeps.
  vec3 factor = mix(vec3(1), cut_off_phase(FORWARD_LIGHT.beside, along / max(straight, vec3(1e-6))), straight);
  light.phi -= flow * direction;
  light.entry *= factor;
  light.uncollided *= factor;
  return light;
}

// Unit normal, onward, where a ray leaves a tet for another body by the face opposite a corner, of that unit normal: of
// the smooth surface that these share, as far as no crease parts it from the face.
vec3 shared_normal(TetPoint at, uint place, vec3 flat_normal) {
  vec3 sum = vec3(0);
  uvec4 ids = BODY.tets.at[at.tet];
  for (uint k = 0u; k < 4u; ++k) {
    if (k == place) continue;
    vec3 normal = BODY.shared_normals.at[ids[k]];
    if (dot(normal, flat_normal) < 0.0) normal = -normal;
    sum += at.l[k] * mix(flat_normal, normal, smooth_share(dot(normal, flat_normal)));
  }
  return normalize(sum);
}

// What a view ray does where it leaves a tet for a body of another index: it goes on through unless all is mirrored.
// Light mirrored beside that counts as even. Returns whether it goes through; bars its way where not.
bool passes(inout TetPoint at, uint place, uint across, LocalLight here, inout vec3 direction, inout vec3 left,
            inout vec3 radiance) {
  vec3 flat_normal = normal_across(at.tet, place);
  InnerSurface met = inner_surface(at.tet, across, direction, shared_normal(at, place, flat_normal));
  if (met.reflected == 1.0) {
    direction = -outward_of(flat_normal, -mirrored(met, direction));
    bar(at, place);
    return false;
  }
  radiance += met.reflected * left * even_radiance(at.tet, here);
  left *= 1.0 - met.reflected;
  direction = outward_of(flat_normal, bent(met, direction));
  return true;
}

// One step of transport: collided and uncollided fluence scattered into a ray that goes from its point into the body.
// leaves: whether it is to be known where it leaves.
Gathered gather(TetPoint at, vec3 direction, bool leaves, inout Facets facets) {
  Gathered sum = Gathered(vec3(0), vec3(0), NO_ESCAPE, NO_ESCAPE);
  vec3 left = vec3(1);
  LocalLight here;
  bool turned = true;  // since `here` was found
  for (uint step = 0u;; ++step) {
    if (turned) here = light_against(at, direction);
    Exit exit = find_exit(at, direction);
    if (!exit.found || step == GATHER_STEPS) break;
    Optical optical = optical_in(at.tet);
    at.l = exit_point(at, exit);
    LocalLight there = light_against(at, direction);
    vec3 lost, fluence = fluence_along(here, there, extinction(optical) * exit.path, lost);
    vec3 last = left * optical.sigma_s_prime * (exit.path / FOUR_PI) * fluence;
    sum.radiance += last;
    left -= left * lost;
    here = there;
    if (ends(left, sum.radiance, last, lost)) break;
    uint crossing = crossing_at(at.tet, exit.place), across = crossing >> CROSSING_BITS;
    if (across < BODY.tet_count) {
      turned = bends(at.tet, across);
      if (!turned || passes(at, exit.place, across, here, direction, left, sum.radiance)) {
        enter(at, exit.place, crossing);
      }
      continue;
    }
    bar(at, exit.place);
    uint face = across - BODY.tet_count;
    vec3 n = outward_normal(face);
    if (is_open(BODY.face_kinds, face)) {
      Met met = met_from_inside(face, at, direction, facets);
      vec3 through = left * (1.0 - met.reflected);
      sum.seen += through;
      if (leaves && largest(through) > largest(sum.second.share)) {
        keep(sum.most, sum.second, escape_here(through, face, at, direction, met, n));
      }
      left *= met.reflected;
      if (met.reflected == 0.0) break;
      direction = -outward_of(n, -way_on(direction, met.normal, met.surface, false, met.state));
    } else {
      direction = normalize(direction - 2.0 * dot(direction, n) * n);
    }
    turned = scatters_forwards();
  }
  sum.radiance += left * even_radiance(at.tet, here);
  return sum;
}

#endif
