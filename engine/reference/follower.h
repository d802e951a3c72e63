// Light that has not scattered, followed back to the surface from one vertex; see uncollided.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/reference/entering.h"
#include "engine/reference/medium.h"
#include "engine/reference/tet_ray.h"
#include "engine/reference/uncollided.h"
#include "shaders/gather/gather_shared.h"

namespace quadgraph {

// Outside faces around each vertex: face[offset[v]] ... face[offset[v + 1] - 1], without reflecting ones.
struct OpenFaces {
  std::vector<std::uint32_t> offset, face;
};

OpenFaces open_faces(const Level& level);

// What Follower needs of the shape.
struct FollowedShape {
  FollowedShape(const Level& level, VertexStarts given)
      : starts(std::move(given)), around(open_faces(level)), normal(open_normals(level)) {}

  VertexStarts starts;
  OpenFaces around;
  std::vector<glm::dvec3> normal;
};

// Uncollided light at a vertex, by channel: fluence entry e^-depth.
template <class Real>
struct UncollidedLight {
  std::array<Real, 3> entry, depth;
  std::array<Real, 3> counts;  // of the beams, that of the one that counts most in `entry` (SHARED_DEPTH)

  UncollidedLight() {
    entry.fill(Real(0));
    counts.fill(Real(0));
    depth.fill(Real(static_cast<double>(gpu::UNCOLLIDED_DEPTH)));
  }
};

// `Medium` is one of medium.h. `Light` gives by channel what its beam brings, W/mm^2: at(face, quarter).
template <class Medium>
class Follower {
 public:
  using Real = typename Medium::Real;
  using Light = UncollidedLight<Real>;
  using Value = std::array<Real, 3>;

  Follower(const Level& level, const Problem& problem, const Medium& medium, const FollowedShape& shape)
      : level_(level), problem_(problem), medium_(medium), shape_(shape) {}

  template <class Lit>
  Light at(std::uint32_t v, const gpu::BeamRecord& beam, const Lit& lit) const {
    const double eta = problem_.eta.of(level_.body_of_tet(shape_.starts.start[v]));
    const auto [mu, share] = lambertian_bundle(eta);
    switch (beam.kind) {
      case gpu::BEAM_LAMBERTIAN:
        return even(v, lit, mu, share);
      case gpu::BEAM_MEAN:
        return even(v, lit, std::array{lambertian_bundle(eta).mean_cosine()}, std::array{1.0});
      default:
        return directed(v, beam, lit);
    }
  }

 private:
  // Where a ray from inside meets an open face.
  struct Arrival {
    std::uint32_t face = 0, quarter = 0;
    glm::dvec3 normal{0};  // of the face, outward
    Value depth{};         // optical, of its way
  };

  std::optional<Arrival> arrive(std::uint32_t v, glm::dvec3 direction) const {
    TetRay ray(level_);
    ray.start_at_vertex(v, shape_.starts.start[v]);
    Arrival arrival;
    arrival.depth.fill(Real(0));
    for (std::uint32_t step = 0; step < gpu::UNCOLLIDED_STEPS; ++step) {
      const TetRay::Exit exit = ray.find_exit(direction);
      if (!exit.found) return std::nullopt;
      double least = HUGE_VAL;
      for (std::size_t c = 0; c < 3; ++c) {
        Real& depth = arrival.depth[c];
        depth = depth + medium_.at(ray.tet(), static_cast<int>(c)).extinction() * exit.length;
        least = std::min(least, value_of(depth));
      }
      if (least > static_cast<double>(gpu::UNCOLLIDED_DEPTH)) return std::nullopt;
      const std::uint32_t next = ray.leave(exit);
      if (next < level_.tet_count()) {
        ray.enter(next);
        continue;
      }
      arrival.face = next - level_.tet_count();
      arrival.normal = ray.face_normal();
      if (!level_.reflecting(arrival.face)) {
        arrival.quarter = ray.quarter_of(arrival.face);
        return arrival;
      }
      direction = mirrored(direction, arrival.normal);
    }
    return std::nullopt;
  }

  // Inside cosine of light that meets the surface from outside at cosine c.
  static double entering(double c, double eta) {
    return std::max(refracted_cosine(std::max(c, 0.0), eta), static_cast<double>(gpu::LEAST_COSINE));
  }

  template <class Lit>
  Light directed(std::uint32_t v, const gpu::BeamRecord& beam, const Lit& lit) const {
    const glm::dvec3 vector(beam.travel_or_from);
    const glm::dvec3 omega =
        beam.kind == gpu::BEAM_DIRECTIONAL ? vector : glm::normalize(glm::dvec3(level_.vertices[v]) - vector);
    if (const auto at_surface = on_lit_surface(v, omega, lit)) return *at_surface;
    const double eta = problem_.eta.of(level_.body_of_tet(shape_.starts.start[v]));
    std::optional<Arrival> arrival = arrive(v, -omega);
    if (arrival && eta > 1) arrival = arrive(v, -refract(omega, arrival->normal, eta));
    if (!arrival) return {};
    const double c = -glm::dot(omega, arrival->normal);
    Light light;
    light.entry = scaled(lit.at(arrival->face, arrival->quarter), 1 / entering(c, eta));
    light.depth = arrival->depth;
    return light;
  }

