// The transport correction: equilibrium, where the answer is known at every place; what does not depend on the start;
// power; and what the samples say of themselves.
#include <cmath>
#include <map>
#include <tuple>

#include "engine/base/error.h"
#include "engine/devices/open_device.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/solved_body.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

gpu::Material thin(float sigma_a, float eta) {
  gpu::Material material{};
  material.sigma_s_prime = {0.1f, 0.3f, 1.0f};
  material.sigma_a = glm::vec3(sigma_a);
  material.eta = eta;
  return material;
}

SolveOptions swept(std::uint32_t sweeps, Model model = Model::sp3) {
  return {.model = model, .tolerance = 1e-5, .correction = sweeps > 0, .sweeps = sweeps};
}

double worst(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Largest relative difference of all that leaves one side of the box from what enters it.
double off_equilibrium(const SurfaceField& field, const glm::vec3& q) {
  std::map<std::tuple<long, long, long>, std::pair<double, glm::dvec3>> sides;  // area and power by normal
  for (std::size_t f = 0; f < field.area.size(); ++f) {
    const glm::vec3& n = field.normal[f];
    auto& [area, power] = sides[{std::lround(n.x), std::lround(n.y), std::lround(n.z)}];
    area += double{field.area[f]};
    power += double{field.area[f]} * (glm::dvec3(field.exitance[f]) + glm::dvec3(field.unscattered[f]));
  }
  CHECK(sides.size() == 6);
  double largest = 0;
  for (const auto& [normal, side] : sides) {
    largest = std::max(largest, worst(side.second / side.first / glm::dvec3(q) - 1.0));
  }
  return largest;
}

}  // namespace

TEST_CASE("where nothing is absorbed, uniform light leaves every side as it came, whatever the index") {
  for (const float eta : {1.0f, 1.4f}) {
    CAPTURE(eta);
    Scene scene({8, 4});
    scene.simulation.set_material(thin(0, eta));
    const glm::vec3 q(1.0f, 0.8f, 0.6f);
    scene.light([&](const glm::vec3&) { return q; });
    const auto off = [&](std::uint32_t sweeps) {
      scene.simulation.solve(swept(sweeps));
      return off_equilibrium(scene.simulation.surface_field(), q);
    };
    // The solve is exact here, but for what the few rays of the light that enters leave unscattered.
    const double before = off(0);
    CHECK(before < 0.02);
    CHECK(off(2) < before + 0.01);
  }
}

TEST_CASE("the corrected exitance does not depend on the model that it starts from, and power is kept") {
  Scene scene({8, 4});
  for (const bool varied : {false, true}) {
    CAPTURE(varied);
    gpu::Material material = thin(0.1f, 1.3f);
    if (varied) material = veined();
    scene.simulation.set_material(material);
    scene.light(one_side);
    double stated = 0;
    const auto exitance = [&](Model model, std::uint32_t sweeps) {
      const SolveReport report = scene.simulation.solve(swept(sweeps, model));
      CHECK(worst(report.energy.balance()) < (sweeps > 0 ? 0.005 : 1e-4));
      if (sweeps > 0) stated = std::hypot(stated, report.error->whole);
      return scene.simulation.surface_field().exitance;
    };
    const double before = relative_difference(exitance(Model::diffusion, 0), exitance(Model::sp3, 0));
    const double after = relative_difference(exitance(Model::diffusion, 3), exitance(Model::sp3, 3));
    CHECK(after < 0.015);
    CHECK(after < stated);
    CHECK(before > 0.05);
  }
}

TEST_CASE("a correction repeats bit for bit, and leaves the solve that it starts from as it was") {
  Scene scene({6, 3});
  scene.simulation.set_material(homogeneous());
  scene.light(one_side);
  for (const Model model : {Model::diffusion, Model::sp3}) {
    scene.simulation.solve(swept(0, model));
    const auto plain = scene.simulation.surface_field().exitance;
    scene.simulation.solve(swept(1, model));
    const auto once = scene.simulation.surface_field().exitance;
    scene.simulation.solve(swept(1, model));
    CHECK(scene.simulation.surface_field().exitance == once);
    CHECK(once != plain);
    SolveOptions warm = swept(0, model);
    warm.warm = true;
    CHECK(scene.simulation.solve(warm).levels.back().iterations <= 1);
    CHECK(relative_difference(scene.simulation.surface_field().exitance, plain) < 1e-5);
  }
}

