#include "engine/graph/resolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "engine/graph/boundary.h"
#include "engine/graph/geometry.h"
#include "shaders/optics.h"

namespace quadgraph {
namespace {

constexpr std::size_t most_samples = 256;

// Irregular elements do better than layers as deep: .4 to 1.0 of their error on tets in spheres, at mean free paths of
// .1 to 1 element and albedos of .02 to .99.
constexpr double irregular = 0.7;

// Depth in decay lengths from which the discrete modes change their sign from vertex to vertex: the element's mass then
// outweighs its conduction.
const double oscillating = std::sqrt(6.0);

// In slabs SP3 is within 4% of transport from one mean free path of thickness on, a mean chord of two; at half of that
// it is off by 5 to 10%, but where next to nothing is absorbed.
constexpr double thin_chord = 1.5, thin_albedo = 0.97;

// Two moments; diffusion is the first one beside a second that nothing drives.
struct Moments {
  glm::dmat2 conduction, mass, boundary;  // lengths in mean free paths
  glm::dmat2 modes;                       // in columns
  glm::dvec2 rates;                       // squared
};

Boundary boundary_at(double eta, Model model) {
  return boundary_of(Method::fem, Source::buried, model, eta);
}

Moments moments_of(double albedo, const Boundary& k, Model model) {
  if (model != Model::sp3) {
    return {glm::dmat2(1.0 / 3), glm::dmat2(1 - albedo, 0, 0, 1), glm::dmat2(k.k11, 0, 0, 1), glm::dmat2(1),
            glm::dvec2(3 * (1 - albedo), 3)};
  }
  Moments m{glm::dmat2(1, 2.0 / 3, 2.0 / 3, 55.0 / 63) * (1.0 / 3),
            glm::dmat2(1 - albedo, 0, 0, 5.0 / 9),
            glm::dmat2(k.k11, k.k12, k.k12, k.k22),
            {},
            {}};
  const glm::dmat2 n = glm::inverse(m.conduction) * m.mass;
  const double half_trace = (n[0][0] + n[1][1]) / 2, determinant = glm::determinant(n);
  const double larger = half_trace + std::sqrt(half_trace * half_trace - determinant);
  m.rates = {determinant / larger, larger};
  for (int i = 0; i < 2; ++i) m.modes[i] = glm::dvec2(n[1][0], m.rates[i] - n[0][0]);
  return m;
}

// M / q of -G u'' + M u = albedo e^-z in the first moment, G u'(0) = K u(0).
double exact_reflectance(const Moments& m, double albedo) {
  const glm::dvec2 particular = -(glm::inverse(m.conduction - m.mass) * glm::dvec2(albedo, 0));
  glm::dmat2 equations;
  for (int i = 0; i < 2; ++i) {
    equations[i] = m.boundary * m.modes[i] + std::sqrt(m.rates[i]) * (m.conduction * m.modes[i]);
  }
  const glm::dvec2 amount = glm::inverse(equations) * (-(m.boundary * particular + m.conduction * particular));
  return (m.boundary * (m.modes * amount + particular)).x;
}

// By what a mode of squared rate `rate` changes from layer to layer: the root mu, |mu| < 1, of
// (2 - s) + x (4 + s) = 0 with s = mu + 1 / mu and x = rate depth^2 / 6.
double layer_ratio(double rate, double depth) {
  const double x = rate * depth * depth / 6;
  if (x == 1) return 0;
  const double s = (2 + 4 * x) / (1 - x);
  return std::copysign(2 / (std::abs(s) + std::sqrt(std::max(0.0, s * s - 4))), s);
}

// The same on layers: the particular solution falls by e^-depth from layer to layer, like the load.
double layered_reflectance(const Moments& m, double albedo, double depth) {
  const double once = std::exp(-depth), entered = -std::expm1(-depth);
  const glm::dmat2 beside = m.conduction * (-1 / depth) + m.mass * (depth / 6);
  const glm::dmat2 middle = m.conduction * (2 / depth) + m.mass * (4 * depth / 6);
  const glm::dmat2 first = m.conduction * (1 / depth) + m.mass * (depth / 3) + m.boundary;
  const glm::dmat2 row = middle * once + beside * (1 + once * once);
  const glm::dvec2 particular = glm::inverse(row) * glm::dvec2(albedo * entered * entered / depth, 0);
  const glm::dvec2 load(albedo * (1 - entered / depth), 0);
  glm::dmat2 equations;
  for (int i = 0; i < 2; ++i) {
    equations[i] = first * m.modes[i] + beside * m.modes[i] * layer_ratio(m.rates[i], depth);
  }
  const glm::dvec2 amount = glm::inverse(equations) * (load - first * particular - beside * particular * once);
  return (m.boundary * (m.modes * amount + particular)).x;
}

double channel(const glm::vec3& v, int c) {
  return static_cast<double>(v[c]);
}

LayeredHalfSpace layered(double albedo, const Boundary& boundary, double depth, Model model) {
  // Removable singularities: no decay at all, and one exactly like that of the source.
  albedo = std::min(albedo, 1 - 1e-9);
  if (std::abs(albedo - 2.0 / 3) < 1e-6) albedo += 2e-6;
  const Moments m = moments_of(std::max(albedo, 0.0), boundary, model);
  const double decay = std::sqrt(m.rates.x) * depth;
  if (albedo <= 0) return {0, 0, decay};
  return {layered_reflectance(m, albedo, depth), exact_reflectance(m, albedo), decay};
}

struct Local {
  double albedo, sigma_t;  // 1/mm
};

Local local_of(const gpu::Optical& optical, int c) {
  const double scattering = channel(optical.sigma_s_prime, c), sigma_t = scattering + channel(optical.sigma_a, c);
  return {sigma_t > 0 ? scattering / sigma_t : 0.0, sigma_t};
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2g", value);
  return text;
}

double least_albedo_of(std::span<const gpu::Optical> optical) {
  double least = 1;
  for (const gpu::Optical& o : optical) {
    for (int c = 0; c < 3; ++c) {
      const Local local = local_of(o, c);
      if (local.albedo > 0) least = std::min(least, local.albedo);
    }
  }
  return least;
}

// Of the channel in which the body is thinnest and absorbs, in mean free paths; infinite if there is none.
double least_thickness(std::span<const gpu::Optical> optical, double chord) {
  double least = HUGE_VAL;
  for (int c = 0; c < 3; ++c) {
    double sigma_t = 0, scattering = 0;
    for (const gpu::Optical& o : optical) {
      sigma_t += local_of(o, c).sigma_t / static_cast<double>(optical.size());
      scattering += channel(o.sigma_s_prime, c) / static_cast<double>(optical.size());
    }
    if (scattering > 0 && scattering < thin_albedo * sigma_t) least = std::min(least, sigma_t * chord);
  }
  return least;
}

}  // namespace

std::uint32_t surface_sample_step(const Level& level) {
  return static_cast<std::uint32_t>(std::max<std::size_t>(1, (level.faces.size() + most_samples - 1) / most_samples));
}

std::vector<SurfaceSample> surface_samples(const Level& level) {
  std::vector<SurfaceSample> samples;
  const std::size_t step = surface_sample_step(level);
  for (std::size_t f = 0; f < level.faces.size(); f += step) {
    if (level.reflecting(static_cast<std::uint32_t>(f))) continue;
    const std::uint32_t tet = level.face_tets[f];
    const double area = face_area(level, level.faces[f]);
    samples.push_back({3 * tet_volume(level, level.tets[tet]) / area, area, tet});
  }
  return samples;
}

double mean_chord(const Level& level) {
  double volume = 0, area = 0;
  for (const glm::uvec4& tet : level.tets) volume += tet_volume(level, tet);
  for (std::size_t f = 0; f < level.faces.size(); ++f) {
    if (!level.reflecting(static_cast<std::uint32_t>(f))) area += face_area(level, level.faces[f]);
  }
  return area > 0 ? 4 * volume / area : HUGE_VAL;
}

LayeredHalfSpace layered_half_space(double albedo, double eta, double depth, Model model) {
  return layered(albedo, boundary_at(eta, model), depth, model);
}

Resolution resolution_of(std::span<const SurfaceSample> samples, std::span<const gpu::Optical> optical, double eta,
                         Model model) {
  const Boundary boundary = boundary_at(eta, model);
  double squares = 0, sizes = 0, area = 0;
  glm::dvec3 decay(0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    area += samples[i].area;
    for (int c = 0; c < 3; ++c) {
      const Local local = local_of(optical[i], c);
      if (!(local.sigma_t > 0)) continue;
      const auto found = layered(local.albedo, boundary, samples[i].depth * local.sigma_t, model);
      const double off = irregular * (found.reflectance - found.exact);
      if (std::isfinite(off)) squares += samples[i].area * off * off;
      sizes += samples[i].area * found.exact * found.exact;
      decay[c] += samples[i].area * found.decay;
    }
  }
  Resolution result;
  if (sizes > 0) result.error = std::sqrt(squares / sizes);
  if (area > 0) result.decay = std::max({decay.x, decay.y, decay.z}) / area;
  return result;
}

std::string mesh_warning(const Resolution& resolution) {
  if (!(resolution.decay > oscillating)) return "";
  return "elements at the surface are " + number(resolution.decay) +
         " decay lengths of the light deep: where it does not fall it is not resolved; a file with more vertices would";
}

std::string model_warning(std::span<const gpu::Optical> optical, double eta, double chord, Source source, Model model) {
  const double thickness = least_thickness(optical, chord);
  if (thickness < thin_chord) {
    return "light crosses the body in " + number(thickness) +
           " mean free paths on average: no model here is near transport in a body as thin as that";
  }
  const double albedo = least_albedo_of(optical);
  if (model != Model::diffusion || source != Source::buried || albedo >= 1) return "";
  const double off = diffusion_error(albedo, eta);
  if (!(off > model_tolerance)) return "";
  return "diffusion is off by " + number(100 * off) + "% at albedo " + number(albedo) + ", sp3 is not";
}

}  // namespace quadgraph
