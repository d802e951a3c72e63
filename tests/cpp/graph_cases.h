// Materials, lights and options that the tests of the operators share.
#pragma once

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <vector>

#include "engine/graph/reference.h"
#include "shaders/optics.h"
#include "tests/cpp/test_levels.h"

namespace quadgraph {

inline constexpr std::array<Method, 3> all_methods = {Method::fem, Method::quadgraph_fv, Method::quadgraph_fdm};
inline constexpr std::array<Model, 2> both_models = {Model::diffusion, Model::sp3};
inline constexpr std::array<Source, 2> both_sources = {Source::buried, Source::diffuse};

using Opticals = std::vector<gpu::Optical>;

// The coefficients with diffusion coefficient kappa, mm, as far as sigma_a leaves room.
inline gpu::Optical optical_at(const glm::vec3& kappa, const glm::vec3& sigma_a) {
  return {glm::max(1.0f / (3.0f * kappa) - sigma_a, glm::vec3(0)), sigma_a};
}

inline Opticals uniform(const Level& level, float kappa, float sigma_a) {
  return Opticals(level.nodes.size(), optical_at(glm::vec3(kappa), glm::vec3(sigma_a)));
}

// kappa varies by a factor of `contrast` across the body.
inline Opticals varying(const Level& level, float sigma_a, float contrast = 10.0f) {
  Opticals optical;
  for (const glm::vec3& p : level.nodes) {
    const float wave = std::pow(contrast, 0.5f * std::sin(1.3f * p.x + 0.7f * p.y - p.z));
    optical.push_back(optical_at(wave * glm::vec3(0.2f, 0.3f, 0.5f), sigma_a * glm::vec3(1.0f, 2.0f, 0.5f) / wave));
  }
  return optical;
}

// Lit on the side x = 0 only.
inline std::vector<glm::vec3> one_side(const Level& level) {
  std::vector<glm::vec3> q;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    q.push_back(level.nodes[level.tet_count() + f].x < 1e-4f ? glm::vec3(1.0f, 0.8f, 0.6f) : glm::vec3(0));
  }
  return q;
}

inline std::vector<glm::vec3> everywhere(const Level& level, const glm::vec3& q) {
  return std::vector<glm::vec3>(level.faces.size(), q);
}

inline EnteringLight along_x(std::span<const glm::vec3> q) {
  return {{gpu::BEAM_DIRECTIONAL, glm::vec3(1, 0, 0)}, q};
}

inline EnteringLight lambertian(std::span<const glm::vec3> q) {
  return {{gpu::BEAM_LAMBERTIAN, glm::vec3(0)}, q};
}

inline SolveOptions solving(Method method, Source source, Model model, double tolerance = 1e-12) {
  return {.method = method, .source = source, .model = model, .tolerance = tolerance, .max_iterations = 100000};
}

}  // namespace quadgraph
