// Derivatives of what a body answers: against differences (Taylor), forward against adjoint, and the answer itself
// against the reference; on slivers, at jumps of the coefficients, and where a body sees itself.
#include "engine/derivative/forward_model.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <thread>

#include "engine/file/geometry.h"
#include "engine/reference/entering.h"
#include "engine/reference/exchange.h"
#include "engine/reference/radiance.h"
#include "engine/reference/row_solver.h"
#include "tests/cpp/fixtures/graph_cases.h"
#include "tests/cpp/fixtures/seeing_levels.h"
#include "tests/cpp/fixtures/test_data.h"

using namespace quadgraph;

namespace {

using Vectors = std::vector<glm::dvec3>;

// Inner vertices moved by nearly half a cell, then squeezed to a fifth: slivers.
OwnedLevel slivers() {
  OwnedLevel level = box_level(3, 4.0f, 0.45f);
  for (auto* points : {&level.vertices, &level.nodes}) {
    for (glm::vec3& p : *points) p.z *= 0.2f;
  }
  return level;
}

OwnedLevel seeing() {
  OwnedLevel level = facing_plates(2, 4.0f, 1.5f, 1.0f);
  see(level, 64);
  return level;
}

struct Body {
  const char* name;
  OwnedLevel level;
};

std::vector<Body> bodies() {
  return {{"slivers", slivers()}, {"plates", seeing()}};
}

// Coefficients that jump by a factor of eight between neighbouring octants, and differ by tet and channel beside it.
Parameters jumping(const Level& level, std::size_t lights, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> near(0.8, 1.25);
  Parameters at(level.tets.size(), lights);
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    const glm::vec3& p = level.nodes[t];
    const bool dense = std::sin(1.7f * p.x) * std::sin(1.3f * p.y) > 0;
    for (int c = 0; c < 3; ++c) {
      at.scattering[t][c] = (dense ? 2.4 : 0.3) * near(random);
      at.absorption[t][c] = (dense ? 0.01 : 0.08) * (c + 1) * near(random);
    }
  }
  for (glm::dvec3& power : at.power) power = {near(random), near(random), near(random)};
  return at;
}

// Relative changes at random.
Parameters direction(const Parameters& at, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Parameters along = at;
  for (Vectors* values : {&along.scattering, &along.absorption, &along.power}) {
    for (glm::dvec3& value : *values) value *= glm::dvec3(normal(random), normal(random), normal(random));
  }
  return along;
}

Parameters moved(const Parameters& at, const Parameters& along, double h) {
  Parameters to = at;
  for (std::size_t t = 0; t < at.scattering.size(); ++t) {
    to.scattering[t] += h * along.scattering[t];
    to.absorption[t] += h * along.absorption[t];
  }
  for (std::size_t l = 0; l < at.power.size(); ++l) to.power[l] += h * along.power[l];
  return to;
}

double product(const Vectors& a, const Vectors& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i], b[i]);
  return sum;
}

double product(const Outgoing& a, const Outgoing& b) {
  return product(a.exitance, b.exitance) + product(a.unscattered, b.unscattered) + product(a.radiance, b.radiance);
}

double product(const Parameters& a, const Parameters& b) {
  return product(a.scattering, b.scattering) + product(a.absorption, b.absorption) + product(a.power, b.power);
}

double square(const Vectors& to, const Vectors& from, const Vectors& slope, double h) {
  double sum = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const glm::dvec3 rest = to[i] - from[i] - h * slope[i];
    sum += glm::dot(rest, rest);
  }
  return sum;
}

// |to - from - h slope|
double rest(const Outgoing& to, const Outgoing& from, const Outgoing& slope, double h) {
  return std::sqrt(square(to.exitance, from.exitance, slope.exitance, h) +
                   square(to.unscattered, from.unscattered, slope.unscattered, h) +
                   square(to.radiance, from.radiance, slope.radiance, h));
}

// From every face, at an angle that differs from face to face.
std::vector<ViewSample> views(const Level& level) {
  std::vector<ViewSample> samples;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const FaceFrame frame = frame_of(level, f);
    const glm::dvec3 along = glm::normalize(frame.corners[1] - frame.corners[0]);
    samples.push_back({f, {0.5, 0.3, 0.2}, glm::normalize(frame.normal + (0.1 + 0.3 * (f % 4)) * along)});
  }
  return samples;
}

