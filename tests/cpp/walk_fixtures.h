// Walks of the buried source on levels made in memory, without a solve.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "engine/solve/assembly.h"
#include "engine/solve/level_upload.h"
#include "engine/solve/source_walk.h"
#include "tests/cpp/solve_fixtures.h"

namespace quadgraph {

inline glm::dvec3 total(const std::vector<glm::dvec3>& values) {
  glm::dvec3 sum{0};
  for (const glm::dvec3& value : values) sum += value;
  return sum;
}

struct Lit {
  std::uint32_t face = 0;
  glm::vec3 normal{0}, centre{0};
};

struct WalkInput {
  OwnedLevel level;
  std::function<gpu::Optical(const glm::vec3&)> optical;              // at the centroid of a tet
  std::function<float(const Lit&, std::uint32_t quarter)> quarter_q;  // times `colour`
  glm::vec3 colour{1.0f, 0.8f, 0.6f};                                 // W/mm^2
  gpu::BeamRecord beam{gpu::BEAM_DIRECTIONAL, {1, 0, 0}};
  Method method = Method::fem;
  double eta = 1;
  bool even = false;       // `optical` is constant
  bool mean_rays = false;  // WalkTask
};

struct GpuWalk {
  std::vector<std::uint32_t> words;              // of the deposits, then of what left
  std::vector<glm::dvec3> deposit, unscattered;  // W, per vertex or tet, and per face
  glm::dvec3 entered{0};                         // W
  WalkPower power;

  glm::dvec3 balance() const {
    return (total(deposit) + power.absorbed + power.unscattered - entered) / glm::max(entered, glm::dvec3(1e-300));
  }
};

inline gpu::Optical optical_of(const glm::vec3& sigma_s_prime, const glm::vec3& sigma_a) {
  return {sigma_s_prime, sigma_a};
}

inline double area_of(const OwnedLevel& level, const glm::uvec3& f) {
  const glm::dvec3 a(level.vertices[f.x]);
  return 0.5 * glm::length(glm::cross(glm::dvec3(level.vertices[f.y]) - a, glm::dvec3(level.vertices[f.z]) - a));
}

inline Lit lit_face(const OwnedLevel& level, std::uint32_t face) {
  const glm::uvec3& f = level.faces[face];
  const glm::vec3 &a = level.vertices[f.x], &b = level.vertices[f.y], &c = level.vertices[f.z];
  return {face, glm::normalize(glm::cross(b - a, c - a)), (a + b + c) / 3.0f};
}

inline GpuWalk walk(vk::Context& context, const WalkInput& input) {
  const OwnedLevel& level = input.level;
  LevelBuffers buffers = upload_level(context, level.view(), 0);
  std::vector<gpu::Optical> optical;
  for (const glm::vec3& node : level.nodes) optical.push_back(input.optical(node));
  // Light that enters again is even over a face.
  const bool again = input.beam.kind == gpu::BEAM_MEAN;
  std::vector<glm::vec3> q;
  std::vector<float> quarters;
  GpuWalk result;
  for (std::uint32_t f = 0; f < level.faces.size(); ++f) {
    glm::dvec3 sum{0};
    for (std::uint32_t k = 0; k < FACE_QUARTERS; ++k) {
      quarters.push_back(input.quarter_q(lit_face(level, f), again ? 0 : k));
      sum += double{quarters.back()} * glm::dvec3(input.colour) / double{FACE_QUARTERS};
    }
    q.emplace_back(sum);
    result.entered += area_of(level, level.faces[f]) * sum;
  }
  buffers.optical = vk::upload<gpu::Optical>(context, optical, "optical", vk::Place::fields);
  vk::write_bytes(context, buffers.q, std::as_bytes(std::span(q)));
  buffers.beam_q = again ? vk::upload<glm::vec3>(context, q, "beam q") : vk::upload<float>(context, quarters, "beam q");
  const gpu::Beam beam{input.beam, input.colour, again ? gpu::BEAM_RGB : gpu::BEAM_QUARTERS, 0};
  const BeamBuffers beams{{beam}, vk::upload<gpu::Beam>(context, std::span(&beam, 1), "beams")};

  Workspace work(context, buffers.node_count);
  SourceWalk walk(context, level.view(), 0);
  record_scale(work, buffers);
  const WalkTask task{input.method, input.eta, input.even, input.mean_rays};
  walk.record(work, buffers, beams, task);
  if (again) walk.record_again(work, buffers, beams, task);
  work.recorder.submit();
  const glm::dvec3 scale(vk::download<gpu::Scale>(context, work.scale)[0].scale);
  const auto deposit = vk::download<std::uint32_t>(context, walk.deposit(input.method));
  const auto unscattered = vk::download<std::uint32_t>(context, walk.unscattered());
  result.deposit = powers(deposit, scale);
  result.unscattered = powers(unscattered, scale);
  result.words = deposit;
  result.words.insert(result.words.end(), unscattered.begin(), unscattered.end());
  result.power = walk.power();
  return result;
}

// Quarters of every face whose outward normal is `normal`.
inline auto lit_side(const glm::vec3& normal) {
  return [=](const Lit& lit, std::uint32_t) { return glm::dot(lit.normal, normal) > 0.999f ? 1.0f : 0.0f; };
}

// Every outside face but those across x becomes a mirror: a piece of an infinite slab.
inline OwnedLevel slab_level(std::uint32_t n, float size, float jitter = 0) {
  OwnedLevel level = box_level(n, size, jitter);
  for (std::uint32_t f = 0; f < level.faces.size(); ++f) {
    level.face_kinds.push_back(std::abs(lit_face(level, f).normal.x) > 0.999f ? face_open : face_reflecting);
  }
  return level;
}

inline auto uniform(const glm::vec3& sigma_s_prime, const glm::vec3& sigma_a) {
  return [=](const glm::vec3&) { return optical_of(sigma_s_prime, sigma_a); };
}

// Cosine inside of light that comes in along (cos, sin).
inline double refracted_cosine(double cos_i, double eta) {
  return std::sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
}

inline void check_balance(const GpuWalk& result, double tolerance) {
  const glm::dvec3 left = total(result.unscattered);
  for (int c = 0; c < 3; ++c) {
    CAPTURE(c);
    CHECK(std::abs(result.balance()[c]) < tolerance);
    CHECK(left[c] <= result.power.unscattered[c] * (1 + tolerance) + tolerance * result.entered[c]);
  }
}

}  // namespace quadgraph
