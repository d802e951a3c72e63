// The material field, evaluated by the same code on the GPU and in the CPU reference.
#ifndef QUADGRAPH_MATERIAL_H
#define QUADGRAPH_MATERIAL_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::abs;
using glm::clamp;
using glm::dot;
using glm::floor;
using glm::mix;
using glm::pow;
using glm::sin;
using glm::sqrt;
#endif

// Integer hash of a lattice point to [0, 1] (PCG output permutation, Jarzynski and Olano 2020).
QG_INLINE float lattice_value(int x, int y, int z) {
  uint state = (uint(x) * 73856093u) ^ (uint(y) * 19349663u) ^ (uint(z) * 83492791u);
  state = state * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  word = (word >> 22u) ^ word;
  return float(word >> 8u) * (1.0f / 16777215.0f);
}

// Value noise in [0, 1], continuously differentiable.
QG_INLINE float value_noise(vec3 p) {
  vec3 cell = floor(p);
  vec3 f = p - cell;
  vec3 u = f * f * (vec3(3.0f) - 2.0f * f);
  int x = int(cell.x), y = int(cell.y), z = int(cell.z);
  float y0z0 = mix(lattice_value(x, y, z), lattice_value(x + 1, y, z), u.x);
  float y1z0 = mix(lattice_value(x, y + 1, z), lattice_value(x + 1, y + 1, z), u.x);
  float y0z1 = mix(lattice_value(x, y, z + 1), lattice_value(x + 1, y, z + 1), u.x);
  float y1z1 = mix(lattice_value(x, y + 1, z + 1), lattice_value(x + 1, y + 1, z + 1), u.x);
  return mix(mix(y0z0, y1z0, u.y), mix(y0z1, y1z1, u.y), u.z);
}

// Four octaves in [0, 1].
QG_INLINE float turbulence(vec3 p) {
  float sum = 0.0f;
  float amplitude = 8.0f / 15.0f;
  for (int octave = 0; octave < 4; ++octave) {
    sum += amplitude * value_noise(p);
    p = p * 2.03f + vec3(17.1f, 5.3f, 11.7f);
    amplitude *= 0.5f;
  }
  return sum;
}

// 0 below `edge`, 1 above, in between over 1 / sharpness.
QG_INLINE float step_at(float edge, float x, float sharpness) {
  float t = clamp((x - edge) * sharpness + 0.5f, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// 1 at the centre of a vein, 0 half a period away: sheets across a slanted axis, bent by turbulence (Perlin 1985).
QG_INLINE float veins(vec3 p, float sharpness) {
  float phase = dot(p, vec3(0.62f, 0.70f, 0.35f)) + 2.2f * turbulence(p * 0.7f);
  float wave = 1.0f - abs(sin(3.14159265f * phase));
  return pow(clamp(wave, 0.0f, 1.0f), sharpness);
}

// Shells around the hills and hollows of turbulence, each of its own shade, as agate grows.
QG_INLINE float bands(vec3 p, float sharpness) {
  float phase = 16.0f * turbulence(p * 0.2f);
  float band = floor(phase);
  int shade = int(band);
  float before = lattice_value(shade, 0, 0), after = lattice_value(shade + 1, 0, 0);
  return mix(before, after, step_at(0.5f, phase - band, sharpness));
}

// Rings around the y axis, bent a little: slowly up, quickly down, as wood grows.
QG_INLINE float rings(vec3 p, float sharpness) {
  vec2 across = vec2(p.x, p.z);
  float radius = sqrt(dot(across, across)) + 1.5f * turbulence(p * vec3(0.25f, 0.06f, 0.25f));
  float part = radius - floor(radius);
  return pow(part, sharpness) * (1.0f - step_at(0.96f, part, 25.0f));
}

// Where the second set of coefficients is, 0 to 1.
QG_INLINE float pattern_amount(Material m, vec3 position, float depth) {
  if (m.pattern == PATTERN_LAYERS) return step_at(1.0f, depth / m.period, m.sharpness);
  vec3 p = position / m.period;
  if (m.pattern == PATTERN_VEINS) return veins(p, m.sharpness);
  if (m.pattern == PATTERN_CLOUDS) return step_at(0.5f, turbulence(p), m.sharpness);
  if (m.pattern == PATTERN_BANDS) return bands(p, m.sharpness);
  if (m.pattern == PATTERN_RINGS) return rings(p, m.sharpness);
  if (m.pattern == PATTERN_SPOTS) return step_at(0.72f, value_noise(p), m.sharpness);
  vec3 cell = floor(p);
  float sum = cell.x + cell.y + cell.z;
  return sum - 2.0f * floor(0.5f * sum);
}

// Coefficients at `position` (mm, object space), `depth` mm below the surface.
QG_INLINE Optical material_at(Material m, vec3 position, float depth) {
  Optical optical;
  optical.sigma_s_prime = m.sigma_s_prime;
  optical.sigma_a = m.sigma_a;
  if (m.pattern != PATTERN_NONE) {
    float t = pattern_amount(m, position, depth);
    optical.sigma_s_prime = mix(m.sigma_s_prime, m.second_sigma_s_prime, t);
    optical.sigma_a = mix(m.sigma_a, m.second_sigma_a, t);
  }
  return optical;
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
