// The processor gives the answers of a Vulkan device, in every pass, and of the reference.
#include <doctest/doctest.h>

#include "engine/cpu/processor.h"
#include "tests/cpp/fixtures/all_work.h"
#include "tests/cpp/fixtures/test_device.h"
#include "tests/cpp/fixtures/walk_fixtures.h"

using namespace quadgraph;

namespace {

std::shared_ptr<device::Device> processor() {
  return std::make_shared<cpu::Processor>();
}

std::shared_ptr<device::Device> vulkan() {
  return open_device(test_vulkan_device());
}

void check_near(const Found& here, const Found& there) {
  double apart = 0, all = 0;
  for (std::size_t i = 0; i < there.values.size(); ++i) {
    apart += std::pow(double{here.values[i]} - double{there.values[i]}, 2);
    all += std::pow(double{there.values[i]}, 2);
  }
  CHECK(all > 0);
  CHECK(std::sqrt(apart) <= there.tolerance * std::sqrt(all));
}

}  // namespace

TEST_CASE("every pass finds the same on both") {
  for (const DeviceWork& work : all_work()) {
    CAPTURE(work.name);
    const std::vector<Found> here = work.run(processor());
    const std::shared_ptr<device::Device> device = vulkan();
    const std::vector<Found> there = work.run(device);
    for (const auto& message : device->validation_messages()) FAIL_CHECK(message);
    REQUIRE(here.size() == there.size());
    for (std::size_t k = 0; k < here.size(); ++k) {
      CAPTURE(here[k].name);
      REQUIRE(here[k].values.size() == there[k].values.size());
      check_near(here[k], there[k]);
    }
  }
}

TEST_CASE("a solve is the solution of the reference") {
  SolvedBody body(processor(), box_graph({6, 3}, 10.0f));
  const Level& level = body.graph.levels()[0];
  std::vector<glm::vec3> q;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) q.push_back(one_side(level.nodes[level.tet_count() + f]));
  const gpu::Material material = homogeneous();
  for (const Case& what : all_cases()) {
    CAPTURE(what);
    solution(body, material, what.options(SolverKind::dpcg, 1e-6));
    const ReferenceSolution expected =
        solve_reference(level, evaluate_material(level, material), material.eta,
                        {{gpu::BEAM_DIRECTIONAL, glm::normalize(glm::vec3(1, 0.2f, 0)), {}, {}}, q},
                        what.options(SolverKind::dpcg, 1e-10), Entries::stored);
    CHECK(relative_difference(body.simulation.phi(), expected.phi) < 1e-6);
  }
}

TEST_CASE("the walk leaves the same power everywhere, whatever light it starts from") {
  CheckedContext here({.device = "cpu"}), there(test_vulkan_device());
  // Bent, so that no ray meets an edge of the surface, where a last bit says through which face it leaves.
  WalkInput input{.level = moved(box_level(4, 4.0f, 0.3f), bent),
                  .optical = [](const glm::vec3& p) { return optical_of({1.0f, p.x, p.y + p.z}, {0.1f, 0.0f, 0.02f}); },
                  .quarter_q = [](const Lit& lit, std::uint32_t k) { return lit.centre.x * static_cast<float>(k + 1); },
                  .eta = 1.3};
  for (const gpu::BeamRecord& beam : beams_of_all_kinds()) {
    for (const Method method : {Method::fem, Method::quadgraph_fv}) {
      CAPTURE(beam.kind);
      CAPTURE(name_of(method));
      input.beam = beam;
      input.method = method;
      const GpuWalk a = walk(here.context, input), b = walk(there.context, input);
      CHECK(glm::length(total(b.deposit)) > 0);
      // Rounding moves a ray by 1e-6 of a tet, and what it leaves in thin corners by as much of the whole.
      CHECK(relative_difference(a.deposit, b.deposit) < 5e-6);
      CHECK(relative_difference(a.unscattered, b.unscattered) < 5e-6);
      CHECK(relative_difference(std::vector{a.power.absorbed}, std::vector{b.power.absorbed}) < 1e-6);
    }
  }
}
