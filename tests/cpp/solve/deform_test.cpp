// Levels that a list of deformers moves on the device: where they are, and what is solved on them.
#include "engine/deform/deform.h"

#include <cmath>
#include <cstring>

#include "engine/base/error.h"
#include "shaders/deform/deform_shared.h"
#include "tests/cpp/fixtures/deform_fixtures.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

const RestBox cube{{0, 0, 0}, {10, 10, 10}};

// Two slabs that see each other, veined, lit from above.
struct Slabs {
  CheckedContext device;
  QuadGraph graph;
  Simulation simulation;
  RestBox box;
  glm::vec3 down{0, -1, 0};

  Slabs() : graph(QuadGraph::parse(graph_of(levels()), "slabs")), simulation(device.context, graph) {
    simulation.set_material(veined());
    box = rest_box(graph.levels()[0].vertices);
  }

  static std::vector<OwnedLevel> levels() {
    OwnedLevel coarse = facing_slabs(2, 10.0f, 2.0f, 4.0f);
    bake_seen(coarse, 100);
    return {facing_slabs(3, 10.0f, 2.0f, 4.0f), coarse};
  }

  void deform(const std::vector<Deformer>& list) { simulation.set_deformation(list, box); }

  SolveReport solve(Method method = Method::fem) {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) {
      const Level& level = graph.levels()[i];
      std::vector<glm::vec3> q;
      for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        q.emplace_back(level.nodes[level.tet_count() + f].y > 3.99f ? 1.0f : 0.0f);
      }
      simulation.set_irradiance(i, q, down);
    }
    return simulation.solve({.method = method, .model = Model::diffusion, .tolerance = 1e-5});
  }
};

bool same_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(glm::vec3)) == 0;
}

// A direction, turned as the body is.
glm::vec3 turned_by(Deformer motion, const glm::vec3& direction, const RestBox& box) {
  motion.translate = {};
  motion.centre = glm::dvec3(0);
  return glm::vec3(deformed(std::span(&motion, 1), box, {}, std::span(&direction, 1))[0]);
}

