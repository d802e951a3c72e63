// Inter-reflection: what arrives, against closed forms of visibility; the bounces, against their series.
#include "engine/reference/exchange.h"

#include <doctest/doctest.h>

#include <functional>
#include <random>

#include "engine/file/geometry.h"
#include "engine/optics/surface_boundary.h"
#include "tests/cpp/fixtures/graph_cases.h"
#include "tests/cpp/fixtures/seeing_levels.h"
#include "tests/cpp/fixtures/test_data.h"

using namespace quadgraph;

namespace {

const glm::dvec3 unit_light(1.0);

bool inside(const OwnedLevel& level, std::uint32_t f, double radius) {
  return glm::length(corners_of(level, f).centre()) < radius;
}

glm::dvec3 integral(const Level& level, std::span<const glm::dvec3> values) {
  glm::dvec3 sum{0};
  for (std::uint32_t f = 0; f < level.face_count(); ++f) sum += face_area(level, level.faces[f]) * values[f];
  return sum;
}

const OwnedLevel& shell() {
  static const OwnedLevel level = [] {
    OwnedLevel made = shell_level(5.0, 7.0, 3, 2);
    see(made, 64);
    return made;
  }();
  return level;
}

const OwnedLevel& plates() {
  static const OwnedLevel level = [] {
    OwnedLevel made = facing_plates(5, 10.0f, 2.0f, 4.0f);
    see(made, 256);
    return made;
  }();
  return level;
}

bool faces_lower(const OwnedLevel& level, std::uint32_t f) {
  const Corners corners = corners_of(level, f);
  return corners.centre().z > 0 && corners.normal().z < -0.5;
}

bool faces_upper(const OwnedLevel& level, std::uint32_t f) {
  const Corners corners = corners_of(level, f);
  return corners.centre().z < 0 && corners.normal().z > 0.5;
}

// Form factor from an element at (x, y) to the parallel square of `edge` about the origin at distance `gap`.
double point_to_square(double x, double y, double edge, double gap) {
  const auto corner = [](double a, double b) {
    const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
    return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / glm::two_pi<double>();
  };
  const double x0 = (-edge / 2 - x) / gap, x1 = (edge / 2 - x) / gap;
  const double y0 = (-edge / 2 - y) / gap, y1 = (edge / 2 - y) / gap;
  return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

Opticals medium(const Level& level) {
  return Opticals(level.nodes.size(), {glm::vec3(2.0f, 1.0f, 3.0f), glm::vec3(0.01f, 0.05f, 0.2f)});
}

std::vector<glm::vec3> lit(const Level& level, const std::function<bool(std::uint32_t)>& where) {
  std::vector<glm::vec3> q(level.faces.size(), glm::vec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (where(f)) q[f] = {1.0f, 0.8f, 0.6f};
  }
  return q;
}

}  // namespace

TEST_CASE("inside a shell uniform light arrives as it left, and outside none") {
  const Level level = shell().view();
  std::vector<glm::dvec3> radiosity;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    radiosity.push_back(inside(shell(), f, 6) ? glm::dvec3(0.3, 1.0, 7.0) : glm::dvec3(5.0));
  }
  const auto irradiance = received_irradiance(level, radiosity);
  const auto sky = sky_visibility(level);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const bool in = inside(shell(), f, 6);
    CHECK(sky[f] == (in ? 0.0 : 1.0));
    for (int c = 0; c < 3; ++c) CHECK(irradiance[f][c] == doctest::Approx(in ? radiosity[f][c] : 0.0).epsilon(1e-14));
  }
}

TEST_CASE("as much light arrives as left towards the body, however uneven") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(0.0, 1.0);
  for (const OwnedLevel* owned : {&shell(), &plates()}) {
    const Level level = owned->view();
    const auto sky = sky_visibility(level);
    std::vector<glm::dvec3> radiosity, towards;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      radiosity.emplace_back(value(random), 0.0, std::pow(value(random), 8.0));
      towards.push_back((1.0 - sky[f]) * radiosity[f]);
    }
    const auto irradiance = received_irradiance(level, radiosity);
    const glm::dvec3 arrived = integral(level, irradiance), left = integral(level, towards);
    for (int c = 0; c < 3; ++c) CHECK(arrived[c] == doctest::Approx(left[c]).epsilon(1e-13));
    CHECK(arrived.y == 0.0);
    for (const glm::dvec3& e : irradiance) CHECK(glm::all(glm::greaterThanEqual(e, glm::dvec3(0))));
  }
}

