// Light that leaves a body along a view ray, and what is seen through it. The shader that
// includes it defines first POINTS (gather_fields.glsl), NORMALS and FORWARD_LIGHT (gather.glsl) and BODY, TREE and TREE_BODY
// (face_tree.glsl), which belong together.
#ifndef QUADGRAPH_LEAVING_GLSL
#define QUADGRAPH_LEAVING_GLSL

#include "exchange/face_tree.glsl"
#include "gather/gather.glsl"
#include "material/fresnel.glsl"

// The direction inside of light that leaves along `outward` at a surface of normal `n`, turned around; into the face of
// normal `face_normal` in any case.
vec3 view_ray(vec3 outward, vec3 n, vec3 face_normal, OpticalSurface surface, inout Facets facets) {
  vec3 ray = -outward;
  bool found = false;
  if (is_rough(facets)) {
    surface.roughness = facets.alpha;
    uint state = random_state(facets);
    found = way_by_facets(false, true, n, surface, spread_facet(facets), ray, state);
  }
  if (!found) {
    float cos_o = clamp(dot(outward, n), 0.0, 1.0);
    float cos_i = sqrt(max(1.0 - (1.0 - cos_o * cos_o) / (surface.eta * surface.eta), 0.0));
    ray = normalize((cos_o / surface.eta - cos_i) * n - outward / surface.eta);
  }
  return -outward_of(face_normal, -ray);
}

// Share of the light inside that a surface of normal `n` lets out along `outward`. starts: whether the view ray starts
// there.
float let_out(Facets facets, vec3 outward, vec3 n, Refraction body, bool starts) {
  float cosine = clamp(dot(outward, n), 0.0, 1.0);
  if (!is_rough(facets)) return surface_transmittance(cosine, body.surface);
  if (starts && facets.lets_out >= 0.0) return facets.lets_out;
  return 1.0 - rough_reflectance(body, cosine, facets.alpha);
}

struct Leaving {
  vec3 radiance;  // W/(mm^2 sr)
  vec3 seen;      // share of the light behind all parts of the body that comes through
  float through;  // share that its surface lets through of what is inside
};

// What of a share of at most `most` is followed through further parts of the body: all but little of what is much,
// nothing of what is not, so that nothing changes at once from one view ray to the next.
float followed(float most) {
  return smoothstep(GATHER_END, FOLLOWED_WHOLE, most);
}

// Radiance that was gathered at a point of a face, by the scale of its corners.
vec3 scaled(vec3 radiance, uvec3 ids, vec3 l, GatherScales scale, float radiance_norm) {
  GatherScale a = scale.at[ids.x], b = scale.at[ids.y], c = scale.at[ids.z];
  vec3 factor = l.x * a.factor + l.y * b.factor + l.z * c.factor;
  vec3 rest = l.x * a.rest + l.y * b.rest + l.z * c.rest;
  vec3 least = l.x * a.least + l.y * b.least + l.z * c.least;
  return max(factor * radiance + rest / radiance_norm, least / radiance_norm);
}

// Light that leaves face `face` at barycentric coordinates `l` along `outward`, at a surface of normal `n`. Fresnel and
// refraction included: radiance over eta^2 is kept. Where enough of a ray comes out behind, it goes on to the next
// part of the body, the brightest branch first, up to so many `parts`. scale: null: what is gathered counts as it is.
Leaving leaving(uint face, vec3 l, vec3 outward, vec3 n, GatherScales scale, Facets facets, uint parts) {
  Leaving sum = Leaving(vec3(0), vec3(0), 0.0);
  vec3 share = vec3(1);  // of the light at `face`
  Escape most = NO_ESCAPE, second = NO_ESCAPE;  // that wait to be followed
  for (uint part = 0u; part < parts; ++part) {
    uvec3 ids = BODY.faces.at[face];
    mat3 corners = corners_of(ids);
    vec3 doubled = cross(corners[1] - corners[0], corners[2] - corners[0]);
    vec3 face_normal = doubled / max(length(doubled), 1e-30);
    if (part > 0u) n = smooth_normal(face, l);
    Refraction body = refraction_behind(BODY.face_kinds, face);
    float through = let_out(facets, outward, n, body, part == 0u);
    if (part == 0u) sum.through = through;
    share *= through;
    TetPoint at = start_on_face(BODY.face_tets.at[face], ids, l);
    bool last = part + 1u == parts;
    vec3 inward = view_ray(outward, n, face_normal, body.surface, facets);
    Gathered inside = gather(at, inward, !last, facets);
    vec3 radiance = inside.radiance / (body.surface.eta * body.surface.eta);
    sum.radiance += share * (uvec2(scale) == uvec2(0) ? radiance : scaled(radiance, ids, l, scale, body.radiance_norm));
    sum.seen += share * (inside.seen - inside.most.share - inside.second.share);
    inside.most.share *= share;
    inside.second.share *= share;
    sum.seen += keep(most, second, inside.most) + keep(most, second, inside.second);
    share = vec3(0);
    if (last) break;
    while (share == vec3(0) && largest(most.share) > GATHER_END) {
      Escape way = most;
      most = second;
      second = NO_ESCAPE;
      Hit hit = first_met(line_along(way.point, way.direction), way.face, FAR);
      share = hit.outside ? followed(largest(way.share)) * way.share : vec3(0);
      sum.seen += way.share - share;
      face = hit.face;
      l = max(vec3(1.0 - hit.place.x - hit.place.y, hit.place), vec3(0));
      l /= l.x + l.y + l.z;
      outward = -way.direction;
    }
    if (share == vec3(0)) break;
  }
  sum.seen += share + most.share + second.share;
  return sum;
}

#endif
