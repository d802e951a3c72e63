// A graph, a device with validation, and a simulation, for the tests of the solve.
#pragma once

#include <doctest/doctest.h>

#include <cmath>

#include "engine/graph/reference.h"
#include "engine/solve/simulation.h"
#include "tests/cpp/checked_context.h"
#include "tests/cpp/test_graphs.h"

namespace quadgraph {

struct Scene {
  CheckedContext device;
  QuadGraph graph;
  Simulation simulation;

  explicit Scene(const std::vector<std::uint32_t>& cells, float size = 10.0f)
      : graph(QuadGraph::parse(box_graph(cells, size), "box")), simulation(device.context, graph) {}

  // The same function of position on every level.
  template <typename Function>
  void light(const Function& q_at) {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) simulation.set_irradiance(i, irradiance(i, q_at));
  }

  template <typename Function>
  std::vector<glm::vec3> irradiance(std::uint32_t index, const Function& q_at) const {
    const Level& level = graph.levels()[index];
    std::vector<glm::vec3> q;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) q.push_back(q_at(level.nodes[level.tet_count() + f]));
    return q;
  }
};

// Light on the side x = 0.
inline glm::vec3 one_side(const glm::vec3& p) {
  return p.x < 1e-4f ? glm::vec3(1.0f, 0.8f, 0.6f) : glm::vec3(0);
}

inline gpu::Material homogeneous(float sigma_a = 0.05f) {
  gpu::Material material{};
  material.sigma_s_prime = {1.0f, 1.5f, 2.0f};
  material.sigma_a = sigma_a * glm::vec3(1.0f, 2.0f, 0.5f);
  material.eta = 1.3f;
  return material;
}

inline gpu::Material veined() {
  gpu::Material material = homogeneous();
  material.pattern = gpu::PATTERN_VEINS;
  material.second_sigma_s_prime = {4.0f, 3.0f, 1.0f};
  material.second_sigma_a = {0.3f, 0.1f, 0.2f};
  material.period = 5.0f;
  material.sharpness = 2.0f;
  return material;
}

template <typename A, typename B>
double relative_difference(const std::vector<A>& values, const std::vector<B>& expected) {
  REQUIRE(values.size() == expected.size());
  double difference = 0, norm = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(values[i]) - glm::dvec3(expected[i]);
    difference += glm::dot(d, d);
    norm += glm::dot(glm::dvec3(expected[i]), glm::dvec3(expected[i]));
  }
  return std::sqrt(difference / norm);
}

inline std::uint32_t pass_count(const Simulation& simulation, const std::string& name) {
  for (const PassStats& pass : simulation.passes()) {
    if (pass.name == name) return pass.count;
  }
  return 0;
}

inline constexpr std::array<Method, 3> all_methods = {Method::fem, Method::quadgraph_fv, Method::quadgraph_fdm};
inline constexpr std::array<SolverKind, 2> both_solvers = {SolverKind::dpcg, SolverKind::cascade};

inline SolveOptions options(Method method, SolverKind solver, double tolerance, std::uint32_t max_iterations = 5000) {
  return {.method = method,
          .solver = solver,
          .source = Source::diffuse,
          .model = Model::diffusion,
          .tolerance = tolerance,
          .max_iterations = max_iterations};
}

// One way to solve.
struct Case {
  Method method;
  Model model;
  Source source;

  SolveOptions options(SolverKind solver, double tolerance) const {
    return {.method = method,
            .solver = solver,
            .source = source,
            .model = model,
            .tolerance = tolerance,
            .max_iterations = 20000};
  }
};

inline doctest::String toString(const Case& what) {
  return (std::string(name_of(what.method)) + " " + std::string(name_of(what.model)) + " " +
          std::string(name_of(what.source)))
      .c_str();
}

inline std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (Method method : all_methods) {
    for (Model model : {Model::diffusion, Model::sp3}) {
      for (Source source : {Source::buried, Source::diffuse}) cases.push_back({method, model, source});
    }
  }
  return cases;
}

}  // namespace quadgraph
