// The walk of the buried source on the CPU: conservation at any element size, closed forms, Fresnel, walls.
#include <doctest/doctest.h>

#include <glm/gtc/constants.hpp>

#include "engine/optics/fresnel.h"
#include "engine/reference/source_walk.h"
#include "tests/cpp/fixtures/graph_cases.h"

using namespace quadgraph;

namespace {

std::vector<Quarters> even(std::span<const glm::vec3> q) {
  std::vector<Quarters> quarters;
  for (const glm::vec3& value : q) quarters.push_back({value, value, value, value});
  return quarters;
}

Problem problem_of(const Opticals& optical, double eta, Method method = Method::fem) {
  return {method, Source::buried, Model::diffusion, optical, eta};
}

glm::dvec3 sum(std::span<const glm::dvec3> values) {
  glm::dvec3 total(0);
  for (const glm::dvec3& v : values) total += v;
  return total;
}

gpu::BeamRecord along(const glm::vec3& direction) {
  return {gpu::BEAM_DIRECTIONAL, glm::normalize(direction), {}, {}};
}

const gpu::BeamRecord lambertian_beam{gpu::BEAM_LAMBERTIAN, {}, {}, {}};

void check_conserved(const WalkResult& walk, double tolerance = 1e-11) {
  for (int c = 0; c < 3; ++c) {
    const double left = walk.entered[c] - sum(walk.scattered)[c] - walk.absorbed[c] - walk.unscattered_out[c];
    CHECK(std::abs(left) <= tolerance * walk.entered[c]);
    CHECK(std::isfinite(left));
  }
}

}  // namespace

TEST_CASE("every watt scatters, is absorbed or leaves, for mean free paths of 0.01 to 100 elements") {
  const OwnedLevel owned = box_level(4, 4.0f, 0.3f);
  const Level level = owned.view();
  const auto quarters = even(everywhere(level, glm::vec3(1.0f, 0.3f, 2.0f)));
  for (const float sigma : {100.0f, 1.0f, 0.01f}) {
    for (const float albedo : {0.0f, 0.5f, 1.0f}) {
      const Opticals optical(level.nodes.size(), {glm::vec3(albedo * sigma), glm::vec3((1 - albedo) * sigma)});
      for (Method method : {Method::fem, Method::quadgraph_fv}) {
        for (const gpu::BeamRecord& beam : {along({1, 0.3f, -0.2f}), lambertian_beam}) {
          const WalkResult walk = walk_source(level, problem_of(optical, 1.3, method), beam, quarters);
          check_conserved(walk);
          CHECK(walk.entered.x == doctest::Approx(96.0));
          for (const glm::dvec3& deposit : walk.scattered) CHECK(std::min({deposit.x, deposit.y, deposit.z}) >= 0);
        }
      }
    }
  }
}

TEST_CASE("heterogeneous, clear and absorbing regions beside each other") {
  const OwnedLevel owned = box_level(5, 5.0f, 0.3f);
  const Level level = owned.view();
  Opticals optical;
  for (const glm::vec3& p : level.nodes) {
    const float kind = std::fmod(std::floor(p.x) + std::floor(p.y) + std::floor(p.z), 3.0f);
    optical.push_back(kind == 0   ? gpu::Optical{glm::vec3(0), glm::vec3(0)}
                      : kind == 1 ? gpu::Optical{glm::vec3(50.0f, 5.0f, 0.0f), glm::vec3(0.01f)}
                                  : gpu::Optical{glm::vec3(0.0f, 0.1f, 1.0f), glm::vec3(20.0f, 0.0f, 0.1f)});
  }
  const auto quarters = even(one_side(level));
  check_conserved(walk_source(level, problem_of(optical, 1.5), along({1, 0.2f, 0.1f}), quarters));
  check_conserved(walk_source(level, problem_of(optical, 1.5), lambertian_beam, quarters));
}

TEST_CASE("in layers the deposit is sigma_s' e^-tau against the hat functions of the layers") {
  constexpr std::uint32_t n = 6;
  constexpr double size = 3.0, h = size / n;
  const OwnedLevel owned = box_level(n, static_cast<float>(size));
  const Level level = owned.view();
  const Opticals optical(level.nodes.size(), {glm::vec3(1.0f, 4.0f, 0.2f), glm::vec3(0.5f, 0.1f, 0.0f)});
  const auto q = one_side(level);
  const WalkResult walk = walk_source(level, problem_of(optical, 1.0), along({1, 0, 0}), even(q));
  std::array<glm::dvec3, n + 1> layer{};
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    layer[static_cast<std::size_t>(std::lround(level.vertices[v].x / h))] += walk.scattered[v];
  }
  for (int c = 0; c < 3; ++c) {
    const double scattering = optical[0].sigma_s_prime[c], extinction = scattering + optical[0].sigma_a[c];
    // Rays end below WALK_END, where the rest is left at once: deeper layers differ by at most that.
    const double power = walk.entered[c];
    for (std::uint32_t k = 0; k <= n; ++k) {
      double expected = 0;  // midpoint rule
      constexpr int count = 20000;
      for (int i = 0; i < count; ++i) {
        const double x = size * (i + 0.5) / count;
        const double hat = std::max(0.0, 1 - std::abs(x / h - k));
        expected += power * scattering * std::exp(-extinction * x) * hat * size / count;
      }
      CHECK(std::abs(layer[k][c] - expected) < 1.1e-3 * power);
      if (extinction * size < 6) CHECK(layer[k][c] == doctest::Approx(expected).epsilon(1e-5));
    }
  }
  CHECK(walk.unscattered_out.z / walk.entered.z == doctest::Approx(std::exp(-0.6)).epsilon(1e-6));
}