namespace {

// How far the exitance is from that of the body at rest as it is in the last frame of a motion: in that frame, and
// without a correction.
struct Kept {
  double in_motion, uncorrected;
};

// Means of the exitance over the sides of the box as it was baked.
std::vector<glm::vec3> side_means(const Level& rest, const SurfaceField& field) {
  std::map<std::tuple<long, long, long>, std::pair<float, glm::vec3>> sides;  // area and power
  for (std::uint32_t f = 0; f < rest.face_count(); ++f) {
    const glm::vec3& p = rest.nodes[rest.tet_count() + f];
    const auto side = [](float x) { return x <= 1e-4f ? -1L : x >= 10 - 1e-4f ? 1L : 0L; };
    auto& [area, power] = sides[{side(p.x), side(p.y), side(p.z)}];
    area += field.area[f];
    power += field.area[f] * field.exitance[f];
  }
  std::vector<glm::vec3> means;
  for (const auto& [which, side] : sides) means.push_back(side.second / side.first);
  return means;
}

template <typename Move>
Kept kept_in_motion(Scene& scene, std::uint32_t frames, const Move& move) {
  const auto solve = [&](SolveOptions options, bool warm) {
    options.warm = warm;
    scene.simulation.solve(options);
    return side_means(scene.graph.levels()[0], scene.simulation.surface_field());
  };
  SolveOptions quick = swept(1);
  quick.sweep_points = 5000;
  move(0);
  solve(quick, false);
  std::vector<glm::vec3> last;
  for (std::uint32_t k = 1; k <= frames; ++k) {
    move(k);
    last = solve(quick, true);
  }
  SolveOptions exact = swept(3);
  exact.sweep_points = 10000;
  const std::vector<glm::vec3> rest = solve(exact, false);
  return {relative_difference(last, rest), relative_difference(solve(swept(0), false), rest)};
}

}  // namespace

TEST_CASE("in motion the correction follows the light, the material and the shape") {
  Scene scene({8, 4});
  const gpu::Material material = thin(0.1f, 1.3f);
  scene.simulation.set_material(material);
  scene.light(one_side);
  const auto holds = [](const Kept& off) {
    CHECK(off.uncorrected > 0.07);
    CHECK(off.in_motion < 0.015);
  };
  holds(kept_in_motion(scene, 10, [&](std::uint32_t k) {
    const float share = static_cast<float>(k) / 10;
    scene.light([&](const glm::vec3& p) {
      return (1 - share) * one_side(p) + (p.y < 1e-4f ? glm::vec3(share) : glm::vec3(0));
    });
  }));
  holds(kept_in_motion(scene, 10, [&](std::uint32_t k) {
    gpu::Material edited = material;
    edited.sigma_s_prime *= 1 + 0.1f * static_cast<float>(k);
    scene.simulation.set_material(edited);
  }));
  scene.simulation.set_material(material);
  holds(kept_in_motion(scene, 1, [&](std::uint32_t k) {
    gpu::Material other = material;
    other.sigma_s_prime *= k == 0 ? 4.0f : 1.0f;
    scene.simulation.set_material(other);
  }));
  holds(kept_in_motion(scene, 20, [&](std::uint32_t k) {
    for (std::uint32_t i = 0; i < scene.simulation.level_count(); ++i) {
      std::vector<glm::vec3> vertices(scene.graph.levels()[i].vertices.begin(), scene.graph.levels()[i].vertices.end());
      for (glm::vec3& p : vertices) p.y *= 1 + 0.03f * static_cast<float>(k) * p.x / 10;
      scene.simulation.set_vertices(i, vertices);
    }
  }));
}

