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
#include "shaders/shared/random.h"

namespace quadgraph {
namespace {

constexpr std::size_t most_kept = 256;

// Over facets, for each number of a table.
constexpr std::uint32_t outside_ways = 512, inside_ways = 256;

using Key = std::tuple<double, float, float, float, float>;

Key key_of(const OpticalSurface& surface) {
  const Coat coat = surface.coat.share == 0 ? Coat{} : surface.coat;
  return {surface.eta, coat.share, coat.eta, coat.roughness, surface.rough() ? surface.roughness : 0};
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

// What goes through a rough surface.
struct Through {
  double share = 0;
  double cosine = 0;  // mean, with the normal there
};

// A way over its facets (microfacets.h) that divides at each of them.
struct FacetWay {
  glm::vec3 way;
  float side, below = 1;
  double weight = 1;
  int met = 0;
};

class FacetWalk {
 public:
  FacetWalk(const OpticalSurface& facet, float alpha, float begins)
      : facet_(facet), alpha_(alpha), begins_(begins), eta_(static_cast<float>(facet.eta)) {}

  // Of light that meets the surface at that cosine, by so many ways, which are others for each row.
  Through at(double cosine, std::uint32_t row, std::uint32_t ways) {
    const glm::vec3 away = way_at(cosine);
    through_ = back_ = cosines_ = 0;
    row_ = gpu::SPREAD_DIMENSIONS * row;
    for (way_ = 0; way_ < ways; ++way_) {
      state_ = gpu::hash(ways * row + way_);
      follow({.way = {-away.x, 0, -begins_ * away.z}, .side = begins_});
    }
    return {through_ / (through_ + back_), through_ > 0 ? cosines_ / through_ : 0};
  }

 private:
  static constexpr int most_met = 24;
  static constexpr double least_weight = 0.1;

  // In [0, 1): the first ones of a way are spread among all of the row.
  float number(std::uint32_t dimension = gpu::SPREAD_DIMENSIONS) {
    if (dimension < gpu::SPREAD_DIMENSIONS) return gpu::spread_number(row_, way_, dimension);
    state_ = state_ * 747796405u + 2891336453u;
    return static_cast<float>(gpu::hash(state_) >> 8) * 0x1p-24f;
  }

  void follow(FacetWay light) {
    const std::uint32_t first = 3 * static_cast<std::uint32_t>(light.met);  // dimension
    light.below = gpu::next_facet(light.below, light.side * light.way.z, alpha_, number(first));
    if (light.below == gpu::CLEAR_OF_FACETS || ++light.met > most_met) {
      const bool through = light.side != begins_;
      (through ? through_ : back_) += light.weight;
      if (through) cosines_ += light.weight * static_cast<double>(std::abs(light.way.z));
      return;
    }
    const glm::vec2 u(number(first + 1), number(first + 2));
    const glm::vec3 facet = gpu::met_facet(light.way, light.side, alpha_, u);
    const float cosine = std::clamp(-glm::dot(light.way, facet), 0.0f, 1.0f);
    const bool outside = light.side > 0;
    const double mirrored = outside ? 1 - fresnel_transmittance(static_cast<double>(cosine), facet_)
                                    : internal_reflectance(static_cast<double>(cosine), facet_);
    FacetWay on = light;
    on.weight *= mirrored;
    on.way = glm::normalize(light.way + 2 * cosine * facet);
    go_on(on);
    light.weight *= 1 - mirrored;
    light.way = gpu::way_through(light.way, facet, cosine, outside ? 1 / eta_ : eta_);
    light.side = -light.side;
    light.below = 1 - light.below;
    go_on(light);
  }

  // By chance where little is left.
  void go_on(FacetWay light) {
    if (light.weight < least_weight) {
      if (static_cast<double>(number()) * least_weight >= light.weight) return;
      light.weight = least_weight;
    }
    follow(light);
  }

  const OpticalSurface& facet_;
  float alpha_, begins_, eta_;
  std::uint32_t row_ = 0, way_ = 0, state_ = 0;
  double through_ = 0, back_ = 0, cosines_ = 0;  // of the row: shares, and the first times the cosine
};

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
  const float alpha = facet_roughness(surface);
  FacetWalk from_outside(facet, alpha, 1), from_inside(facet, alpha, -1);
  for (std::uint32_t k = 0; k <= gpu::OUTSIDE_STEPS; ++k) {
    const double root = static_cast<double>(k) / gpu::OUTSIDE_STEPS;
    const Through in = from_outside.at(root * root, k, outside_ways);
    // A coat mirrors by a roughness of its own.
    found[k] = static_cast<float>(surface.coat.share == 0
                                      ? 1 - in.share
                                      : rough_reflectance(root * root, static_cast<double>(surface.roughness), facet));
    found[gpu::BOUNDARY_COSINES + k] = static_cast<float>(in.cosine);
  }
  const auto inside = std::span(found).last(gpu::INSIDE_STEPS + 1);
  for (std::uint32_t k = 0; k <= gpu::INSIDE_STEPS; ++k) {
    inside[k] =
        static_cast<float>(1 - from_inside.at(static_cast<double>(k) / gpu::INSIDE_STEPS, k, inside_ways).share);
  }
  const double out = integral(gpu::INSIDE_STEPS, [&](double mu) { return 2 * mu * (1 - between(inside, mu)); });
  // In even light as much goes in as out; what is missing of that has to do with numbers, and coats.
  const double wanted = entering(found) / (surface.eta * surface.eta);
  const double more = std::max((wanted - out) / (1 - out), 0.0), less = std::min(wanted / out, 1.0);
  for (float& mirrored : inside) {
    mirrored = static_cast<float>((1 - less * (1 - static_cast<double>(mirrored))) * (1 - more));
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
