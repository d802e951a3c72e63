#include "engine/reference/uncollided.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "engine/reference/entering.h"
#include "engine/reference/tet_ray.h"
#include "shaders/gather/gather_shared.h"

namespace quadgraph {
namespace {

// Outside faces around each vertex: face[offset[v]] ... face[offset[v + 1] - 1], without reflecting ones.
struct OpenFaces {
  std::vector<std::uint32_t> offset, face;
};

OpenFaces open_faces(const Level& level) {
  std::vector<std::vector<std::uint32_t>> around(level.vertices.size());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    for (int k = 0; k < 3 && !level.reflecting(f); ++k) around[level.faces[f][k]].push_back(f);
  }
  OpenFaces result;
  for (const auto& faces : around) {
    result.offset.push_back(static_cast<std::uint32_t>(result.face.size()));
    result.face.insert(result.face.end(), faces.begin(), faces.end());
  }
  result.offset.push_back(static_cast<std::uint32_t>(result.face.size()));
  return result;
}

// Where a ray from inside meets an open face.
struct Arrival {
  std::uint32_t face = 0, quarter = 0;
  glm::dvec3 normal{0};  // of the face, outward
  glm::dvec3 depth{0};   // optical, of its way
};

// Uncollided light of one beam at one vertex.
struct Light {
  glm::dvec3 entry{0}, depth{static_cast<double>(gpu::UNCOLLIDED_DEPTH)};
};

class Follower {
 public:
  Follower(const Level& level, const Problem& problem, const VertexStarts& starts)
      : level_(level), problem_(problem), starts_(starts), around_(open_faces(level)), normal_(open_normals(level)) {}

  Light at(std::uint32_t v, const BeamLight& light) const {
    const auto [mu, share] = lambertian_bundle(problem_.eta);
    switch (light.beam.kind) {
      case gpu::BEAM_LAMBERTIAN:
        return even(v, light, mu, share);
      case gpu::BEAM_MEAN:
        return even(v, light, std::array{lambertian_bundle(problem_.eta).mean_cosine()}, std::array{1.0});
      default:
        return directed(v, light);
    }
  }

 private:
  std::optional<Arrival> arrive(std::uint32_t v, glm::dvec3 direction) const {
    TetRay ray(level_);
    ray.start_at_vertex(v, starts_.start[v]);
    Arrival arrival;
    for (std::uint32_t step = 0; step < gpu::UNCOLLIDED_STEPS; ++step) {
      const TetRay::Exit exit = ray.find_exit(direction);
      if (!exit.found) return std::nullopt;
      const gpu::Optical& optical = problem_.optical[ray.tet()];
      arrival.depth += (glm::dvec3(optical.sigma_s_prime) + glm::dvec3(optical.sigma_a)) * exit.length;
      if (std::min({arrival.depth.x, arrival.depth.y, arrival.depth.z}) > static_cast<double>(gpu::UNCOLLIDED_DEPTH))
        return std::nullopt;
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
  double entering(double c) const {
    return std::max(refracted_cosine(std::max(c, 0.0), problem_.eta), static_cast<double>(gpu::LEAST_COSINE));
  }

  Light directed(std::uint32_t v, const BeamLight& light) const {
    const glm::dvec3 vector(light.beam.travel_or_from);
    const glm::dvec3 omega =
        light.beam.kind == gpu::BEAM_DIRECTIONAL ? vector : glm::normalize(glm::dvec3(level_.vertices[v]) - vector);
    if (const auto lit = on_lit_surface(v, omega, light)) return *lit;
    std::optional<Arrival> arrival = arrive(v, -omega);
    if (arrival && problem_.eta > 1) arrival = arrive(v, -refract(omega, arrival->normal, problem_.eta));
    if (!arrival) return {};
    const double c = -glm::dot(omega, arrival->normal);
    return {glm::dvec3(light.quarters[arrival->face][arrival->quarter]) / entering(c), arrival->depth};
  }

  // At a vertex of faces that the light falls on: the mean over them.
  std::optional<Light> on_lit_surface(std::uint32_t v, const glm::dvec3& omega, const BeamLight& light) const {
    glm::dvec3 sum(0);
    double area = 0;
    for (std::uint32_t i = around_.offset[v]; i < around_.offset[v + 1]; ++i) {
      const std::uint32_t f = around_.face[i];
      const FaceFrame frame = frame_of(level_, f);
      const double c = -glm::dot(omega, frame.normal);
      if (c <= 0) continue;
      sum += frame.area / entering(c) * glm::dvec3(light.quarters[f][corner_of(f, v)]);
      area += frame.area;
    }
    if (area == 0) return std::nullopt;
    return Light{sum / area, glm::dvec3(0)};
  }

  std::size_t corner_of(std::uint32_t f, std::uint32_t v) const {
    return level_.faces[f][0] == v ? 0 : level_.faces[f][1] == v ? 1 : 2;
  }

  // Fluence of uniform light below a flat face is q g(tau), g a sum over the bundle's cosines.
  Light even(std::uint32_t v, const BeamLight& light, std::span<const double> mu, std::span<const double> share) const {
    double whole = 0;
    for (std::size_t k = 0; k < mu.size(); ++k) whole += share[k] / mu[k];
    if (around_.offset[v] < around_.offset[v + 1]) return {whole * mean_quarter(v, light), glm::dvec3(0)};
    const std::optional<Arrival> arrival = arrive(v, normal_[starts_.nearest[v]]);
    if (!arrival) return {};
    glm::dvec3 left(0);
    for (std::size_t k = 0; k < mu.size(); ++k) left += share[k] / mu[k] * glm::exp(-arrival->depth / mu[k]);
    return {whole * glm::dvec3(light.quarters[arrival->face][arrival->quarter]), -glm::log(left / whole)};
  }

  glm::dvec3 mean_quarter(std::uint32_t v, const BeamLight& light) const {
    glm::dvec3 sum(0);
    double area = 0;
    for (std::uint32_t i = around_.offset[v]; i < around_.offset[v + 1]; ++i) {
      const std::uint32_t f = around_.face[i];
      const double own = frame_of(level_, f).area;
      sum += own * glm::dvec3(light.quarters[f][corner_of(f, v)]);
      area += own;
    }
    return sum / area;
  }

  const Level& level_;
  const Problem& problem_;
  const VertexStarts& starts_;
  OpenFaces around_;
  std::vector<glm::dvec3> normal_;
};

// The light of both: entries add up, and so do fluences.
void add(Light& sum, const Light& other) {
  for (int c = 0; c < 3; ++c) {
    if (other.entry[c] == 0 && sum.entry[c] > 0) continue;
    if (sum.entry[c] == 0 && other.entry[c] == 0) {
      sum.depth[c] = std::min(sum.depth[c], other.depth[c]);
      continue;
    }
    const double fluence = sum.entry[c] * std::exp(-sum.depth[c]) + other.entry[c] * std::exp(-other.depth[c]);
    sum.entry[c] += other.entry[c];
    sum.depth[c] = -std::log(fluence / sum.entry[c]);
  }
}

}  // namespace

Uncollided uncollided(const Level& level, const Problem& problem, std::span<const BeamLight> beams,
                      const VertexStarts& starts) {
  const Follower follower(level, problem, starts);
  Uncollided result;
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    Light sum;
    for (const BeamLight& beam : beams) add(sum, follower.at(v, beam));
    result.entry.push_back(sum.entry);
    result.depth.push_back(sum.depth);
  }
  return result;
}

}  // namespace quadgraph
