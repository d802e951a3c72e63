// Gathered radiance on the CPU against closed forms: furnace, beams behind flat faces, Fresnel, exitance, motion.
#include "engine/reference/radiance.h"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>
#include <numbers>

#include "engine/optics/fresnel.h"
#include "engine/optics/surface_boundary.h"
#include "engine/reference/entering.h"
#include "shaders/gather/gather_shared.h"
#include "tests/cpp/fixtures/graph_cases.h"

using namespace quadgraph;

namespace {

using std::numbers::pi;

// A slab along x between walls that reflect; inner vertices out of line.
OwnedLevel slab_level(std::uint32_t n, float size) {
  OwnedLevel owned = box_level(n, size, 0.2f);
  for (const glm::uvec3& f : owned.faces) {
    const float x = (owned.vertices[f.x].x + owned.vertices[f.y].x + owned.vertices[f.z].x) / 3;
    owned.face_kinds.push_back(x < 1e-5f || x > 0.9999f * size ? face_open : face_reflecting);
  }
  return owned;
}

Problem problem_of(const Opticals& optical, double eta) {
  return {Method::fem, Source::buried, Model::sp3, optical, eta};
}

Opticals everywhere_of(const Level& level, const glm::vec3& sigma_s_prime, const glm::vec3& sigma_a) {
  return Opticals(level.nodes.size(), {sigma_s_prime, sigma_a});
}

Uncollided dark(const Level& level) {
  return {std::vector<glm::dvec3>(level.vertices.size(), glm::dvec3(0)),
          std::vector<glm::dvec3>(level.vertices.size(), glm::dvec3(gpu::UNCOLLIDED_DEPTH))};
}

// Light of 1 W/mm^2 that enters at x = 0.
struct LitSlab {
  std::vector<Quarters> quarters;
  BeamLight light;

  LitSlab(const Level& level, const gpu::BeamRecord& beam) {
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      const glm::vec3 q(level.nodes[level.tet_count() + f].x < 1e-4f ? 1 : 0);
      quarters.push_back({q, q, q, q});
    }
    light = {beam, quarters};
  }

  Uncollided in(const Level& level, const Problem& problem) const {
    return uncollided(level, problem, std::span(&light, 1), vertex_starts(level));
  }
};

gpu::BeamRecord along(const glm::vec3& direction) {
  return {gpu::BEAM_DIRECTIONAL, glm::normalize(direction), {}, {}};
}

std::uint32_t open_face(const Level& level, bool lit) {
  std::uint32_t f = 0;
  while (level.reflecting(f) || (level.nodes[level.tet_count() + f].x < 1e-4f) != lit) ++f;
  return f;
}

// Outward direction of outside cosine c from a face towards -x (side -1) or x (side 1).
glm::dvec3 outward(double c, double side, double azimuth = 0.7) {
  const double sine = std::sqrt(1 - c * c);
  return {side * c, sine * std::cos(azimuth), sine * std::sin(azimuth)};
}

}  // namespace

TEST_CASE("uniform light in a thick body: albedo / 4 pi inside, to rounding, whatever the mesh and the direction") {
  const OwnedLevel owned = box_level(5, 5.0f, 0.3f);
  const Level level = owned.view();
  const std::vector<glm::dvec3> phi(level.vertices.size(), glm::dvec3(4 * pi));
  const Uncollided none = dark(level);
  const Opticals optical = everywhere_of(level, {20, 30, 10}, {5, 0, 10});
  const glm::dvec3 albedo(0.8, 1.0, 0.5);
  for (const double eta : {1.0, 1.3}) {
    const Problem problem = problem_of(optical, eta);
    const InsideLight light{phi, none};
    double leaving = 0;  // of the four cosines
    for (std::size_t k = 0; k < gpu::LAMBERTIAN_NODES; ++k) {
      const double outside = std::sqrt(static_cast<double>(gpu::LAMBERTIAN_U[k]));
      leaving += static_cast<double>(gpu::LAMBERTIAN_W[k]) * fresnel_transmittance(outside, eta);
    }
    const auto exitance = gathered_exitance(level, problem, light);
    for (std::uint32_t f = 0; f < level.face_count(); f += 7) {
      const FaceFrame frame = frame_of(level, f);
      const glm::dvec3 tilted =
          glm::normalize(frame.normal + 0.9 * glm::normalize(frame.corners[1] - frame.corners[0]));
      const double c = glm::dot(tilted, frame.normal);
      const glm::dvec3 found = gathered_radiance(level, problem, light, f, {0.2, 0.5, 0.3}, tilted);
      for (int k = 0; k < 3; ++k) {
        CHECK(found[k] == doctest::Approx(albedo[k] * fresnel_transmittance(c, eta) / (eta * eta)).epsilon(1e-9));
        CHECK(exitance[f][k] == doctest::Approx(albedo[k] * pi * leaving / (eta * eta)).epsilon(1e-6));
      }
    }
    // The four cosines stand for all: against the exact share that leaves.
    CHECK(leaving == doctest::Approx(diffuse_transmittance(eta)).epsilon(0.01));
  }
}