// As the reference solves it.
std::vector<Field> fluence(const Level& level, const Problem& problem, std::span<const BeamLight> lights) {
  std::vector<glm::dvec3> scattered(level.vertices.size(), glm::dvec3(0));
  for (const BeamLight& light : lights) {
    const WalkResult walked = walk_source(level, problem, light.beam, light.quarters);
    for (std::size_t v = 0; v < scattered.size(); ++v) scattered[v] += walked.scattered[v];
  }
  SolveOptions usual = reference_options();
  usual.model = problem.model;
  LevelReport report;
  return solve_rows(assemble(level, problem), buried_load(level, problem, scattered), usual, report);
}

// A beam at an angle, a point of light near the body, and even light.
struct Lights {
  explicit Lights(const Level& level) {
    for (const glm::vec3& q : one_side(level)) oblique.push_back({q, 0.9f * q, 1.1f * q, q});
    for (std::size_t f = 0; f < level.faces.size(); ++f) {
      const glm::vec3 q(f % 3 == 0 ? 0.5f : 0.0f, 0.3f, f % 2 == 0 ? 0.2f : 0.4f);
      uneven.push_back({q, 0.5f * q, 2.0f * q, q});
      even.push_back({glm::vec3(0.4f), glm::vec3(0.4f), glm::vec3(0.4f), glm::vec3(0.4f)});
    }
    beams = {{{gpu::BEAM_DIRECTIONAL, glm::normalize(glm::vec3(1, 0.3f, 0.2f)), {}, {}}, oblique},
             {{gpu::BEAM_POINT, glm::vec3(-3, 9, 4), {}, {}}, uneven},
             {{gpu::BEAM_LAMBERTIAN, {}, {}, {}}, even}};
  }

  std::vector<Quarters> oblique, uneven, even;
  std::vector<BeamLight> beams;
};

}  // namespace

TEST_CASE("what is left of a Taylor step falls with its square, each term on and off") {
  std::vector<std::string> terms = {"all", "scattering", "absorption", "power"};
  if (sanitized) terms.resize(1);
  for (const Body& body : bodies()) {
    const Level level = body.level.view();
    const Lights lights(level);
    for (const Model model : both_models) {
      for (const bool bounces : {false, true}) {
        const ForwardOptions options = {.model = model, .eta = 1.3, .bounces = bounces, .tolerance = 1e-14};
        const Parameters at = jumping(level, 3, 1);
        const ForwardModel here(level, at, lights.beams, views(level), options);
        for (const std::string& term : terms) {
          Parameters along = direction(at, 2);
          if (term == "absorption" || term == "power") along.scattering.assign(along.scattering.size(), glm::dvec3(0));
          if (term == "scattering" || term == "power") along.absorption.assign(along.absorption.size(), glm::dvec3(0));
          if (term != "all" && term != "power") along.power.assign(3, glm::dvec3(0));
          const Outgoing slope = here.tangent(along);
          std::vector<double> rests;
          for (const double h : {0.004, 0.001, 0.00025}) {
            const ForwardModel there(level, moved(at, along, h), lights.beams, views(level), options);
            rests.push_back(rest(there.outgoing(), here.outgoing(), slope, h));
          }
          INFO(std::string(body.name), " ", static_cast<int>(model), bounces, " ", term);
          // Exitance is linear in it, unless the normalised bounces mix lights; radiance between vertices is not.
          if (term == "power" && !bounces) {
            const ForwardModel there(level, moved(at, along, 0.5), lights.beams, {}, options);
            CHECK(square(there.outgoing().exitance, here.outgoing().exitance, slope.exitance, 0.5) <=
                  1e-24 * product(here.outgoing().exitance, here.outgoing().exitance));
          }
          for (std::size_t i = 1; i < rests.size(); ++i) {
            CHECK(std::abs(rests[i - 1] / rests[i] - 16) <= 0.08);
          }
        }
      }
    }
  }
}

TEST_CASE("forward and adjoint derivatives are each other's transpose") {
  for (const Body& body : bodies()) {
    const Level level = body.level.view();
    const Lights lights(level);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    Outgoing weights(level.faces.size(), level.faces.size());
    for (Vectors* values : {&weights.exitance, &weights.unscattered, &weights.radiance}) {
      for (glm::dvec3& value : *values) value = {normal(random), normal(random), normal(random)};
    }
    for (const Model model : both_models) {
      for (const bool bounces : {false, true}) {
        for (const double eta : {1.0, 1.4}) {
          if (sanitized && (eta == 1) != bounces) continue;
          const ForwardOptions options = {.model = model, .eta = eta, .bounces = bounces, .tolerance = 1e-15};
          const Parameters at = jumping(level, 3, 4);
          const Parameters along = direction(at, 5);
          const ForwardModel here(level, at, lights.beams, views(level), options);
          const Outgoing change = here.tangent(along);
          const Parameters gradient = here.adjoint(weights);
          const double size = std::sqrt(product(change, change) * product(weights, weights));
          INFO(std::string(body.name), " ", static_cast<int>(model), bounces, " ", eta);
          CHECK(std::abs(product(change, weights) - product(gradient, along)) <= 1e-12 * size);
        }
      }
    }
  }
}

