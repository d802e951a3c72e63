// Gathered radiance on the device: that of the CPU, vertex by vertex and face by face.
#include "engine/graph/error.h"
#include "engine/graph/geometry.h"
#include "engine/graph/radiance.h"
#include "engine/solve/gather_field.h"
#include "tests/cpp/solve_fixtures.h"

using namespace quadgraph;

namespace {

// The light of `one_side` along `direction`, or Lambertian, in a box of 10 mm.
struct Gathering {
  Scene scene{{6}};
  std::vector<gpu::Optical> optical;
  gpu::Material material;
  gpu::BeamRecord beam{};

  Gathering(const gpu::Material& of, const std::optional<glm::vec3>& direction) : material(of) {
    const Level& level = scene.graph.levels()[0];
    optical = evaluate_material(level, material);
    scene.simulation.set_material(material);
    scene.simulation.set_irradiance(0, scene.irradiance(0, one_side), direction);
    beam = direction ? gpu::BeamRecord{gpu::BEAM_DIRECTIONAL, glm::normalize(*direction)}
                     : gpu::BeamRecord{gpu::BEAM_LAMBERTIAN, glm::vec3(0)};
    scene.simulation.solve({.method = Method::fem, .model = Model::sp3, .tolerance = 1e-6});
  }

  const GatherField& field() {
    std::vector<PassStats> passes;
    return scene.simulation.gather(passes);
  }

  Problem problem() const { return {Method::fem, Source::buried, Model::sp3, optical, material.eta}; }

  Uncollided expected() const {
    const Level& level = scene.graph.levels()[0];
    std::vector<Quarters> quarters;
    for (const glm::vec3& q : scene.irradiance(0, one_side)) quarters.push_back({q, q, q, q});
    const BeamLight light{beam, quarters};
    return uncollided(level, problem(), std::span(&light, 1), vertex_starts(level));
  }
};

// Not along the edges of the box, where a ray may go either way round.
const std::optional<glm::vec3> ways[] = {glm::vec3(1, 0.013f, 0.007f), glm::vec3(0.3f, 0.7f, -0.4f), std::nullopt};

gpu::Material with_eta(gpu::Material material, float eta) {
  material.eta = eta;
  return material;
}

}  // namespace

TEST_CASE("light that has not scattered is that of the CPU at every vertex") {
  for (const auto& way : ways) {
    for (const gpu::Material& material : {with_eta(homogeneous(), 1.0f), homogeneous(), veined()}) {
      CAPTURE(way.has_value());
      CAPTURE(material.eta);
      Gathering gathering(material, way);
      const auto points = vk::download<gpu::GatherPoint>(gathering.scene.device.context, gathering.field().points());
      const Uncollided expected = gathering.expected();
      REQUIRE(points.size() == expected.entry.size());
      // Rays along edges and faces of the regular box may go either way round.
      std::size_t different = 0;
      for (std::size_t v = 0; v < points.size(); ++v) {
        const glm::dvec3 fluence = glm::dvec3(points[v].entry) * glm::exp(-glm::dvec3(points[v].depth));
        const glm::dvec3 wanted = expected.entry[v] * glm::exp(-expected.depth[v]);
        if (glm::length(fluence - wanted) > 1e-4 * glm::length(wanted) + 1e-6) ++different;
      }
      CHECK(different <= points.size() / 50);
    }
  }
}

TEST_CASE("the exitance of what is gathered is that of the CPU at every face") {
  for (const auto& way : ways) {
    for (const gpu::Material& material : {with_eta(homogeneous(), 1.0f), veined()}) {
      CAPTURE(way.has_value());
      CAPTURE(material.eta);
      Gathering gathering(material, way);
      vk::Context& context = gathering.scene.device.context;
      const auto found = vk::download<glm::vec3>(context, gathering.field().gathered());
      // From the fields of the device, so that this compares the gather alone.
      Uncollided fields;
      std::vector<glm::dvec3> phi;
      for (const gpu::GatherPoint& point : vk::download<gpu::GatherPoint>(context, gathering.field().points())) {
        phi.emplace_back(point.phi);
        fields.entry.emplace_back(point.entry);
        fields.depth.emplace_back(point.depth);
      }
      const auto solved = gathering.scene.simulation.phi();
      CHECK(relative_difference(phi, solved) < 1e-6);
      const auto expected = gathered_exitance(gathering.scene.graph.levels()[0], gathering.problem(), {phi, fields});
      CHECK(relative_difference(found, expected) < 1e-4);
    }
  }
}

TEST_CASE("the scale gives every surface vertex the exitance that is shown") {
  Gathering gathering(homogeneous(), ways[0]);
  vk::Context& context = gathering.scene.device.context;
  const Level& level = gathering.scene.graph.levels()[0];
  const auto gathered = vk::download<glm::vec3>(context, gathering.field().gathered());
  const auto scale = vk::download<gpu::GatherScale>(context, gathering.field().scale());
  const auto shown = vk::download<glm::vec3>(context, gathering.scene.simulation.vertex_exitance());
  std::vector<glm::dvec3> around(scale.size(), glm::dvec3(0));
  std::vector<double> area(scale.size(), 0);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const double size = face_area(level, level.faces[f]);
    for (int k = 0; k < 3; ++k) {
      around[level.faces[f][k]] += size * glm::dvec3(gathered[f]);
      area[level.faces[f][k]] += size;
    }
  }
  for (std::size_t v = 0; v < scale.size(); ++v) {
    const glm::dvec3 total = glm::dvec3(scale[v].factor) * around[v] / area[v] + glm::dvec3(scale[v].rest);
    for (int c = 0; c < 3; ++c) {
      CHECK(total[c] == doctest::Approx(shown[v][c]).epsilon(1e-4));
      CHECK(scale[v].factor[c] >= 0);
      CHECK(scale[v].factor[c] <= gpu::GATHER_FACTOR_MAX);
    }
  }
}

TEST_CASE("only linear elements with the buried source are gathered") {
  Scene scene({3});
  scene.simulation.set_material(homogeneous());
  scene.light(one_side);
  std::vector<PassStats> passes;
  CHECK_THROWS_AS(scene.simulation.gather(passes), InputError);  // not solved yet
  for (const Case& what : all_cases()) {
    CAPTURE(what);
    scene.simulation.solve(what.options(SolverKind::dpcg, 1e-3));
    const bool can = what.method == Method::fem && what.source == Source::buried;
    CHECK(scene.simulation.can_gather() == can);
    if (!can) CHECK_THROWS_AS(scene.simulation.gather(passes), InputError);
  }
}
