// Gathered radiance on the device: that of the CPU, vertex by vertex and face by face.
#include "engine/base/error.h"
#include "engine/reference/gather_scale.h"
#include "engine/reference/radiance.h"
#include "engine/solve/gather_field.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

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
    beam = direction ? gpu::BeamRecord{gpu::BEAM_DIRECTIONAL, glm::normalize(*direction), {}, {}}
                     : gpu::BeamRecord{gpu::BEAM_LAMBERTIAN, {}, {}, {}};
    scene.simulation.solve({.method = Method::fem, .model = Model::sp3, .tolerance = 1e-6});
  }

  const GatherField& field() {
    std::vector<PassStats> passes;
    return scene.simulation.gather(Gather::scaled, passes);
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
      const auto points =
          device::download<gpu::GatherPoint>(gathering.scene.device.context, gathering.field().points());
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
      device::Device& context = gathering.scene.device.context;
      const auto found = device::download<glm::vec3>(context, gathering.field().gathered());
      // From the fields of the device, so that this compares the gather alone.
      Uncollided fields;
      std::vector<glm::dvec3> phi;
      for (const gpu::GatherPoint& point : device::download<gpu::GatherPoint>(context, gathering.field().points())) {
        phi.emplace_back(point.phi);
        fields.entry.emplace_back(point.entry);
        fields.depth.emplace_back(point.depth);
      }
      const auto solved = gathering.scene.simulation.phi();
      CHECK(relative_difference(phi, solved) < 1e-6);
      const auto normals = smooth_normals(gathering.scene.graph.levels()[0]);
      const auto expected =
          gathered_exitance(gathering.scene.graph.levels()[0], gathering.problem(), {phi, fields, normals});
      // The device ends a ray by what the last tet gave, the CPU by what is at its end.
      CHECK(relative_difference(found, expected) < 2e-4);
    }
  }
}

TEST_CASE("normals of the smooth surface are those of the CPU, and follow the shape") {
  Gathering gathering(homogeneous(), ways[0]);
  device::Device& context = gathering.scene.device.context;
  Simulation& simulation = gathering.scene.simulation;
  const Deformer twist{.kind = DeformerKind::twist, .degrees = 50};
  const RestBox cube{{0, 0, 0}, {10, 10, 10}};
  std::vector<glm::dvec3> flat;
  for (const std::vector<Deformer>& list : {std::vector<Deformer>{}, std::vector{twist}}) {
    CAPTURE(list.size());
    if (simulation.set_deformation(list, cube)) {
      simulation.solve({.method = Method::fem, .model = Model::sp3, .tolerance = 1e-6});
    }
    const auto vertices = device::download<glm::vec3>(context, simulation.level(0).vertices);
    Level level = gathering.scene.graph.levels()[0];
    level.vertices = vertices;
    std::vector<glm::dvec3> expected;
    for (const CornerNormals& normals : smooth_normals(level))
      expected.insert(expected.end(), normals.begin(), normals.end());
    const auto found = device::download<glm::vec3>(context, gathering.field().normals());
    CHECK(relative_difference(found, expected) < 1e-5);
    if (flat.empty()) flat = expected;
    CHECK((relative_difference(flat, expected) > 0.05) == !list.empty());
  }
}

TEST_CASE("the scale is that of the CPU at every surface vertex") {
  // Elements of 1.7 mm: shorter than the mean free path of the first, of many those of the last.
  for (const float denser : {0.05f, 1.0f, 20.0f}) {
    CAPTURE(denser);
    gpu::Material material = homogeneous();
    material.sigma_s_prime *= denser;
    material.sigma_a *= denser;
    Gathering gathering(material, ways[0]);
    device::Device& context = gathering.scene.device.context;
    std::vector<glm::dvec3> gathered, shown;
    for (const glm::vec3& value : device::download<glm::vec3>(context, gathering.field().gathered()))
      gathered.emplace_back(value);
    for (const glm::vec3& value : device::download<glm::vec3>(context, gathering.scene.simulation.vertex_exitance()))
      shown.emplace_back(value);
    const auto expected = gather_scale(gathering.scene.graph.levels()[0], gathering.problem(), gathered, shown);
    const auto found = device::download<gpu::GatherScale>(context, gathering.field().scale());
    REQUIRE(found.size() == expected.size());
    for (const gpu::GatherScale& scale : found) {
      for (int c = 0; c < 3; ++c) CHECK(scale.factor[c] <= gpu::GATHER_FACTOR_MAX);
    }
    // What is shown at the faces: where hardly any light is, the factor means nothing.
    const Level& level = gathering.scene.graph.levels()[0];
    std::vector<glm::dvec3> factor, wanted;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      const glm::uvec3& ids = level.faces[f];
      const auto mean = [&](const auto& scale) {
        return gathered[f] / 3.0 *
               (glm::dvec3(scale[ids.x].factor) + glm::dvec3(scale[ids.y].factor) + glm::dvec3(scale[ids.z].factor));
      };
      factor.push_back(mean(found));
      wanted.push_back(mean(expected));
    }
    // The device takes small nodes whole.
    CHECK(relative_difference(factor, wanted) < 0.02);
  }
}

TEST_CASE("a body that has moved is scaled as one that was there") {
  Gathering still(homogeneous(), ways[0]), moved(homogeneous(), ways[0]);
  const auto scale = [](Gathering& gathering) {
    return device::download<gpu::GatherScale>(gathering.scene.device.context, gathering.field().scale());
  };
  const auto before = scale(still);
  // Far away, so that boxes left behind would find nothing.
  std::vector<glm::vec3> away;
  for (const glm::vec3& p : moved.scene.graph.levels()[0].vertices) away.push_back(p + glm::vec3(64, 0, 0));
  scale(moved);
  moved.scene.simulation.set_vertices(0, away);
  moved.scene.simulation.solve({.method = Method::fem, .model = Model::sp3, .tolerance = 1e-6});
  const auto after = scale(moved);
  std::vector<glm::vec3> factor, expected;
  for (std::size_t v = 0; v < before.size(); ++v) {
    factor.push_back(after[v].factor);
    expected.push_back(before[v].factor);
  }
  CHECK(relative_difference(factor, expected) < 1e-2);
}

TEST_CASE("only fluence at vertices with the buried source is gathered, and light scattered once with every method") {
  Scene scene({3});
  scene.simulation.set_material(homogeneous());
  scene.light(one_side);
  std::vector<PassStats> passes;
  CHECK_THROWS_AS(scene.simulation.gather(Gather::scaled, passes), InputError);  // not solved yet
  for (const Case& what : all_cases()) {
    CAPTURE(what);
    scene.simulation.solve(what.options(SolverKind::dpcg, 1e-3));
    const bool can = what.method == Method::fem && what.source == Source::buried;
    CHECK(scene.simulation.can_gather() == can);
    if (!can) CHECK_THROWS_AS(scene.simulation.gather(Gather::scaled, passes), InputError);
    CHECK_NOTHROW(scene.simulation.gather(Gather::single, passes));
  }
}