TEST_CASE("light from a square arrives at a facing one by the closed form") {
  const Level level = plates().view();
  std::vector<glm::dvec3> radiosity(level.faces.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (faces_upper(plates(), f)) radiosity[f] = unit_light;
  }
  const auto irradiance = received_irradiance(level, radiosity);
  double sum = 0, squares = 0, variance = 0;
  int count = 0;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!faces_lower(plates(), f)) {
      CHECK(irradiance[f].x == 0.0);
      continue;
    }
    const glm::dvec3 at = corners_of(plates(), f).centre();
    const double exact = point_to_square(at.x, at.y, 10, 4);
    sum += irradiance[f].x - exact;
    squares += std::pow(irradiance[f].x - exact, 2);
    variance += exact * (1 - exact) / level.seen_rays;
    ++count;
  }
  REQUIRE(count == 50);
  MESSAGE("RMS error " << std::sqrt(squares / count) << ", random rays would give " << std::sqrt(variance / count));
  CHECK(squares < variance);
  CHECK(std::abs(sum / count) < std::sqrt(variance) / count);
}

TEST_CASE("nothing arrives at reflecting faces") {
  OwnedLevel owned = plates();
  for (std::uint32_t f = 0; f < owned.faces.size(); ++f) {
    owned.face_kinds.push_back(faces_lower(owned, f) && f % 2 == 0 ? face_reflecting : face_open);
  }
  const Level level = owned.view();
  const auto irradiance = received_irradiance(level, std::vector<glm::dvec3>(level.faces.size(), unit_light));
  double least = INFINITY;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) {
      CHECK(irradiance[f].x == 0.0);
    } else if (faces_lower(owned, f)) {
      least = std::min(least, irradiance[f].x);
    }
  }
  CHECK(least > 0.1);
}

TEST_CASE("bounces inside a uniformly lit shell are the geometric series of its reflectance") {
  const Level level = shell().view();
  const auto in = [](std::uint32_t f) { return inside(shell(), f, 6); };
  const auto q = lit(level, in);
  const auto reflectance = [&](const ReferenceSolution& solution) {
    std::vector<glm::dvec3> inner = solution.exitance;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) inner[f] *= in(f) ? 1.0 : 0.0;
    return integral(level, inner) / solution.energy.entered;
  };
  for (const double eta : {1.0, 1.4}) {
    CAPTURE(eta);
    const SolveOptions options = solving(Method::fem, Source::buried, Model::sp3, 1e-7);
    const EnteringLight light = lambertian(q), again{{gpu::BEAM_MEAN, glm::vec3(0), {}, {}}, q};
    const glm::dvec3 first = reflectance(solve_reference(level, medium(level), eta, light, options));
    const glm::dvec3 later = reflectance(solve_reference(level, medium(level), eta, again, options));
    const BouncedSolution bounced = solve_with_bounces(level, medium(level), eta, std::span(&light, 1), options);
    REQUIRE(bounced.converged);
    const glm::dvec3 entered = bounced.solution.energy.entered;
    // E_k = M_0 + (T rho + 1 - T) E_k-1: all light inside comes back inside, entering or reflected.
    const double entering = diffuse_transmittance(eta);
    const glm::dvec3 ratio = 1.0 - entering * (1.0 - later), start = entering * first * entered;
    for (int c = 0; c < 3; ++c) {
      CAPTURE(c);
      for (std::size_t k = 0; k < std::min<std::size_t>(bounced.bounces.size(), 5); ++k) {
        CHECK(bounced.bounces[k][c] == doctest::Approx(start[c] * std::pow(ratio[c], k)).epsilon(2e-3));
      }
      CHECK(bounced.solution.energy.re_entered[c] == doctest::Approx(start[c] / (1 - ratio[c])).epsilon(2e-3));
    }
  }
}

