// Bodies of one file, each at its own index of refraction, on the device as in the reference.
#include <doctest/doctest.h>

#include "engine/reference/reference.h"
#include "engine/solve/simulation.h"
#include "tests/cpp/fixtures/checked_context.h"
#include "tests/cpp/fixtures/one_body.h"
#include "tests/cpp/fixtures/solve_fixtures.h"
#include "tests/cpp/fixtures/test_data.h"

using namespace quadgraph;

namespace {

constexpr std::array<float, 2> eta = {1.05f, 1.7f};

struct TwoCubes {
  CheckedContext device;
  QuadGraph graph = QuadGraph::load(test_data("two_cubes.qgraph"));
  Simulation simulation{device.context, graph};
  std::vector<std::vector<glm::vec3>> q;  // per level

  TwoCubes() {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) {
      const Level& level = graph.levels()[i];
      q.emplace_back();
      for (std::uint32_t f = 0; f < level.face_count(); ++f) q[i].push_back(glm::vec3(0.1f, 1.0f, 3.0f) * float(f % 3));
      simulation.set_irradiance(i, q[i]);
    }
  }

  // Throws as set_optical.
  void at(std::span<const float> indices) {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) simulation.set_optical(i, optical(i), indices);
  }

  std::vector<gpu::Optical> optical(std::uint32_t level) const {
    return evaluate_material(graph.levels()[level], homogeneous());
  }
};

}  // namespace

TEST_CASE("two bodies at two indices are solved as in the reference, by every method, model and source") {
  TwoCubes cubes;
  const Level& level = cubes.graph.levels()[0];
  const std::vector<gpu::Optical> optical = cubes.optical(0);
  for (const Case& what : all_cases()) {
    CAPTURE(what);
    cubes.at(eta);
    cubes.simulation.solve(what.options(SolverKind::dpcg, 1e-6));
    const auto solved = [&](const Indices& indices) {
      return solve_reference(level, optical, indices, {{gpu::BEAM_LAMBERTIAN, glm::vec3(0), {}, {}}, cubes.q[0]},
                             what.options(SolverKind::dpcg, 1e-10), Entries::stored);
    };
    const ReferenceSolution expected = solved(Indices(std::vector<double>{double{eta[0]}, double{eta[1]}}));
    CHECK(relative_difference(cubes.simulation.phi(), expected.phi) < 1e-5);
    CHECK(relative_difference(cubes.simulation.surface_field().exitance, expected.exitance) < 1e-5);
    // Each body is as where all have its index.
    for (std::uint32_t body = 0; body < eta.size(); ++body) {
      const ReferenceSolution alike = solved(double{eta[body]});
      for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        const double off = glm::length(alike.exitance[f] - expected.exitance[f]) / glm::length(alike.exitance[f]);
        CHECK((level.body_of_face(f) == body ? off < 1e-6 : off > 1e-3));
      }
    }
  }
}

TEST_CASE("indices are one for all or one for each body, and where they cannot be nothing changes") {
  TwoCubes cubes;
  cubes.at(eta);
  CHECK_THROWS_WITH_AS(cubes.at(std::array{1.1f, 1.2f, 1.3f}),
                       "eta: 3 found, one for all, or one for each of 2 bodies wanted", InputError);
  CHECK_THROWS_WITH_AS(cubes.at(std::array{1.1f, 0.5f}), doctest::Contains("allowed is 1 to 3"), InputError);
  CHECK(std::ranges::equal(cubes.simulation.eta(), eta));
  cubes.at(std::array{1.4f});
  CHECK(std::ranges::equal(cubes.simulation.eta(), std::array{1.4f, 1.4f}));
  const Problem problem{Method::fem, Source::buried, Model::sp3, {}, Indices(std::vector<double>{1, 1.5, 2})};
  const std::vector<gpu::Optical> optical = cubes.optical(0);
  CHECK_THROWS_AS(
      assemble(cubes.graph.levels()[0], {problem.method, problem.source, problem.model, optical, problem.eta}),
      InputError);
}

TEST_CASE("as many bits name a body as tell all apart, and none where they are alike") {
  const CheckedContext checked;
  for (const std::uint32_t bodies : {1u, 2u, 3u, 200u}) {
    Refractions refractions(checked.context, bodies);
    CHECK(refractions.boundaries(Method::fem, Source::buried, Model::sp3).bits() == 0);
    std::vector<float> indices(bodies, 1.3f);
    indices.back() = 1.6f;
    CHECK(refractions.set(indices));
    CHECK(!refractions.set(indices));
    const std::uint32_t bits = refractions.boundaries(Method::fem, Source::buried, Model::sp3).bits();
    CHECK(bits == (bodies == 1 ? 0 : bodies == 2 ? 1 : bodies == 3 ? 3 : 255));
  }
  const OpticalSurface high(1.5), low(1.3), coated(1.5, {.share = 1});
  CHECK(different_surfaces(std::array{high, low, high, coated}) == std::vector{high, low, coated});
}

TEST_CASE("a coat is of one body, of all or of none, and bodies that it parts have boundaries of their own") {
  const CheckedContext checked;
  Refractions refractions(checked.context, 3);
  const Coat lacquer{.share = 1};
  CHECK_FALSE(refractions.set_finishes({}));
  CHECK(refractions.set_finishes(std::array{Finish{}, Finish{lacquer}, Finish{}}));
  CHECK(refractions.boundaries(Method::fem, Source::buried, Model::sp3).bits() == 3);
  CHECK(refractions.surfaces()[1].coat == lacquer);
  CHECK(refractions.set(std::array{1.4f}));
  CHECK(refractions.surfaces()[1] == OpticalSurface(double{1.4f}, lacquer));
  CHECK(refractions.set_finishes(std::array{Finish{lacquer}}));
  CHECK(refractions.boundaries(Method::fem, Source::buried, Model::sp3).bits() == 0);
  CHECK_THROWS_AS(refractions.set_finishes(std::array{Finish{lacquer}, Finish{lacquer}}), InputError);
}
