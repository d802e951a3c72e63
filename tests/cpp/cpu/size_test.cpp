// Bodies of any size, and light that fades to nothing.
#include <doctest/doctest.h>

#include "engine/cpu/processor.h"
#include "tests/cpp/fixtures/solved_body.h"

using namespace quadgraph;

namespace {

bool finite(const std::vector<glm::vec3>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); });
}

gpu::Material per_length(gpu::Material material, float scale) {
  for (glm::vec3* each : {&material.sigma_s_prime, &material.sigma_a}) *each /= scale;
  return material;
}

}  // namespace

TEST_CASE(
    "a body of a micrometre or of 100 m shines as one of 10 mm whose coefficients are as much larger or smaller") {
  const auto processor = std::make_shared<cpu::Processor>();
  const QuadGraph usual = QuadGraph::parse(box_graph({6, 3}, 10.0f), "box");
  const Level& level = usual.levels()[0];
  const gpu::Material material = homogeneous();
  std::vector<glm::vec3> q;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) q.push_back(one_side(level.nodes[level.tet_count() + f]));
  for (const float scale : {1e-4f, 1.0f, 1e4f}) {
    CAPTURE(scale);
    SolvedBody body(processor, box_graph({6, 3}, 10.0f * scale));
    for (std::uint32_t i = 0; i < 2; ++i) {
      const Level& of_body = usual.levels()[i];
      std::vector<glm::vec3> lit;
      for (std::uint32_t f = 0; f < of_body.face_count(); ++f) {
        lit.push_back(one_side(of_body.nodes[of_body.tet_count() + f]));
      }
      body.simulation.set_irradiance(i, lit, glm::vec3(1, 0.2f, 0));
    }
    body.simulation.set_material(per_length(material, scale));
    for (const Case& what : all_cases()) {
      CAPTURE(what);
      const SolverKind solver = what.method == Method::fem ? SolverKind::fmg_pcg : SolverKind::dpcg;
      body.simulation.solve(what.options(solver, 1e-6));
      const ReferenceSolution expected =
          solve_reference(level, evaluate_material(level, material), material.eta,
                          {{gpu::BEAM_DIRECTIONAL, glm::normalize(glm::vec3(1, 0.2f, 0)), {}, {}}, q},
                          what.options(SolverKind::dpcg, 1e-10), Entries::exact);
      // Vertices are rounded anew at every size, and entries are stored with 20 bits.
      CHECK(relative_difference(body.simulation.phi(), expected.phi) < 1e-5);
    }
  }
}

TEST_CASE("light that fades below the least number leaves everything finite, and what leaves the lit side as it is") {
  SolvedBody body(std::make_shared<cpu::Processor>(), box_graph({8, 4}, 10.0f));
  for (const float coefficient : {10.0f, 1e3f, 1e5f}) {
    CAPTURE(coefficient);
    gpu::Material material = homogeneous();
    material.sigma_s_prime = material.sigma_a = glm::vec3(coefficient);
    for (const Method method : {Method::fem, Method::quadgraph_fv}) {
      for (const SolverKind solver : {SolverKind::dpcg, SolverKind::cascade}) {
        CAPTURE(name_of(method));
        CAPTURE(name_of(solver));
        const auto exitance =
            solution(body, material, {.method = method, .solver = solver, .tolerance = 1e-4, .cycles = 30});
        CHECK(finite(exitance));
        CHECK(finite(body.simulation.phi()));
        const SurfaceField field = body.simulation.surface_field();
        double lit = 0, dark = 0;
        for (std::size_t f = 0; f < exitance.size(); ++f) {
          double& side = field.q[f].x > 0 ? lit : dark;
          side = std::max(side, double{exitance[f].x});
        }
        CHECK(lit > 0);
        CHECK(dark < lit);
      }
    }
  }
}
