// Light that the surface reflects. Include after lights.glsl, fresnel.glsl and a SurfaceScene `scene`.

const float PI = 3.14159265;

// Cook and Torrance 1982 with the GGX distribution and height-correlated Smith masking (Walter et al. 2007, Heitz 2014)
// and exact Fresnel reflectance: BRDF times the cosine of incidence, 1/sr.
float cook_torrance(vec3 n, vec3 v, vec3 l) {
  float n_l = dot(n, l), n_v = dot(n, v);
  if (n_l <= 0.0 || n_v <= 0.0) return 0.0;
  vec3 h = normalize(v + l);
  float alpha2 = scene.roughness * scene.roughness;
  float n_h = dot(n, h);
  float base = n_h * n_h * (alpha2 - 1.0) + 1.0;
  float distribution = alpha2 / (PI * base * base);
  float mask = n_v * sqrt(alpha2 + (1.0 - alpha2) * n_l * n_l) + n_l * sqrt(alpha2 + (1.0 - alpha2) * n_v * n_v);
  return distribution * fresnel_reflectance(min(dot(v, h), 1.0), scene.eta) * 0.5 * n_l / mask;
}

// Towards v at a point of unit normal n that sees the share `sky` of its surroundings, W/(mm^2 sr).
vec3 specular_radiance(vec3 position, vec3 n, vec3 v, float sky) {
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < scene.light_count; ++i) {
    LightRecord light = load_light(scene.lights, i);
    if (light.kind == LIGHT_AMBIENT) {
      // As of a smooth surface.
      sum += fresnel_reflectance(clamp(dot(n, v), 0.0, 1.0), scene.eta) / PI * sky * light.power;
      continue;
    }
    Incident incident = incident_light(light, position);
    float reflected = cook_torrance(n, v, incident.direction);
    if (reflected == 0.0) continue;
    sum += reflected * light_visibility(light, scene.views, position, n, 1) * incident.share * light.power;
  }
  return sum;
}