TEST_CASE("power is kept where a part of it meets the body again, and what returns adds to what leaves") {
  OwnedLevel slabs = facing_slabs(4, 10.0f, 2.0f, 2.0f);
  bake_seen(slabs, 64);
  SolvedBody body(open_device(test_device()), graph_of(std::vector{slabs}));
  body.simulation.set_material(homogeneous());
  body.light();
  const auto solve = [&](bool returning, std::uint32_t sweeps) {
    SolveOptions options = swept(sweeps);
    options.inter_reflection = returning;
    const SolveReport report = body.simulation.solve(options);
    CHECK(worst(report.energy.balance()) < 0.005);
    CHECK((report.correction->returns > 0.02) == returning);
    return report.energy;
  };
  const Energy alone = solve(false, 2);
  CHECK(alone.re_entered == glm::dvec3(0));
  for (const std::uint32_t sweeps : {1u, 3u}) {
    const Energy energy = solve(true, sweeps);
    CHECK(glm::all(glm::greaterThan(energy.re_entered, 0.02 * energy.entered)));
    CHECK(glm::all(glm::greaterThan(energy.scattered_out, alone.scattered_out)));
    CHECK(glm::all(glm::lessThan(energy.scattered_out - alone.scattered_out, energy.re_entered)));
  }
}

TEST_CASE("points are drawn until they leave the noise that is wanted, and the change that is found stays") {
  Scene scene({6, 3});
  scene.simulation.set_material(thin(0.1f, 1.3f));
  scene.light(one_side);
  const auto sweep = [&](std::uint32_t points) {
    SolveOptions options = swept(1);
    options.sweep_points = points;
    return scene.simulation.solve(options).correction->sweeps.at(0);
  };
  const CorrectedSweep few = sweep(1000), many = sweep(200000);
  CHECK(few.points > 2000);
  CHECK(many.points == 200000);
  CHECK(few.change.whole == doctest::Approx(many.change.whole).epsilon(0.1));
  CHECK(few.noise.whole < 1.25 * many.noise.whole);
}

TEST_CASE("of a change that is lost in its noise little is taken, and the power stays that of the sweep") {
  Scene scene({8, 4});
  gpu::Material dense = homogeneous(0.001f);
  dense.sigma_s_prime *= 8;
  scene.simulation.set_material(dense);
  scene.light(one_side);
  const auto solve = [&](const SolveOptions& options) {
    const SolveReport report = scene.simulation.solve(options);
    return std::pair{report, scene.simulation.surface_field().exitance};
  };
  SolveOptions few = swept(1);
  few.sweep_points = 500;
  const auto [plain_report, plain] = solve(swept(0));
  few.sweeps = 0;
  const auto [report, found] = solve(few);
  few.sweeps = static_cast<std::uint32_t>(report.correction->sweeps.size());
  const auto [asked_report, asked] = solve(few);
  CHECK(asked_report.correction->taken.whole == 1);
  const double change = report.correction->changed.whole, noise = report.correction->sweeps.back().noise.whole;
  const double known = change * change - 0.25 * noise * noise;  // the rest may have come about by chance
  CHECK(report.correction->taken.whole == doctest::Approx(known / (known + noise * noise)));
  CHECK(report.correction->taken.whole < 0.9);
  CHECK(relative_difference(found, plain) < relative_difference(asked, plain));
  CHECK(report.model_error->whole < asked_report.model_error->whole);
  for (int c = 0; c < 3; ++c) {
    CHECK(report.energy.scattered_out[c] == doctest::Approx(asked_report.energy.scattered_out[c]).epsilon(1e-5));
  }
}

TEST_CASE("only fem with the buried source can be corrected") {
  Scene scene({4, 2});
  scene.simulation.set_material(homogeneous());
  scene.light(one_side);
  for (const auto& [method, source] :
       {std::pair{Method::quadgraph_fv, Source::buried}, {Method::fem, Source::diffuse}}) {
    SolveOptions options{.method = method, .source = source, .correction = true, .sweeps = 1};
    CHECK_THROWS_AS(scene.simulation.solve(options), InputError);
  }
  SolveOptions none = swept(1);
  none.sweep_points = 0;
  CHECK_THROWS_AS(scene.simulation.solve(none), InputError);
}
