// Radiance gathered along a view ray, and its scale. Include after fresnel.glsl and a definition of BODY and POINTS.
#include "gather_fields.glsl"

struct Gathered {
  vec3 radiance;  // W/(mm^2 sr)
  vec3 seen;      // share of the light behind the body that comes through, both surfaces but the first included
};

// One step of transport: collided and uncollided fluence scattered into a ray that goes from its point into the body.
Gathered gather(uint tet, vec3 direction) {
  Gathered sum = Gathered(vec3(0), vec3(0));
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
    if (load_uint(BODY.face_kinds, crossing.x - BODY.tet_count) == FACE_OPEN) {
      float reflected = internal_reflectance(cosine, BODY.eta);
      sum.seen += left * (1.0 - reflected);
      left *= reflected;
      if (reflected == 0.0) break;
    }
    direction = normalize(direction - 2.0 * cosine * n);
  }
  sum.radiance += left * even_radiance(here);
  return sum;
}

// The direction inside of light that leaves along `outward` at a surface of normal `n`, turned around; into the face of
// normal `face_normal` in any case.
vec3 view_ray(vec3 outward, vec3 n, vec3 face_normal) {
  float cos_o = clamp(dot(outward, n), 0.0, 1.0);
  float cos_i = sqrt(max(1.0 - (1.0 - cos_o * cos_o) / (BODY.eta * BODY.eta), 0.0));
  vec3 ray = normalize((cos_o / BODY.eta - cos_i) * n - outward / BODY.eta);
  return normalize(ray - max(dot(ray, face_normal) + LEAST_VIEW_COSINE, 0.0) * face_normal);
}

// Light that leaves face `face` at barycentric coordinates `l` along `outward`, at a surface of normal `n`: radiance of
// scattered light, and the share that is seen of what is behind. Fresnel and refraction included: radiance over eta^2
// is kept.
Gathered leaving(uint face, vec3 l, vec3 outward, vec3 n, GatherScales scale, float radiance_norm) {
  uvec3 ids = load_uvec3(BODY.faces, face);
  mat3 corners = corners_of(ids);
  vec3 face_normal = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
  uint tet = load_uint(BODY.face_tets, face);
  start_on_face(tet, ids, corners, l);
  Gathered inside = gather(tet, view_ray(outward, n, face_normal));
  GatherScale a = load_gather_scale(scale, ids.x), b = load_gather_scale(scale, ids.y),
              c = load_gather_scale(scale, ids.z);
  vec3 factor = l.x * a.factor + l.y * b.factor + l.z * c.factor;
  vec3 rest = l.x * a.rest + l.y * b.rest + l.z * c.rest;
  float transmittance = fresnel_transmittance(clamp(dot(outward, n), 0.0, 1.0), BODY.eta);
  return Gathered(transmittance * (factor * inside.radiance / (BODY.eta * BODY.eta) + rest / radiance_norm),
                  transmittance * inside.seen);
}