bool finite(const std::vector<glm::vec3>& values) {
  for (const glm::vec3& v : values) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("the device moves vertices as double precision does, every kind alone and all in a row") {
  Scene scene({4, 2});
  std::vector<std::vector<Deformer>> lists = {all_kinds(cube)};
  for (const Deformer& deformer : all_kinds(cube)) lists.push_back({deformer});
  for (const double degrees : {1e-3, 1800.0}) lists.push_back({{.kind = DeformerKind::twist, .degrees = degrees}});
  for (const std::vector<Deformer>& list : lists) {
    CAPTURE(name_of(list[0].kind));
    CAPTURE(list.size());
    CHECK(scene.simulation.set_deformation(list, cube));
    CHECK(!scene.simulation.set_deformation(list, cube));
    for (std::uint32_t i = 0; i < 2; ++i) {
      const auto& rest = scene.graph.levels()[i].vertices;
      const std::vector<glm::dvec3> expected = deformed(list, cube, i, rest);
      const auto found = device::download<glm::vec3>(scene.device.context, scene.simulation.level(i).vertices);
      double worst = 0;
      for (std::size_t v = 0; v < found.size(); ++v) {
        worst = std::max(worst, glm::distance(glm::dvec3(found[v]), expected[v]));
      }
      // Bounds are shares of the diagonal; in a list each deformer multiplies the rounding of those before it.
      CHECK(worst < (list.size() > 1 ? 1e-5 : 1e-6) * glm::length(cube.high));
    }
  }
}

// One device and its pipelines serve every method.
TEST_CASE(
    "put back a body answers bit for bit as before, moved rigidly to 1e-5, stretched as one whose vertices were set") {
  const std::vector<Deformer> bend = {
      {.kind = DeformerKind::bend, .axis = {1, 0, 0}, .towards = {0, 1, 0}, .degrees = 20}};
  const std::vector<Deformer> stretch = {{.kind = DeformerKind::stretch, .factor = 1.8},
                                         {.kind = DeformerKind::taper, .axis = {1, 0, 0}, .factor = 0.7}};
  const Deformer motion{.kind = DeformerKind::transform, .axis = {1, 2, -1}, .degrees = 130, .translate = {5, -9, 30}};
  const Deformer none{.kind = DeformerKind::twist, .degrees = 0};
  for (const Method method : {Method::fem, Method::quadgraph_fv}) {
    CAPTURE(name_of(method));
    const bool fem = method == Method::fem;
    Slabs body;
    const auto solved = [&] {
      const SolveReport report = body.solve(method);
      CHECK(report.deformed == "");
      return body.simulation.surface_field();
    };
    const SurfaceField rest = solved();
    body.deform(bend);
    CHECK(relative_difference(solved().exitance, rest.exitance) > 1e-2);
    CHECK(pass_count(body.simulation, "exchange rays") == 1);
    body.deform({});
    const SurfaceField again = solved();
    CHECK(same_bits(again.exitance, rest.exitance));
    CHECK(same_bits(again.position, rest.position));

    // The second time with a deformer that is not known to be rigid, so that all is measured anew.
    for (const auto& list : {std::vector{motion}, std::vector{motion, none}}) {
      if (!fem && list.size() == 1) continue;
      body.deform(list);
      body.down = turned_by(motion, {0, -1, 0}, body.box);
      CHECK(relative_difference(solved().exitance, rest.exitance) < 1e-5);
      CHECK(pass_count(body.simulation, "exchange rays") == list.size() - 1);  // what faces see turns with them
    }

    body.down = {0, -1, 0};
    body.deform(stretch);
    const SurfaceField found = solved();
    for (std::uint32_t i = 0; i < 2; ++i) {
      const auto moved = deformed(stretch, body.box, i, body.graph.levels()[i].vertices);
      body.simulation.set_vertices(i, std::vector<glm::vec3>(moved.begin(), moved.end()));
    }
    const SurfaceField expected = solved();
    CHECK(relative_difference(found.position, expected.position) < 1e-6);
    CHECK(relative_difference(found.exitance, expected.exitance) < 1e-5);
    if (!fem) continue;
    body.deform({});  // what was set is gone
    CHECK(same_bits(solved().exitance, rest.exitance));
  }
}

TEST_CASE("tets turned inside out or pressed flat are counted, and the answer is finite") {
  const Deformer flat{.kind = DeformerKind::lattice, .size = {1, 2, 1}, .displacements = {{0, 0, 0}, {0, -10, 0}}};
  const Deformer none{.kind = DeformerKind::twist, .degrees = 0};
  const Deformer wild{.kind = DeformerKind::twist, .begin = 0.3, .end = 0.7, .degrees = 2000};
  for (const Method method : {Method::fem, Method::quadgraph_fv}) {
    Scene scene({6, 2});
    scene.simulation.set_material(homogeneous());
    scene.light(one_side);
    const auto exitance = [&] {
      scene.simulation.solve({.method = method, .model = Model::diffusion});
      return scene.simulation.surface_field().exitance;
    };
    const std::vector<glm::vec3> rest = exitance();
    for (const auto& list : {std::vector{wild}, std::vector{flat}, std::vector{none}}) {
      if (method != Method::fem && list[0] == flat) continue;  // conjugate gradients overflow, and say so
      CAPTURE(name_of(method));
      CAPTURE(name_of(list[0].kind));
      scene.simulation.set_deformation(list, cube);
      const SolveReport report = scene.simulation.solve({.method = method, .model = Model::diffusion});
      const SurfaceField field = scene.simulation.surface_field();
      CHECK(finite(field.exitance));
      CHECK(finite(field.phi));
      CHECK(finite(field.unscattered));
      const bool whole = list[0] == none;
      CHECK(report.deformed.empty() == whole);
      if (list[0] == wild) {
        std::uint32_t inverted = 0;
        const auto moved = deformed(list, cube, 0, scene.graph.levels()[0].vertices);
        for (const glm::uvec4& t : scene.graph.levels()[0].tets) {
          const glm::dvec3 p = moved[t.x];
          inverted += glm::dot(moved[t.y] - p, glm::cross(moved[t.z] - p, moved[t.w] - p)) <= 0;
        }
        CHECK(inverted > 100);
        CHECK(report.deformed.find(std::to_string(inverted) + " of ") == 0);
      }
      for (int c = 0; c < 3; ++c) CHECK(std::abs(report.energy.balance()[c]) < 5e-3);
    }
    // Also after shapes for which operators were made again, in single precision.
    scene.simulation.set_deformation({}, cube);
    CHECK(same_bits(exitance(), rest));
  }
}
