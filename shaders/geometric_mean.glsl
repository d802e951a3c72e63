// Geometric means of exitance. A value far below the arithmetic mean, or none at all, counts as this share of it: one
// clipped vertex must not darken all around it.
const float LEAST_SHARE = 1.0 / 16.0;

vec3 floored_log(vec3 value, vec3 mean) {
  return log(max(max(value, LEAST_SHARE * mean), vec3(1e-37)));
}

vec3 from_log(vec3 logarithm, vec3 mean) {
  return mix(vec3(0), exp(logarithm), greaterThan(mean, vec3(0)));
}