TEST_CASE("the answer that is differentiated is the reference's") {
  for (const Body& body : bodies()) {
    const Level level = body.level.view();
    const Lights lights(level);
    const std::vector<glm::vec3> q = one_side(level);
    const gpu::BeamRecord& beam = lights.beams[0].beam;
    std::vector<Quarters> quarters;
    for (const glm::vec3& value : q) quarters.push_back({value, value, value, value});
    for (const Model model : both_models) {
      Parameters at = jumping(level, 1, 6);
      at.power[0] = glm::dvec3(1);
      Opticals optical(level.nodes.size());
      for (std::size_t t = 0; t < at.scattering.size(); ++t) {
        optical[t] = {glm::vec3(at.scattering[t]), glm::vec3(at.absorption[t])};
        at.scattering[t] = glm::dvec3(optical[t].sigma_s_prime);
        at.absorption[t] = glm::dvec3(optical[t].sigma_a);
      }
      SolveOptions usual = reference_options();
      usual.model = model;
      const std::vector<EnteringLight> entering = {{beam, q}};
      const BouncedSolution expected = solve_with_bounces(level, optical, 1.3, entering, usual);
      const ForwardModel found(level, at, {{beam, quarters}}, {}, {.model = model, .eta = 1.3});
      // Its rays go on where the reference's end, with no more than WALK_END of what entered.
      glm::dvec3 entered(0), scattered(0), clear(0);
      for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        const double area = face_area(level, level.faces[f]);
        entered += area * glm::dvec3(q[f]);
        scattered += area * glm::abs(found.outgoing().exitance[f] - expected.solution.flux[f]);
        clear += area * glm::abs(found.outgoing().unscattered[f] - expected.solution.unscattered[f]);
      }
      for (int c = 0; c < 3; ++c) {
        CHECK(scattered[c] <= double{gpu::WALK_END} * entered[c]);
        CHECK(clear[c] <= double{gpu::WALK_END} * entered[c]);
      }
    }
  }
}

TEST_CASE("the radiance that is differentiated is the reference's, of one light and of several") {
  for (const Body& body : bodies()) {
    const Level level = body.level.view();
    const Lights lights(level);
    Parameters at = jumping(level, 3, 7);
    at.power.assign(3, glm::dvec3(1));
    Opticals optical(level.nodes.size());
    for (std::size_t t = 0; t < at.scattering.size(); ++t) {
      optical[t] = {glm::vec3(at.scattering[t]), glm::vec3(at.absorption[t])};
      at.scattering[t] = glm::dvec3(optical[t].sigma_s_prime);
      at.absorption[t] = glm::dvec3(optical[t].sigma_a);
    }
    const Problem problem{Method::fem, Source::buried, Model::sp3, optical, 1.3};
    const ForwardOptions options = {.eta = 1.3, .bounces = false};
    const std::vector<ViewSample> samples = views(level);
    const ForwardModel found(level, at, lights.beams, samples, options);
    const std::vector<Field> x = fluence(level, problem, lights.beams);
    Vectors phi;
    for (const Field& value : x) phi.push_back(value.phi);
    const Uncollided fields = uncollided(level, problem, lights.beams, vertex_starts(level));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const glm::dvec3 expected =
          gathered_radiance(level, problem, {phi, fields}, samples[i].face, samples[i].barycentric, samples[i].outside);
      // The reference's rays end where a hundredth of the light behind is left, as if all behind were as there.
      CHECK(glm::distance(found.outgoing().radiance[i], expected) <= 0.02 * glm::length(expected));
    }
  }
}

TEST_CASE("a clear tet that begins to scatter or to absorb") {
  const OwnedLevel owned = box_level(3, 3.0f, 0.2f);
  const Level level = owned.view();
  const Lights lights(level);
  Parameters at = jumping(level, 3, 8), along(level.tets.size(), 3);
  for (std::size_t t = 0; t < level.tets.size(); t += 3) {
    at.scattering[t] = at.absorption[t] = glm::dvec3(0);
    along.scattering[t] = glm::dvec3(1, 0, 1);
    along.absorption[t] = glm::dvec3(0, 1, 1);
  }
  const ForwardOptions options = {.eta = 1.3, .tolerance = 1e-14};
  const ForwardModel here(level, at, lights.beams, views(level), options);
  const Outgoing slope = here.tangent(along);
  constexpr double h = 1e-5;
  const ForwardModel there(level, moved(at, along, h), lights.beams, views(level), options);
  CHECK(rest(there.outgoing(), here.outgoing(), slope, h) <= 1e-4 * h * std::sqrt(product(slope, slope)));
  const Outgoing& weights = here.outgoing();
  CHECK(product(here.adjoint(weights), along) == doctest::Approx(product(weights, slope)).epsilon(1e-10));
}

