// The facade with a deformation: display mesh, bounds, lights and picture follow.
#include "engine/deform/deform.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/base/error.h"
#include "engine/render/display/display_motion.h"
#include "engine/render/engine.h"
#include "tests/cpp/fixtures/checked_context.h"
#include "tests/cpp/fixtures/checked_engine.h"
#include "tests/cpp/fixtures/engine_work.h"
#include "tests/cpp/fixtures/render_shapes.h"

using namespace quadgraph;

namespace {

constexpr const char* material = "marble,pattern=veins,second_sigma_s_prime=1,second_sigma_a=.5,period=1,sharpness=2";

struct Checked : CheckedEngine {
  Picture picture(const View& view = {}) {
    engine.solve();
    // Facets of a rough surface are drawn anew where it turns.
    return engine.render(view, {.width = 48, .height = 48, .transmission_roughness = 0.0f});
  }
};

double difference(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double off = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    off += std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    size += std::abs(static_cast<double>(b[i]));
  }
  return off / size;
}

Deformer about_y(double degrees) {
  return {.kind = DeformerKind::transform, .degrees = degrees};
}

// A display mesh alone on the device.
struct Alone {
  CheckedContext device;
  Shape shape = sphere({1, 2, 3}, 5, 5);
  DisplayMesh mesh{shape.vertices, shape.normals, shape.faces, {}, {}};
  DisplayBuffers buffers = upload_display(device.context, mesh);
  DisplayMotion motion{mesh};
  Workspace work{device.context, 1024};

  void move(const std::vector<Deformer>& list) {
    motion.record(work, list, buffers);
    work.recorder.submit();
  }
};

}  // namespace

TEST_CASE("normals of the display are carried by the inverse transpose, and are those of the file at rest") {
  Alone alone;
  const Deformer scale{.kind = DeformerKind::transform, .axis = {1, 1, 0}, .degrees = 50, .scale = {1, 3, 0.5}};
  const Deformer bend{.kind = DeformerKind::bend, .degrees = 100};
  for (const std::vector<Deformer>& list : {std::vector{scale}, std::vector{bend}, std::vector{bend, scale}}) {
    alone.move(list);
    const auto found = device::download<glm::vec3>(alone.device.context, alone.buffers.normals);
    double worst = 0;
    for (std::size_t v = 0; v < found.size(); ++v) {
      const glm::dvec3 p(alone.shape.vertices[v]), n(alone.shape.normals[v]);
      const glm::dvec3 u = glm::normalize(glm::cross(n, glm::dvec3(0.3, 0.5, 0.7))), w = glm::cross(n, u);
      std::vector<glm::vec3> around;
      for (const glm::dvec3& d : {u, -u, w, -w}) around.emplace_back(p + 1e-2 * d);
      const auto moved = deformed(list, alone.motion.rest_box(), {}, around);
      const glm::dvec3 expected = glm::normalize(glm::cross(moved[0] - moved[1], moved[2] - moved[3]));
      worst = std::max(worst, glm::length(glm::cross(glm::dvec3(found[v]), expected)));
      if (glm::dot(glm::dvec3(found[v]), expected) < 0) worst = 2;
    }
    CHECK(worst < 0.06);  // faces are .05 wide
    const Sphere expected = bounding_sphere(device::download<glm::vec3>(alone.device.context, alone.buffers.vertices));
    CHECK(glm::distance(alone.motion.bounds().centre, expected.centre) < 1e-4f);
    CHECK(alone.motion.bounds().radius == doctest::Approx(expected.radius).epsilon(1e-6));
  }
  alone.move({{.kind = DeformerKind::twist, .degrees = 0}});
  const auto rest = device::download<glm::vec3>(alone.device.context, alone.buffers.normals);
  double worst = 0;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    worst = std::max<double>(worst, glm::distance(rest[v], alone.shape.normals[v]));
  }
  CHECK(worst < 1e-6);
  alone.move({});
  CHECK(device::download<glm::vec3>(alone.device.context, alone.buffers.normals) == alone.shape.normals);
}

TEST_CASE("a body turned with its lights and its camera looks as before, and put back it is the same") {
  Checked checked;
  Engine& engine = checked.engine;
  engine.set_material(material);
  engine.set_lights({parse_light("directional:0,-1,-1:1"), parse_light("ambient:.1")});
  const Picture rest = checked.picture({.azimuth = 20});
  const auto exitance = engine.surface_field().exitance;
  engine.set_deformation(std::vector{about_y(90)});
  engine.set_lights({parse_light("directional:-1,-1,0:1"), parse_light("ambient:.1")});
  const Picture turned = checked.picture({.azimuth = 110});
  CHECK(difference(turned.scattered, rest.scattered) < 2e-3);
  CHECK(difference(turned.specular, rest.specular) < 2e-3);
  engine.set_deformation({});
  engine.set_lights({parse_light("directional:0,-1,-1:1"), parse_light("ambient:.1")});
  const Picture again = checked.picture({.azimuth = 20});
  CHECK(again.scattered == rest.scattered);
  CHECK(again.specular == rest.specular);
  CHECK(engine.surface_field().exitance == exitance);
}

