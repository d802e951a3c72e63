#include "engine/reference/resolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "engine/file/geometry.h"
#include "engine/optics/boundary.h"
#include "engine/optics/half_space.h"
#include "shaders/material/optics.h"
#include "shaders/transport/element_loss.h"

namespace quadgraph {
namespace {

constexpr std::size_t most_samples = 256;

// Irregular elements do better than layers as deep: .4 to 1.0 of their error on tets in spheres, at mean free paths of
// .1 to 1 element and albedos of .02 to .99.
constexpr double irregular = 0.7;

// Depth in decay lengths from which the discrete modes change their sign from vertex to vertex: the element's mass then
// outweighs its conduction.
const double oscillating = std::sqrt(6.0);

// Of what sweeps do not see in elements that deep (shaders/transport/element_loss.h) the share that is not known.
constexpr double unknown_loss = 0.1;

struct Local {
  double albedo, sigma_t;  // 1/mm
};

// Sweeps settle slowly where elements are many mean free paths deep and little is absorbed: what the solve and the
// sweep make of light within an element differs, and diffusion carries that on. Measured on two bodies, at .5 to 10
// mean free paths and albedos of .9 to .9995 (docs/physics.md, "Transport correction").
constexpr double slow_per_depth = 0.45, slow_power = 8;

double slowness(const Local& local, double depth) {
  return -std::expm1(-slow_per_depth * depth * local.sigma_t) * std::pow(local.albedo, slow_power);
}

// In slabs SP3 is within 4% of transport from one mean free path of thickness on, a mean chord of two; at half of that
// it is off by 5 to 10%, but where next to nothing is absorbed.
constexpr double thin_chord = 1.5, thin_albedo = 0.97;

double channel(const glm::vec3& v, int c) {
  return static_cast<double>(v[c]);
}

// Ways through the thick of a body, in mean chords: the diameter of a ball is 1.5. Of light that falls by more than e^6
// on them next to none is seen. Less than a twentieth of it is lost on most meshes.
constexpr double crossing = 1.5, no_light = 6, lost_tolerance = 0.05;

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

// Thickness in mean free paths, in the absorbing channel in which it is least; infinite if no channel absorbs.
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

struct Loss {
  double share = 0;         // of the light that crosses the body
  double decay_length = 0;  // mm
};

// Linear elements of edge h let light that falls as exp(-k s) fall by k^3 h^2 / 24 more in every mm: the largest loss
// of a channel in which light crosses the body at all. Light also falls because it spreads.
Loss largest_loss(std::span<const gpu::Optical> optical, double edge, double chord) {
  Loss largest;
  const double way = crossing * chord;
  for (int c = 0; c < 3; ++c) {
    double scattering = 0, absorption = 0;
    for (const gpu::Optical& o : optical) {
      scattering += channel(o.sigma_s_prime, c) / static_cast<double>(optical.size());
      absorption += channel(o.sigma_a, c) / static_cast<double>(optical.size());
    }
    const double sigma_t = scattering + absorption;
    const double rate = std::min(std::sqrt(3 * absorption * sigma_t), sigma_t);
    if (!(scattering > 0) || rate * way > no_light) continue;
    const double decay = std::hypot(rate, 2 / way),
                 share = 1 - std::exp(-way * decay * decay * decay * edge * edge / 24);
    if (share > largest.share) largest = {share, 1 / decay};
  }
  return largest;
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
    samples.push_back({3 * tet_volume(level, level.tets[tet]) / area, area, tet, level.body_of_tet(tet)});
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

Resolution resolution_of(std::span<const SurfaceSample> samples, std::span<const gpu::Optical> optical,
                         std::span<const float> eta, Model model) {
  std::vector<Boundary> boundaries;
  for (const float index : eta) boundaries.push_back(boundary_of(Method::fem, Source::buried, model, double{index}));
  double squares = 0, corrected = 0, sizes = 0, area = 0;
  glm::dvec3 decay(0), slow(0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    area += samples[i].area;
    const glm::vec3 seen = gpu::seen_of_element(optical[i], static_cast<float>(samples[i].depth), eta[samples[i].body]);
    for (int c = 0; c < 3; ++c) {
      const Local local = local_of(optical[i], c);
      if (!(local.sigma_t > 0)) continue;
      const auto found =
          layered_half_space(local.albedo, boundaries[samples[i].body], samples[i].depth * local.sigma_t, model);
      const double off = irregular * (found.reflectance - found.exact);
      if (std::isfinite(off)) squares += samples[i].area * off * off;
      const double lost = unknown_loss * (1 - channel(seen, c)) * found.exact;
      corrected += samples[i].area * lost * lost;
      sizes += samples[i].area * found.exact * found.exact;
      decay[c] += samples[i].area * found.decay;
      slow[c] += samples[i].area * slowness(local, samples[i].depth);
    }
  }
  Resolution result;
  if (sizes > 0) {
    result.error = std::sqrt(squares / sizes);
    result.corrected = std::sqrt(corrected / sizes);
  }
  if (area > 0) {
    result.decay = std::max({decay.x, decay.y, decay.z}) / area;
    result.slow = std::max({slow.x, slow.y, slow.z}) / area;
  }
  return result;
}

std::string mesh_warning(const Resolution& resolution) {
  if (!(resolution.decay > oscillating)) return "";
  return "elements at the surface are " + number(resolution.decay) +
         " decay lengths of the light deep: where it does not fall it is not resolved; a file with more vertices would";
}

double inside_edge(const Level& level, const Listener& listener) {
  double volume = 0, squares = 0;
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    heed(listener, t);
    const glm::uvec4& links = level.links[t];
    if (std::max({links.x, links.y, links.z, links.w}) >= level.tets.size()) continue;
    const double own = tet_volume(level, level.tets[t]);
    volume += own;
    squares += own * std::pow(6 * std::sqrt(2.0) * own, 2.0 / 3);
  }
  return volume > 0 ? std::sqrt(squares / volume) : 0;
}

std::string inside_warning(std::span<const gpu::Optical> optical, double edge, double chord) {
  const Loss loss = largest_loss(optical, edge, chord);
  if (!(loss.share > lost_tolerance)) return "";
  return "inside, elements of " + number(edge) + " mm are coarse for light that falls by e in " +
         number(loss.decay_length) + " mm: what crosses the body comes out at least about " + number(100 * loss.share) +
         "% too weak; a file baked with --for-material would not have that";
}

std::string model_warning(std::span<const gpu::Optical> optical, std::span<const float> eta, double chord,
                          Source source, Model model) {
  const double thickness = least_thickness(optical, chord);
  if (thickness < thin_chord) {
    return "light crosses the body in " + number(thickness) +
           " mean free paths on average: no model here is near transport in a body as thin as that";
  }
  const double albedo = least_albedo_of(optical);
  if (model != Model::diffusion || source != Source::buried || albedo >= 1) return "";
  double off = 0;
  for (const float index : eta) off = std::max(off, diffusion_error(albedo, double{index}));
  if (!(off > model_tolerance)) return "";
  return "diffusion is off by " + number(100 * off) + "% at albedo " + number(albedo) + ", sp3 is not";
}

}  // namespace quadgraph