TEST_CASE("where less light arrives than a number can be, derivatives are numbers and each other's transpose") {
  const OwnedLevel owned = box_level(3, 3.0f, 0.2f);
  const Level level = owned.view();
  const Lights lights(level);
  for (const double dense : {800.0, 3000.0}) {
    Parameters at = jumping(level, 3, 8);
    for (std::size_t t = 0; t < level.tets.size(); ++t) at.scattering[t] = glm::dvec3(dense, t % 2 == 0 ? dense : 1, 1);
    const ForwardModel here(level, at, lights.beams, views(level), {.eta = 1.3, .tolerance = 1e-14});
    Outgoing weights(level.faces.size(), level.faces.size());
    for (Vectors* values : {&weights.exitance, &weights.unscattered, &weights.radiance}) {
      values->assign(values->size(), glm::dvec3(1));
    }
    const Parameters along = direction(at, 5), gradient = here.adjoint(weights);
    const Outgoing change = here.tangent(along);
    const double forward = product(change, weights), back = product(gradient, along);
    CAPTURE(dense);
    CHECK(std::isfinite(forward));
    CHECK(back == doctest::Approx(forward).epsilon(1e-9));
  }
}

TEST_CASE("threads that ask one model at a time get what one gets alone") {
  const OwnedLevel owned = seeing();
  const Level level = owned.view();
  const Lights lights(level);
  const ForwardModel model(level, jumping(level, 3, 1), lights.beams, views(level), {.eta = 1.3});
  Outgoing weights(level.faces.size(), level.faces.size());
  weights.exitance.assign(weights.exitance.size(), glm::dvec3(1));
  const Parameters alone = model.adjoint(weights);
  std::array<Parameters, 4> found;
  {
    std::vector<std::jthread> threads;
    for (Parameters& each : found) threads.emplace_back([&] { each = model.adjoint(weights); });
  }
  for (const Parameters& each : found) {
    CHECK(each.absorption == alone.absorption);
    CHECK(each.scattering == alone.scattering);
  }
}

TEST_CASE("wrong sizes and values are refused by name") {
  const OwnedLevel owned = box_level(2, 2.0f);
  const Level level = owned.view();
  const Lights lights(level);
  const Parameters at = jumping(level, 3, 1);
  Parameters few = at, negative = at;
  few.absorption.pop_back();
  negative.scattering[3].y = -1;
  CHECK_THROWS_WITH(ForwardModel(level, few, lights.beams, {}, {}), doctest::Contains("sigma_a: 47 entries"));
  CHECK_THROWS_WITH(ForwardModel(level, negative, lights.beams, {}, {}), doctest::Contains("sigma_s_prime[3]: -1"));
  CHECK_THROWS_WITH(ForwardModel(level, at, {}, {}, {}), doctest::Contains("power: 3 entries"));
  const ForwardModel model(level, at, lights.beams, {}, {});
  CHECK_THROWS_WITH(model.tangent(few), doctest::Contains("sigma_a: 47 entries"));
  CHECK_THROWS_WITH(model.adjoint(Outgoing(1, 0)), doctest::Contains("exitance: 1 entries"));
  const auto refused = [&](const ViewSample& sample) { ForwardModel(level, at, lights.beams, {sample}, {}); };
  const glm::dvec3 out = frame_of(level, 0).normal, third(1.0 / 3);
  CHECK_THROWS_WITH(refused({0, third, 2.0 * out}), doctest::Contains("samples[0]: a direction of length 2"));
  CHECK_THROWS_WITH(refused({0, {1, 1, -1}, out}), doctest::Contains("samples[0]: barycentric 1"));
  CHECK_THROWS_WITH(refused({0, third, -out}), doctest::Contains("samples[0]: a direction into the body"));
  Parameters dense = at;
  dense.absorption[2].z = 2e6;
  CHECK_THROWS_WITH(ForwardModel(level, dense, lights.beams, {}, {}), doctest::Contains("sigma_a[2]: 2000000"));
}
