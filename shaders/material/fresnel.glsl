#ifndef QUADGRAPH_FRESNEL_GLSL
#define QUADGRAPH_FRESNEL_GLSL

// Unpolarised reflectance of a smooth boundary from outside at incidence cosine `cos_i` in [0, 1]; eta = inside over
// outside >= 1. Exact, as engine/optics/fresnel.h.
float fresnel_reflectance(float cos_i, float eta) {
  if (eta == 1.0) return 0.0;
  float cos_t = sqrt(max(0.0, 1.0 - (1.0 - cos_i * cos_i) / (eta * eta)));
  // Both over one denominator: a division is slow.
  float parallel = eta * cos_i + cos_t, perpendicular = cos_i + eta * cos_t;
  float a = (eta * cos_i - cos_t) * perpendicular, b = (cos_i - eta * cos_t) * parallel, c = parallel * perpendicular;
  return 0.5 * (a * a + b * b) / (c * c);
}

float fresnel_transmittance(float cos_i, float eta) {
  return 1.0 - fresnel_reflectance(cos_i, eta);
}

// From inside at cosine `cosine`: 1 under total reflection.
float internal_reflectance(float cosine, float eta) {
  float sin_o_squared = eta * eta * (1.0 - cosine * cosine);
  return sin_o_squared >= 1.0 ? 1.0 : fresnel_reflectance(sqrt(1.0 - max(sin_o_squared, 0.0)), eta);
}

#endif