  static Value scaled(Value value, double factor) {
    for (Real& part : value) part = part * factor;
    return value;
  }

  // The mean over the faces at v, with these weights.
  template <class Lit, class Weight>
  std::optional<Light> mean_at(std::uint32_t v, const Lit& lit, const Weight& weight_of) const {
    Light light;
    light.depth.fill(Real(0));
    double sum = 0;
    for (std::uint32_t i = shape_.around.offset[v]; i < shape_.around.offset[v + 1]; ++i) {
      const std::uint32_t f = shape_.around.face[i];
      const auto [area, factor] = weight_of(frame_of(level_, f));
      if (area == 0) continue;
      const Value value = lit.at(f, corner_of(f, v));
      for (std::size_t c = 0; c < 3; ++c) light.entry[c] = light.entry[c] + value[c] * (area * factor);
      sum += area;
    }
    if (sum == 0) return std::nullopt;
    light.entry = scaled(light.entry, 1 / sum);
    return light;
  }

  // At a vertex of faces that the light falls on: the mean over them.
  template <class Lit>
  std::optional<Light> on_lit_surface(std::uint32_t v, const glm::dvec3& omega, const Lit& lit) const {
    const double eta = problem_.eta.of(level_.body_of_tet(shape_.starts.start[v]));
    return mean_at(v, lit, [&](const FaceFrame& frame) {
      const double c = -glm::dot(omega, frame.normal);
      return c <= 0 ? std::array{0.0, 0.0} : std::array{frame.area, 1 / entering(c, eta)};
    });
  }

  std::uint32_t corner_of(std::uint32_t f, std::uint32_t v) const {
    return level_.faces[f][0] == v ? 0 : level_.faces[f][1] == v ? 1 : 2;
  }

  // Fluence of uniform light below a flat face is q g(tau), g a sum over the bundle's cosines.
  template <class Lit>
  Light even(std::uint32_t v, const Lit& lit, std::span<const double> mu, std::span<const double> share) const {
    using std::exp, std::log;
    double whole = 0;
    for (std::size_t k = 0; k < mu.size(); ++k) whole += share[k] / mu[k];
    const auto at_surface = mean_at(v, lit, [&](const FaceFrame& frame) { return std::array{frame.area, whole}; });
    if (at_surface) return *at_surface;
    const std::optional<Arrival> arrival = arrive(v, shape_.normal[shape_.starts.nearest[v]]);
    if (!arrival) return {};
    Light light;
    light.entry = scaled(lit.at(arrival->face, arrival->quarter), whole);
    const double steepest = 1 / *std::max_element(mu.begin(), mu.end());
    for (std::size_t c = 0; c < 3; ++c) {
      Real left(0);  // of what comes by the steepest way, as that of all may be too little for a number
      for (std::size_t k = 0; k < mu.size(); ++k) {
        left = left + share[k] / mu[k] * exp(-arrival->depth[c] * (1 / mu[k] - steepest));
      }
      light.depth[c] = arrival->depth[c] * steepest - log(left * (1 / whole));
    }
    return light;
  }

  const Level& level_;
  const Problem& problem_;
  const Medium& medium_;
  const FollowedShape& shape_;
};

// Up to where e to the power of it is a number whose square is one, too.
constexpr double most_ahead = 300;

// How much a beam counts in the entry of all.
template <class Real>
Real counts_at(const Real& depth) {
  using std::exp;
  const double shared{gpu::SHARED_DEPTH}, none = std::exp(-double{gpu::UNCOLLIDED_DEPTH} / shared);
  return value_of(depth) < double{gpu::UNCOLLIDED_DEPTH} ? exp(-depth / shared) - Real(none) : Real(0);
}

// The light of both: fluences add up.
template <class Real>
void add(UncollidedLight<Real>& sum, const UncollidedLight<Real>& other) {
  using std::exp, std::log;
  for (std::size_t c = 0; c < 3; ++c) {
    Real &entry = sum.entry[c], &depth = sum.depth[c];
    const bool dark = value_of(other.entry[c]) == 0;
    if (dark && value_of(entry) > 0) continue;
    if (dark && value_of(entry) == 0) {
      if (value_of(other.depth[c]) < value_of(depth)) depth = other.depth[c];
      continue;
    }
    // Relative to the brighter one, as both may be too little for a number.
    const double ahead = value_of(other.depth[c]) - value_of(depth);
    const bool first = value_of(entry) == 0;
    if (first && ahead > most_ahead) depth = other.depth[c];
    const Real least = ahead > 0 && !first ? depth : other.depth[c];
    const Real fluence = entry * exp(-(depth - least)) + other.entry[c] * exp(-(other.depth[c] - least));
    const Real counts = counts_at(other.depth[c]);
    const Real most = value_of(counts) > value_of(sum.counts[c]) ? counts : sum.counts[c];
    entry = value_of(most) > 0 ? (sum.counts[c] * entry + counts * other.entry[c]) / most : entry + other.entry[c];
    sum.counts[c] = most;
    depth = least - log(fluence / entry);
  }
}

}  // namespace quadgraph
