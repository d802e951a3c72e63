// Light that the surface reflects. The shader that includes it defines first
//   SCENE  the SurfaceScene, e.g. push.scene.at[0]
// and sets `roughness`, `surface`, `evenly` and `coat_evenly`.
#ifndef QUADGRAPH_SPECULAR_GLSL
#define QUADGRAPH_SPECULAR_GLSL

#include "light/environment.glsl"
#include "light/lights.glsl"
#include "material/fresnel.glsl"

#ifndef SCENE
#error "specular.glsl: SCENE is not defined"
#endif

const float PI = 3.14159265;

float roughness;     // GGX alpha here
OpticalSurface surface;   // here
float evenly;        // share of even light that the surface here reflects towards the view
float coat_evenly;   // of that by the upper side of its coat
vec3 mesh_normal;  // with a map of normals: unit, before the map made it lean

// Length of a way that is seen along the box's third axis, mm.
float across_box(ImageBox box, vec3 way) {
  return length(vec2(dot(box.right, way), dot(box.up, way)));
}

// Whether an image says how rough the surface is, and how it leans.
bool has_roughness_map() {
  return uvec2(SCENE.roughness_map.texels) != uvec2(0);
}
bool has_normal_map() {
  return uvec2(SCENE.normal_map.texels) != uvec2(0);
}

// Makes `roughness` that of a point of the surface, `rest` at rest, mm; `to_right` and `to_below`: how it differs
// from pixel to pixel.
void place_roughness(vec3 rest, vec3 to_right, vec3 to_below) {
  RoughnessMapRef map = SCENE.roughness_map;
  vec3 place = in_box(map.box, rest);
  float width = max(across_box(map.box, to_right), across_box(map.box, to_below));
  if (any(greaterThan(abs(place), map.box.half_size))) return;
  ImageTap tap = image_tap(map.image, in_picture(map.box, place), texels_across(map.box, map.image, width));
  float share = clamp(luminance(load_image(map.texels, tap)), 0.0, 1.0);
  roughness = mix(SCENE.roughness, map.roughness, share);
}

// Cook and Torrance 1982 with the GGX distribution and height-correlated Smith masking (Walter et al. 2007, Heitz 2014)
// but for the reflectance of facets: BRDF times the cosine of incidence, 1/sr. n_l, n_v: cosines of both ways with the
// normal; n_h2: squared, of the half vector.
float cook_torrance(float n_l, float n_v, float n_h2, float alpha2) {
  float base = n_h2 * (alpha2 - 1.0) + 1.0;
  float mask = n_v * sqrt(alpha2 + (1.0 - alpha2) * n_l * n_l) + n_l * sqrt(alpha2 + (1.0 - alpha2) * n_v * n_v);
  return 0.5 * alpha2 * n_l / (PI * base * base * mask);
}

// What the surface reflects of light from l towards v: BRDF times the cosine of incidence, 1/sr. wider: what is added to
// the square of its roughness. What comes back from below a coat is as rough as the body looks through it.
float highlight(vec3 n, vec3 v, vec3 l, float wider) {
  float n_l = dot(n, l), n_v = dot(n, v);
  if (n_l <= 0.0 || n_v <= 0.0) return 0.0;
  // Squared cosines of the half vector (v + l) / |v + l| with v and n; |v + l|^2 = 2 (1 + v.l).
  float v_h2 = max(0.5 + 0.5 * dot(v, l), 1e-7);
  float n_h2 = min(0.25 * (n_v + n_l) * (n_v + n_l) / v_h2, 1.0), v_h = min(sqrt(v_h2), 1.0);
  float alpha2 = roughness * roughness + wider, bare = fresnel_reflectance(v_h, surface.eta);
  float brdf = bare * cook_torrance(n_l, n_v, n_h2, alpha2);
  if (surface.coat == 0.0) return brdf;
  float whole = coated_reflectance(v_h, surface), above = fresnel_reflectance(v_h, surface.coat_eta);
  float seen = min(roughness * surface.coat_eta, 1.0);
  float coat2 = surface.coat_roughness * surface.coat_roughness + wider, below2 = seen * seen + wider;
  float coated = above * cook_torrance(n_l, n_v, n_h2, coat2);
  coated += max(whole - above, 0.0) * cook_torrance(n_l, n_v, n_h2, below2);
  return mix(brdf, coated, surface.coat);
}

// What a slope of normal n that a map makes gets of light from l: none where the mesh is turned away from it, as what
// hides the body from itself cannot tell there, and nearly all elsewhere (Chiang et al. 2019).
float share_of_slope(vec3 n, vec3 l) {
  float facing = dot(mesh_normal, l);
  float g = clamp(facing / max(dot(n, l) * dot(n, mesh_normal), 1e-6), 0.0, 1.0);
  return g * (1.0 + g - g * g);
}

// What blurs the highlight of a patch over its width, to be added to the square of the roughness: as much as makes the
// highlights of neighbours run into one.
float blurred(LightRecord light, LightShape shape, vec3 position) {
  vec3 away = position - light.towards_or_at;
  return shape.width * shape.width / (8.0 * dot(away, away));
}

// What an environment is in the mirrored view `way`, as rough as the surface is below a coat.
vec3 environment_below(LightShape shape, vec3 way) {
  vec3 seen = environment_at(shape, ENVIRONMENT_REFLECTED, way);
  float range = SCENE.mirrored.y - SCENE.mirrored.x;
  if (range == 0.0 || !(has_roughness_map() || has_normal_map())) return seen;
  float share = clamp((roughness - SCENE.mirrored.x) / range, 0.0, 1.0);
  return mix(seen, environment_at(shape, ENVIRONMENT_REFLECTED_PLACED, way), share);
}

// What a surface reflects of an environment towards v, over its power.
vec3 reflected_environment(LightShape shape, vec3 n, vec3 v) {
  vec3 way = reflect(-v, n);
  vec3 sum = (evenly - coat_evenly) * environment_below(shape, way);
  return coat_evenly == 0.0 ? sum : sum + coat_evenly * environment_at(shape, ENVIRONMENT_COATED, way);
}

// Towards v at a point of unit normal n that sees the share `sky` of its surroundings, W/(mm^2 sr).
vec3 specular_radiance(vec3 position, vec3 n, vec3 v, float sky) {
  bool leans = has_normal_map();
  vec3 sum = vec3(0.0), outwards = n;
  if (leans) outwards = mesh_normal;
  for (uint i = 0u; i < SCENE.light_count; ++i) {
    LightRecord light = SCENE.lights.at[i];
    if (light.kind == LIGHT_AMBIENT) {
      sum += evenly / PI * sky * light.power;
      continue;
    }
    LightShape shape = no_shape();
    if (SHAPED) shape = SCENE.shapes.at[i];
    if (SHAPED && light.kind == LIGHT_ENVIRONMENT) {
      sum += sky * light.power * reflected_environment(shape, n, v);
      continue;
    }
    Incident incident = incident_light(light, shape, position);
    float wider = SHAPED && light.kind == LIGHT_PATCH ? blurred(light, shape, position) : 0.0;
    float reflected = highlight(n, v, incident.direction, wider);
    if (leans) reflected *= share_of_slope(n, incident.direction);
    if (reflected == 0.0 || incident.share <= 0.0) continue;
    if (SHAPED && light.kind == LIGHT_PROJECTOR) light.power *= projected(shape, -incident.direction, 0.0);
    sum += reflected * light_visibility(light, SCENE.views, position, outwards, 1) * incident.share * light.power;
  }
  return sum;
}

#endif