TEST_CASE("what is shown and what is solved on stay together, and bounds and shadows follow them") {
  Checked checked;
  Engine& engine = checked.engine;
  engine.set_material(material);
  engine.set_lights({parse_light("directional:0,-1,0:1")});
  const float radius = engine.bounds().radius;
  const SolveReport before = engine.solve();
  const std::vector<Deformer> list = {{.kind = DeformerKind::stretch, .axis = {1, 0, 0}, .factor = 2},
                                      {.kind = DeformerKind::twist, .axis = {1, 0, 0}, .degrees = 90}};
  engine.set_deformation(list);
  CHECK_THROWS_AS(engine.render({}), InputError);  // not solved yet
  const SolveReport after = engine.solve();
  CHECK(engine.bounds().radius > 1.3f * radius);
  CHECK(after.energy.entered.x > 1.3 * before.energy.entered.x);
  const DisplayMesh& mesh = engine.graph().display();
  const Level& level = engine.graph().levels()[0];
  const auto shown = deformed(list, rest_box(mesh.vertices), {}, mesh.vertices);
  const auto solved = device::download<glm::vec3>(engine.device(), engine.simulation().level(0).vertices);
  double worst = 0;
  for (std::size_t v = 0; v < shown.size(); ++v) {
    glm::dvec3 on_face(0);
    for (int k = 0; k < 3; ++k) {
      on_face += static_cast<double>(mesh.barycentric[v][k]) * glm::dvec3(solved[level.faces[mesh.face[v]][k]]);
    }
    worst = std::max(worst, glm::distance(shown[v], on_face));
  }
  CHECK(worst < 1e-5);
  const Metadata metadata = engine.metadata();
  const auto said =
      std::find(metadata.begin(), metadata.end(), Metadata::value_type("deformation", "stretch x 2, twist 90 degrees"));
  CHECK(said != metadata.end());
  const auto passes = engine.passes();
  for (const char* name : {"deform", "tet quality", "display normals", "bounds"}) {
    CHECK(std::any_of(passes.begin(), passes.end(), [&](const PassStats& pass) { return pass.name == name; }));
  }
  engine.solve();
  for (const PassStats& pass : engine.passes()) CHECK(pass.name != "deform");  // nothing has moved since
}

TEST_CASE("shapes displace display and levels alike, and those of another body are refused") {
  Checked checked;
  Engine& engine = checked.engine;
  engine.set_material(material);
  engine.set_lights({parse_light("directional:0,0,-1:1")});
  const auto same_for_all = [](std::size_t count, const glm::vec3& d) { return std::vector<glm::vec3>(count, d); };
  Shapes shapes;
  for (const glm::vec3& d : {glm::vec3(1, 0, 0), glm::vec3(0, 4, 0)}) {
    shapes.display.push_back(same_for_all(engine.graph().display().vertices.size(), d));
    shapes.levels.resize(engine.graph().levels().size());
    for (std::size_t i = 0; i < shapes.levels.size(); ++i) {
      shapes.levels[i].push_back(same_for_all(engine.graph().levels()[i].vertices.size(), d));
    }
  }
  Deformer displaced{.kind = DeformerKind::displaced, .shapes = std::make_shared<Shapes>(shapes), .weights = {2, 0.25}};
  const glm::vec3 centre = engine.bounds().centre;
  engine.set_deformation(std::span(&displaced, 1));
  CHECK(glm::distance(engine.bounds().centre, centre + glm::vec3(2, 1, 0)) < 1e-5f);
  const glm::vec3 vertex = engine.graph().levels()[1].vertices[2];
  CHECK(glm::distance(device::download<glm::vec3>(engine.device(), engine.simulation().level(1).vertices)[2],
                      vertex + glm::vec3(2, 1, 0)) < 1e-5f);
  shapes.levels[1][1].pop_back();
  displaced.shapes = std::make_shared<Shapes>(shapes);
  CHECK_THROWS_WITH_AS(engine.set_deformation(std::span(&displaced, 1)), doctest::Contains("another body"), InputError);
}

TEST_CASE("below a sky a body that is bent gets the light of its present shape, in motion when its last row is there") {
  const WorkFolder folder;
  Engine engine(folder.slabs(), test_device());
  engine.set_material("marble");
  const std::vector lights{parse_light("ambient:1"), parse_light("environment:" + folder.sky() + ":0:1")};
  const auto light = [&](const SolveOptions& options) {
    engine.solve(options);
    return device::download<glm::vec3>(engine.device(), engine.simulation().level(0).q);
  };
  const auto light_anew = [&] {
    engine.set_lights(lights);
    return light({.inter_reflection = false});
  };
  engine.set_lights(lights);
  light({.inter_reflection = false});
  const std::vector<Deformer> bent{{.kind = DeformerKind::bend, .degrees = 120}};
  engine.set_deformation(bent);
  const auto at_once = light({.inter_reflection = false});
  CHECK((at_once == light_anew()));
  engine.set_deformation({});
  light({.inter_reflection = false});
  engine.set_deformation(bent);
  SolveOptions few{.inter_reflection = false, .exchange_rows = 5};
  const auto lagging = light(few);
  CHECK((lagging != at_once));
  std::vector<glm::vec3> last = lagging;
  for (int frame = 0; frame < 100 && last != at_once; ++frame) last = light(few);
  CHECK((last == at_once));
}
