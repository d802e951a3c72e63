#include "engine/optics/surface_boundary.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <span>
#include <tuple>

#include "engine/optics/fresnel.h"
#include "engine/optics/rough_boundary.h"
#include "engine/optics/visible_facets.h"

namespace quadgraph {
namespace {

constexpr std::size_t most_kept = 256;

using Key = std::tuple<double, float, float, float, float>;

Key key_of(const OpticalSurface& surface) {
  const Coat coat = surface.coat.share == 0 ? Coat{} : surface.coat;
  const bool rough = surface.rough();
  return {surface.eta, coat.share, coat.eta, rough ? coat.roughness : 0, rough ? surface.roughness : 0};
}

// What is found by a surface and is asked for over and over.
template <typename Found, typename... More>
const Found& kept(const OpticalSurface& surface, const std::function<Found()>& find, More... more) {
  thread_local std::map<std::tuple<Key, More...>, Found> known;
  const std::tuple key(key_of(surface), more...);
  if (const auto found = known.find(key); found != known.end()) return found->second;
  if (known.size() == most_kept) known.clear();
  return known[key] = find();
}

// The integral from 0 to 1 of a function that is a polynomial of degree 7 at most in each of so many even steps.
double integral(std::uint32_t steps, const std::function<double(double)>& f) {
  constexpr std::array<double, 4> place{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                        0.8611363115940526};
  constexpr std::array<double, 4> weight{0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                         0.3478548451374538};
  double sum = 0;
  for (std::uint32_t i = 0; i < steps; ++i) {
    for (std::size_t k = 0; k < place.size(); ++k) sum += weight[k] * f((i + 0.5 + 0.5 * place[k]) / steps);
  }
  return sum / (2 * steps);
}

// At a place of a table of even steps.
double between(std::span<const float> values, double place) {
  const double at = std::clamp(place, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const std::size_t cell = std::min(static_cast<std::size_t>(at), values.size() - 2);
  const double share = at - static_cast<double>(cell);
  return (1 - share) * static_cast<double>(values[cell]) + share * static_cast<double>(values[cell + 1]);
}

std::span<const float> outside_row(const RoughBoundary& boundary) {
  return std::span(boundary).first(gpu::OUTSIDE_STEPS + 1);
}
std::span<const float> inside_row(const RoughBoundary& boundary) {
  return std::span(boundary).last(gpu::INSIDE_STEPS + 1);
}

// Of light from inside: what goes out by the first facet that it meets, and what is mirrored by it and held up by
// others.
glm::dvec2 from_inside(double cosine, float alpha, const OpticalSurface& surface) {
  const glm::vec3 way = way_at(cosine);
  const auto eta = static_cast<float>(surface.eta);
  const double hides = static_cast<double>(gpu::smith_lambda(way.z, alpha));
  return mean_over_facets<glm::dvec2>(way, alpha, [&](const glm::vec3& facet) {
    const double seen = std::clamp(static_cast<double>(glm::dot(way, facet)), 0.0, 1.0);
    const double mirrored = internal_reflectance(seen, surface);
    const double held = mirrored * (1 - static_cast<double>(gpu::gone_for_good(way, facet, alpha)));
    const float up = gpu::refracted_cosine(way, facet, 1 / eta);
    if (mirrored == 1 || up <= 0) return glm::dvec2(0, held);
    const double hidden = static_cast<double>(gpu::smith_lambda(std::min(up, 1.0f), alpha));
    // Seen from both sides of the surface [Heitz 2016], of what is seen from here.
    return glm::dvec2((1 - mirrored) * (1 + hides) * std::beta(1 + hides, 1 + hidden), held);
  });
}

// Mean cosine inside of light from outside at that cosine.
double cosine_inside(double cosine, float alpha, const OpticalSurface& surface) {
  const glm::vec3 way = way_at(cosine);
  const auto eta = static_cast<float>(surface.eta);
  const auto sums = mean_over_facets<glm::dvec2>(way, alpha, [&](const glm::vec3& facet) {
    const float seen = std::clamp(glm::dot(way, facet), 0.0f, 1.0f), down = gpu::refracted_cosine(way, facet, eta);
    const double mirrored = 1 - fresnel_transmittance(static_cast<double>(seen), surface);
    const double goes_in = 1 - mirrored * static_cast<double>(gpu::gone_for_good(way, facet, alpha));
    const double through = goes_in * static_cast<double>(gpu::free_of_facets(down, alpha));
    return glm::dvec2(through, through * static_cast<double>(down));
  });
  return sums.x > 0 ? sums.y / sums.x : 0;
}

double smooth_moment(int n, const OpticalSurface& surface) {
  const double eta = surface.eta, critical = std::sqrt(1.0 - 1.0 / (eta * eta));
  // R starts as a square root at the critical cosine: smooth in t, mu = critical + (1 - critical) t^2. Simpson's rule.
  constexpr int intervals = 1024;
  double sum = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double t = static_cast<double>(i) / intervals;
    const double mu = critical + (1.0 - critical) * t * t;
    const double weight = i == 0 || i == intervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    sum += weight * internal_reflectance(mu, surface) * std::pow(mu, n) * 2.0 * t;
  }
  return std::pow(critical, n + 1) / (n + 1) + (1.0 - critical) * sum / (3.0 * intervals);
}

// The integral of 2 mu over the outside cosine mu of what goes in.
double entering(const RoughBoundary& boundary) {
  return integral(gpu::OUTSIDE_STEPS,
                  [&](double root) { return 4 * root * root * root * (1 - between(outside_row(boundary), root)); });
}

RoughBoundary found_boundary(const OpticalSurface& surface) {
  RoughBoundary found{};
  const OpticalSurface facet = surface.smooth();
  for (std::uint32_t k = 0; k <= gpu::OUTSIDE_STEPS; ++k) {
    const double root = static_cast<double>(k) / gpu::OUTSIDE_STEPS;
    found[k] = static_cast<float>(rough_reflectance(root * root, static_cast<double>(surface.roughness), facet));
  }
  const float alpha = facet_roughness(surface);
  for (std::uint32_t k = 0; k <= gpu::OUTSIDE_STEPS; ++k) {
    const double root = static_cast<double>(k) / gpu::OUTSIDE_STEPS;
    found[gpu::BOUNDARY_COSINES + k] = static_cast<float>(cosine_inside(root * root, alpha, facet));
  }
  std::array<float, gpu::INSIDE_STEPS + 1> through{}, held{};
  for (std::uint32_t k = 0; k <= gpu::INSIDE_STEPS; ++k) {
    const glm::dvec2 light = from_inside(static_cast<double>(k) / gpu::INSIDE_STEPS, alpha, facet);
    through[k] = static_cast<float>(light.x);
    held[k] = static_cast<float>(light.y);
  }
  const auto even = [&](std::span<const float> values) {
    return integral(gpu::INSIDE_STEPS, [&](double mu) { return 2 * mu * between(values, mu); });
  };
  const double wanted = entering(found) / (surface.eta * surface.eta), first = even(through), later = even(held);
  const double goes_on = std::clamp((wanted - first) / std::max(later, 1e-30), 0.0, 1.0);
  // What is left of the balance is a matter of numbers, or of more facets met than two: all that stays has a part in
  // it.
  const double known = first + goes_on * later;
  const double more = std::max((wanted - known) / (1 - known), 0.0), less = std::min(wanted / known, 1.0);
  for (std::uint32_t k = 0; k <= gpu::INSIDE_STEPS; ++k) {
    const double out = less * (static_cast<double>(through[k]) + goes_on * static_cast<double>(held[k]));
    found[gpu::BOUNDARY_INSIDE + k] = static_cast<float>((1 - out) * (1 - more));
  }
  return found;
}

}  // namespace

float facet_roughness(const OpticalSurface& surface) {
  return gpu::facet_roughness(surface.roughness, single_precision(surface));
}

RoughBoundary rough_boundary(const OpticalSurface& surface) {
  return kept<RoughBoundary>(surface, [&] { return found_boundary(surface); });
}

double surface_transmittance(double cosine, const OpticalSurface& surface) {
  if (!surface.rough()) return fresnel_transmittance(cosine, surface);
  return 1 - between(outside_row(rough_boundary(surface)), std::sqrt(std::max(cosine, 0.0)));
}

double fresnel_moment(int n, const OpticalSurface& surface) {
  if (surface.eta == 1.0 && surface.coat.share == 0) return 0.0;
  return kept<double>(
      surface,
      [&] {
        if (!surface.rough()) return smooth_moment(n, surface);
        const RoughBoundary boundary = rough_boundary(surface);
        return integral(gpu::INSIDE_STEPS,
                        [&](double mu) { return between(inside_row(boundary), mu) * std::pow(mu, n); });
      },
      n);
}

double diffuse_transmittance(const OpticalSurface& surface) {
  return surface.eta * surface.eta * (1.0 - 2.0 * fresnel_moment(1, surface));
}

double radiance_norm(const OpticalSurface& surface) {
  if (surface.rough()) return std::numbers::pi * entering(rough_boundary(surface));
  constexpr int steps = 4096;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double cos_o = (i + 0.5) / steps;
    sum += fresnel_transmittance(cos_o, surface) * cos_o;
  }
  return 2 * std::numbers::pi * sum / steps;
}

}  // namespace quadgraph