TEST_CASE("a clear slab: Fresnel splits at every face, and all leaves") {
  OwnedLevel owned = box_level(3, 3.0f);
  for (const glm::uvec3& f : owned.faces) {
    const glm::vec3 mid = (owned.vertices[f.x] + owned.vertices[f.y] + owned.vertices[f.z]) / 3.0f;
    owned.face_kinds.push_back(mid.x < 1e-5f || mid.x > 2.9999f ? face_open : face_reflecting);
  }
  const Level level = owned.view();
  const Opticals clear(level.nodes.size(), {glm::vec3(0), glm::vec3(0)});
  const double eta = 1.5;
  for (const float slope : {0.0f, 1.0f, 5.0f}) {
    const WalkResult walk =
        walk_source(level, problem_of(clear, eta), along({1, slope, 0.2f * slope}), even(one_side(level)));
    const double outside = 1 / std::sqrt(1 + 1.04 * slope * slope);
    const double r = 1 - fresnel_transmittance(outside, eta);
    double far_side = 0;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      if (level.nodes[level.tet_count() + f].x > 2.999f) far_side += walk.unscattered[f].x;
    }
    check_conserved(walk);
    // The series of echoes, cut off where a ray has kept less than WALK_END: it stays clear, so it goes on.
    CHECK(far_side / walk.entered.x == doctest::Approx(1 / (1 + r)).epsilon(1e-5));
    CHECK(sum(walk.scattered) == glm::dvec3(0));
  }
}

TEST_CASE("total reflection keeps light in a clear block until it meets the angle it came in by") {
  const OwnedLevel owned = box_level(2, 2.0f);
  const Level level = owned.view();
  const Opticals clear(level.nodes.size(), {glm::vec3(0), glm::vec3(0)});
  const WalkResult walk = walk_source(level, problem_of(clear, 3.0), along({1, 0.9f, 0.4f}), even(one_side(level)));
  check_conserved(walk);
  CHECK(walk.unscattered_out.x == doctest::Approx(sum(walk.unscattered).x));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const float x = level.nodes[level.tet_count() + f].x;
    const bool across = x > 1e-4f && x < 1.9999f;  // the sides, beyond the critical angle from inside
    if (across) CHECK(walk.unscattered[f] == glm::dvec3(0));
  }
}

TEST_CASE("slivers and one tet keep the balance") {
  for (const float height : {1.0f, 1e-2f, 1e-4f, 1e-6f}) {
    const OwnedLevel owned = level_from_tets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3f, 0.3f, height}}, {{0, 1, 2, 3}});
    const Level level = owned.view();
    const Opticals optical(level.nodes.size(), {glm::vec3(1.0f, 10.0f, 0.01f), glm::vec3(0.1f)});
    for (const gpu::BeamRecord& beam : {along({0.2f, 0.1f, -1}), along({1, 0, 0}), lambertian_beam}) {
      const auto q = everywhere(level, glm::vec3(1));
      const WalkResult walk = walk_source(level, problem_of(optical, 1.4), beam, even(q));
      check_conserved(walk);
      CHECK(walk.entered.x > 0);
    }
  }
}

TEST_CASE("a shadow edge sends the rays where the light is, a long face several") {
  const OwnedLevel owned = level_from_tets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}});
  const Level level = owned.view();
  const Opticals optical(level.nodes.size(), {glm::vec3(1e4f), glm::vec3(0)});  // stays where it enters
  std::vector<Quarters> quarters(4, Quarters{});
  std::uint32_t lit = 0;
  while (level.nodes[level.tet_count() + lit].z > 1e-5f) ++lit;
  quarters[lit][0] = glm::vec3(4);  // only the quarter at the face's first corner
  const WalkResult walk = walk_source(level, problem_of(optical, 1.0), along({0, 0, 1}), quarters);
  CHECK(walk.entered.x == doctest::Approx(0.5));
  CHECK(walk.scattered[level.faces[lit][0]].x == doctest::Approx(0.5 * 2 / 3).epsilon(1e-3));
  CHECK(walk.scattered[level.faces[lit][1]].x == doctest::Approx(0.5 / 6).epsilon(1e-3));
}

TEST_CASE("graph methods receive the same power, in the tets") {
  const OwnedLevel owned = box_level(4, 4.0f, 0.3f);
  const Level level = owned.view();
  const Opticals optical = varying(level, 0.05f);
  const auto quarters = even(one_side(level));
  const WalkResult vertices = walk_source(level, problem_of(optical, 1.3), along({1, 0.5f, 0}), quarters);
  const WalkResult tets =
      walk_source(level, problem_of(optical, 1.3, Method::quadgraph_fv), along({1, 0.5f, 0}), quarters);
  for (int c = 0; c < 3; ++c) {
    CHECK(sum(tets.scattered)[c] == doctest::Approx(sum(vertices.scattered)[c]).epsilon(1e-12));
    for (std::uint32_t f = 0; f < level.face_count(); ++f) CHECK(tets.scattered[level.tet_count() + f][c] == 0);
  }
}
