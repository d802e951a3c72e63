// Lambertian light behind the surface that it entered: shares p_k of its power at inside cosines mu_k, the Gauss nodes of
// the outside cosine. Include after fresnel.glsl.
struct Lambertian {
  vec4 share, cosine;
};

Lambertian lambertian(float eta) {
  Lambertian light;
  for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) {
    light.share[k] = LAMBERTIAN_W[k] * fresnel_transmittance(sqrt(LAMBERTIAN_U[k]), eta);
    light.cosine[k] = sqrt(1.0 - (1.0 - LAMBERTIAN_U[k]) / (eta * eta));
  }
  light.share /= dot(light.share, vec4(1));
  return light;
}