TEST_CASE("the first bounce between facing plates brings what the closed form lets through") {
  const Level level = plates().view();
  const auto q = lit(level, [](std::uint32_t f) { return faces_lower(plates(), f); });
  const EnteringLight light{{gpu::BEAM_DIRECTIONAL, glm::vec3(0, 0, 1), {}, {}}, q};
  SolveOptions options = solving(Method::fem, Source::buried, Model::sp3, 1e-8);
  options.bounces = 1;
  const double eta = 1.3;
  const BouncedSolution bounced = solve_with_bounces(level, medium(level), eta, std::span(&light, 1), options);
  REQUIRE(bounced.bounces.size() == 1);
  const auto alone = solve_reference(level, medium(level), eta, light, options);
  std::vector<glm::dvec3> sent = alone.flux;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::dvec3 at = corners_of(plates(), f).centre();
    sent[f] *= faces_lower(plates(), f) ? point_to_square(at.x, at.y, 10, 4) : 0.0;
  }
  const glm::dvec3 exact = diffuse_transmittance(eta) * integral(level, sent);
  // 50 faces of 256 rays: at random sqrt(p (1 - p) / 12800), a hundredth of p = 0.45.
  for (int c = 0; c < 3; ++c) CHECK(bounced.bounces[0][c] == doctest::Approx(exact[c]).epsilon(0.01));
  // What re-enters the unlit plate comes out of it: dark without bounces.
  glm::dvec3 before{0}, after{0};
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!faces_upper(plates(), f)) continue;
    before += alone.exitance[f];
    after += bounced.solution.exitance[f];
  }
  CHECK(before == glm::dvec3(0));
  CHECK(glm::all(glm::greaterThan(after, glm::dvec3(0))));
}

TEST_CASE("energy is balanced with bounces, and they add up to what re-entered") {
  const Level level = plates().view();
  const auto q = lit(level, [](std::uint32_t f) { return faces_lower(plates(), f) || f % 3 == 0; });
  const EnteringLight lights[] = {lambertian(q), {{gpu::BEAM_DIRECTIONAL, glm::vec3(0.6f, 0, 0.8f), {}, {}}, q}};
  for (const Method method : {Method::fem, Method::quadgraph_fv}) {
    for (const Model model : both_models) {
      if (sanitized && (method == Method::fem) != (model == Model::sp3)) continue;
      const SolveOptions options = solving(method, Source::buried, model, 1e-6);
      const BouncedSolution bounced = solve_with_bounces(level, medium(level), 1.3, lights, options);
      REQUIRE(bounced.converged);
      CHECK(bounced.bounces.size() > 2);
      glm::dvec3 sum{0};
      for (const glm::dvec3& bounce : bounced.bounces) sum += bounce;
      const Energy& energy = bounced.solution.energy;
      for (int c = 0; c < 3; ++c) {
        CHECK(std::abs(energy.balance()[c]) < 1e-6);
        CHECK(energy.re_entered[c] == doctest::Approx(sum[c]).epsilon(1e-6));
        CHECK(energy.re_entered[c] > 0.01 * energy.entered[c]);
        CHECK(std::abs(bounced.bounces.back()[c]) < 1e-7 * energy.entered[c]);
      }
    }
  }
}

TEST_CASE("bounces are left out where they are not wanted or cannot be") {
  const OwnedLevel plain = box_level(3, 5.0f);
  OwnedLevel convex = plain;
  see(convex, 16);
  CHECK(convex.seen.size() == convex.faces.size() + 1);
  const auto none_in = [](const OwnedLevel& owned, SolveOptions options) {
    const Level level = owned.view();
    const auto q = everywhere(level, glm::vec3(1));
    const EnteringLight light = lambertian(q);
    const BouncedSolution bounced = solve_with_bounces(level, medium(level), 1.3, std::span(&light, 1), options);
    const ReferenceSolution alone = solve_reference(level, medium(level), 1.3, light, options);
    CHECK(bounced.bounces.empty());
    CHECK(bounced.converged);
    CHECK(bounced.solution.energy.re_entered == glm::dvec3(0));
    CHECK(bounced.solution.exitance == alone.exitance);
  };
  const SolveOptions options = solving(Method::fem, Source::buried, Model::diffusion, 1e-6);
  none_in(plain, options);
  none_in(convex, options);
  SolveOptions unwanted = options;
  unwanted.inter_reflection = false;
  none_in(plates(), unwanted);
  none_in(plates(), solving(Method::fem, Source::diffuse, Model::diffusion, 1e-6));
  CHECK(sky_visibility(plain.view()) == std::vector<double>(plain.faces.size(), 1.0));
}

TEST_CASE("the number of bounces can be told") {
  const Level level = plates().view();
  const auto q = lit(level, [](std::uint32_t f) { return faces_lower(plates(), f); });
  const EnteringLight light = lambertian(q);
  SolveOptions options = solving(Method::fem, Source::buried, Model::diffusion, 1e-6);
  const BouncedSolution whole = solve_with_bounces(level, medium(level), 1.3, std::span(&light, 1), options);
  options.bounces = 2;
  const BouncedSolution two = solve_with_bounces(level, medium(level), 1.3, std::span(&light, 1), options);
  REQUIRE(two.bounces.size() == 2);
  CHECK_FALSE(two.converged);
  for (std::size_t k = 0; k < 2; ++k) CHECK(two.bounces[k] == whole.bounces[k]);
}