TEST_CASE("uniform light in a thin slab: what the surfaces keep inside comes back") {
  const OwnedLevel owned = slab_level(4, 1.0f);
  const Level level = owned.view();
  const std::vector<glm::dvec3> phi(level.vertices.size(), glm::dvec3(4 * pi));
  const Uncollided none = dark(level);
  const Opticals optical = everywhere_of(level, {0.5f, 0.2f, 1.0f}, {0.1f, 0.0f, 1.0f});
  for (const double eta : {1.0, 1.5}) {
    const Problem problem = problem_of(optical, eta);
    for (const double c : {1.0, 0.6, 0.3}) {
      const double mu = refracted_cosine(c, eta), r = internal_reflectance(mu, eta);
      const std::uint32_t f = open_face(level, true);
      const glm::dvec3 inward = refract(outward(c, 1), glm::dvec3(-1, 0, 0), eta);
      const Gathered found = gather(level, problem, {phi, none}, f, glm::dvec3(1.0 / 3), inward);
      glm::dvec3 seen(0);
      for (const Escape& escape : found.escapes) seen += escape.share;
      for (int k = 0; k < 3; ++k) {
        const double s = optical[0].sigma_s_prime[k], sigma_t = s + static_cast<double>(optical[0].sigma_a[k]);
        const double once = std::exp(-sigma_t / mu);
        CHECK(found.radiance[k] == doctest::Approx(s / sigma_t * (1 - once) / (1 - r * once)).epsilon(0.01));
        CHECK(seen[k] == doctest::Approx((1 - r) * once / (1 - r * once)).epsilon(0.01));
        if (eta == 1) CHECK(found.radiance[k] == doctest::Approx(s / sigma_t * (1 - once)).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("a beam behind a flat face is entry exp(-depth) at every vertex, slanted and refracted too") {
  const OwnedLevel owned = slab_level(5, 2.0f);
  const Level level = owned.view();
  const Opticals optical = everywhere_of(level, {1.0f, 2.0f, 0.3f}, {0.1f, 0.5f, 0.0f});
  for (const double eta : {1.0, 1.3}) {
    const Problem problem = problem_of(optical, eta);
    for (const double c : {1.0, 0.7, 0.3}) {
      const double mu = refracted_cosine(c, eta);
      const Uncollided found = LitSlab(level, along(glm::vec3(outward(c, 1)))).in(level, problem);
      for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
        for (int k = 0; k < 3; ++k) {
          const double sigma_t = static_cast<double>(optical[0].sigma_s_prime[k]) + optical[0].sigma_a[k];
          const double depth = sigma_t * level.vertices[v].x / mu;
          CHECK(found.entry[v][k] == doctest::Approx(1 / mu).epsilon(1e-5));
          CHECK(std::abs(found.depth[v][k] - depth) < 1e-5 * (1 + depth));
        }
      }
    }
  }
}

TEST_CASE("single scattering of a beam leaves a slab as the closed form says, on both sides") {
  const OwnedLevel owned = slab_level(5, 2.0f);
  const Level level = owned.view();
  const Opticals optical = everywhere_of(level, {0.9f, 0.5f, 0.25f}, {0.1f, 0.5f, 0.25f});
  const std::vector<glm::dvec3> no_phi(level.vertices.size(), glm::dvec3(0));
  const Problem problem = problem_of(optical, 1.0);
  for (const double c : {1.0, 0.5}) {
    const Uncollided beam = LitSlab(level, along(glm::vec3(outward(c, 1)))).in(level, problem);
    for (const double mu : {1.0, 0.8, 0.55}) {
      for (int k = 0; k < 3; ++k) {
        const double s = optical[0].sigma_s_prime[k], sigma_t = s + static_cast<double>(optical[0].sigma_a[k]);
        const double in = sigma_t / c, out = sigma_t / mu, factor = s / (4 * pi * c * mu);
        const double lit = factor * -std::expm1(-2 * (in + out)) / (in + out);
        const double unlit =
            in == out ? factor * 2 * std::exp(-2 * in) : factor * (std::exp(-2 * in) - std::exp(-2 * out)) / (out - in);
        const InsideLight light{no_phi, beam};
        const auto found = [&](bool side, double sign) {
          return gathered_radiance(level, problem, light, open_face(level, side), glm::dvec3(1.0 / 3),
                                   outward(mu, sign))[k];
        };
        CHECK(found(true, -1) == doctest::Approx(lit).epsilon(1e-5));
        CHECK(found(false, 1) == doctest::Approx(unlit).epsilon(1e-5));
      }
    }
  }
}

TEST_CASE("uniform light that enters falls off as its bundle; one ray stands for it") {
  const OwnedLevel owned = slab_level(5, 2.0f);
  const Level level = owned.view();
  const Opticals optical = everywhere_of(level, glm::vec3(1), glm::vec3(0.2f));
  for (const double eta : {1.0, 1.3}) {
    const Problem problem = problem_of(optical, eta);
    const LambertianBundle bundle = lambertian_bundle(eta);
    const Uncollided even = LitSlab(level, {gpu::BEAM_LAMBERTIAN, {}, {}, {}}).in(level, problem);
    const Uncollided mean = LitSlab(level, {gpu::BEAM_MEAN, {}, {}, {}}).in(level, problem);
    for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
      if (level.vertices[v].x > 0.9f) continue;  // the way out there is the far side, where nothing enters
      const double tau = 1.2 * level.vertices[v].x, mu = bundle.mean_cosine();
      double expected = 0;
      for (std::size_t k = 0; k < bundle.mu.size(); ++k) {
        expected += bundle.share[k] / bundle.mu[k] * std::exp(-tau / bundle.mu[k]);
      }
      CHECK(even.entry[v].x * std::exp(-even.depth[v].x) == doctest::Approx(expected).epsilon(1e-5));
      CHECK(mean.entry[v].x * std::exp(-mean.depth[v].x) == doctest::Approx(std::exp(-tau / mu) / mu).epsilon(1e-5));
    }
  }
}

TEST_CASE("where a bright beam from behind comes to its end, what stands for all beams does not change at once") {
  const float size = 15;
  const OwnedLevel owned = slab_level(15, size);
  const Level level = owned.view();
  const Opticals optical = everywhere_of(level, glm::vec3(1), glm::vec3(0.2f));
  const LitSlab front(level, along({1, 0, 0}));
  std::vector<Quarters> quarters;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::vec3 q(level.nodes[level.tet_count() + f].x > 0.9999f * size ? 50 : 0);
    quarters.push_back({q, q, q, q});
  }
  const std::array lights = {front.light, BeamLight{along({-1, 0, 0}), quarters}};
  const Uncollided both = uncollided(level, problem_of(optical, 1.0), lights, vertex_starts(level));
  double most = 1;
  for (const glm::uvec4& tet : level.tets) {
    for (int k = 1; k < 4; ++k) {
      const double step = both.entry[tet[k]].x / both.entry[tet[0]].x;
      most = std::max({most, step, 1 / step});
    }
  }
  CHECK(most < 4);  // 51 where it is the sum of what arrives
}

TEST_CASE("beams add up, and where none arrives it is dark") {
  const OwnedLevel owned = slab_level(4, 2.0f);
  const Level level = owned.view();
  const Opticals optical = everywhere_of(level, glm::vec3(1), glm::vec3(0.2f));
  const Problem problem = problem_of(optical, 1.3);
  const LitSlab one(level, along({1, 0, 0})), two(level, along({1, 1, 0.5f})), behind(level, along({-1, 0, 0}));
  const std::array lights = {one.light, two.light};
  const VertexStarts starts = vertex_starts(level);
  const Uncollided both = uncollided(level, problem, lights, starts);
  const Uncollided first = one.in(level, problem), second = two.in(level, problem);
  const Uncollided away = behind.in(level, problem), none = uncollided(level, problem, {}, starts);
  const auto fluence = [](const Uncollided& u, std::uint32_t v) { return u.entry[v].x * std::exp(-u.depth[v].x); };
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    CHECK(fluence(both, v) == doctest::Approx(fluence(first, v) + fluence(second, v)));
    CHECK(away.entry[v] == glm::dvec3(0));
    CHECK(none.entry[v] == glm::dvec3(0));
  }
}

TEST_CASE("the gathered exitance is the integral of the gathered radiance over the directions") {
  const OwnedLevel owned = slab_level(8, 2.0f);
  const Level level = owned.view();
  const Opticals optical = everywhere_of(level, {1.8f, 1.0f, 4.0f}, {0.2f, 1.0f, 0.0f});
  const auto q = one_side(level);
  for (const double eta : {1.0, 1.3}) {
    const Problem problem = problem_of(optical, eta);
    const auto solution =
        solve_reference(level, optical, eta, along_x(q), solving(Method::fem, Source::buried, Model::sp3));
    const Uncollided beam = LitSlab(level, along({1, 0, 0})).in(level, problem);
    const InsideLight light{solution.phi, beam};
    const auto exitance = gathered_exitance(level, problem, light);
    for (const bool side : {true, false}) {
      const std::uint32_t f = open_face(level, side);
      glm::dvec3 sum(0);
      constexpr int cosines = 40, azimuths = 8;
      for (int i = 0; i < cosines; ++i) {
        for (int j = 0; j < azimuths; ++j) {
          const double c = (i + 0.5) / cosines, azimuth = 2 * pi * (j + 0.5) / azimuths;
          const glm::dvec3 way = outward(c, side ? -1 : 1, azimuth);
          const glm::dvec3 l = gathered_radiance(level, problem, light, f, glm::dvec3(1.0 / 3), way);
          sum += 2 * pi * c / (cosines * azimuths) * l;
        }
      }
      for (int k = 0; k < 3; ++k) CHECK(exitance[f][k] == doctest::Approx(sum[k]).epsilon(0.012));
    }
  }
}

TEST_CASE("a body that moves with its light looks the same") {
  const auto turned = [](const glm::dvec3& v) {  // by 40 degrees about z, then 30 about x
    const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(0.5), e = std::sin(0.5);
    const glm::dvec3 w(c * v.x - s * v.y, s * v.x + c * v.y, v.z);
    return glm::dvec3(w.x, d * w.y - e * w.z, e * w.y + d * w.z);
  };
  const OwnedLevel still = box_level(4, 2.0f, 0.3f);
  OwnedLevel moved = still;
  for (auto* points : {&moved.vertices, &moved.nodes}) {
    for (glm::vec3& p : *points) p = glm::vec3(turned(p) + glm::dvec3(1, -2, 3));
  }
  const Opticals optical = varying(still.view(), 0.05f);
  const Problem problem = problem_of(optical, 1.3);
  std::vector<glm::dvec3> phi;
  for (const glm::vec3& p : still.vertices) phi.push_back(glm::dvec3(2, 3, 4) + glm::dvec3(p));
  const glm::dvec3 sun = glm::normalize(glm::dvec3(1, 0.4, -0.3));
  const std::vector<Quarters> quarters(still.faces.size(), {glm::vec3(1), glm::vec3(1), glm::vec3(1), glm::vec3(1)});
  const auto seen = [&](const Level& level, const glm::dvec3& light_way, auto turn) {
    const BeamLight beam{along(glm::vec3(light_way)), quarters};
    const Uncollided fields = uncollided(level, problem, std::span(&beam, 1), vertex_starts(level));
    std::vector<glm::dvec3> radiance = gathered_exitance(level, problem, {phi, fields});
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      const glm::dvec3 normal = frame_of(still.view(), f).normal;
      const glm::dvec3 way = turn(glm::normalize(normal + glm::dvec3(0.2, 0.3, -0.1)));
      radiance.push_back(gathered_radiance(level, problem, {phi, fields}, f, {0.3, 0.3, 0.4}, way));
    }
    return radiance;
  };
  const auto before = seen(still.view(), sun, [](const glm::dvec3& v) { return v; });
  const auto after = seen(moved.view(), turned(sun), turned);
  double worst = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    CHECK(before[i].x > 0);
    for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(after[i][k] / before[i][k] - 1));
  }
  CHECK(worst < 1e-4);
}
