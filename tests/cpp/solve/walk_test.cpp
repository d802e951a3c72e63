// The walk of the buried source: closed forms along rays, conservation of power, the CPU's walk.
#include "engine/optics/fresnel.h"
#include "engine/reference/source_walk.h"
#include "tests/cpp/fixtures/walk_fixtures.h"

using namespace quadgraph;

namespace {

constexpr float mean_free_paths[] = {0.01f, 0.1f, 1.0f, 10.0f, 100.0f};

// Integral of sigma e^(-sigma t) against the hat function of plane i over planes `h` apart along the ray, from 0 to
// `count` h; with what passes `count` h left out.
double hat_integral(double sigma, double h, int i, int count) {
  const double tau = sigma * h;
  const double rest = std::exp(-tau * i);
  double sum = 0;
  // Falling side: (1 - s) for s in [0, 1] beyond plane i; rising side: s before it.
  if (i < count) sum += rest * (1 - (-std::expm1(-tau)) / tau);
  if (i > 0) sum += std::exp(-tau * (i - 1)) * ((-std::expm1(-tau)) / tau - std::exp(-tau));
  return sum;
}

std::vector<glm::dvec3> by_plane(const OwnedLevel& level, const std::vector<glm::dvec3>& deposit, double h, int count) {
  std::vector<glm::dvec3> planes(static_cast<std::size_t>(count) + 1, glm::dvec3(0));
  for (std::size_t v = 0; v < deposit.size(); ++v) {
    planes[static_cast<std::size_t>(std::lround(level.vertices[v].x / h))] += deposit[v];
  }
  return planes;
}

}  // namespace

TEST_CASE("what rays scatter in a slab is the exact integral against the hat functions, at any angle") {
  CheckedContext device;
  constexpr int n = 6;
  constexpr double h = 0.5;
  const OwnedLevel level = slab_level(n, static_cast<float>(n * h));
  const glm::vec3 sigma_s_prime{1.0f, 0.3f, 0.05f}, sigma_a{0.2f, 0.0f, 0.4f};
  for (const float sine : {0.0f, 0.4f, 0.8f, 0.99f}) {
    const double cos_i = std::sqrt(1 - double{sine} * sine);
    const glm::vec3 direction(std::sqrt(1 - sine * sine), 0.6f * sine, 0.8f * sine);
    for (const double eta : {1.0, 1.4}) {
      CAPTURE(sine);
      CAPTURE(eta);
      const GpuWalk result = walk(device.context, {.level = level,
                                                   .optical = uniform(sigma_s_prime, sigma_a),
                                                   .quarter_q = lit_side({-1, 0, 0}),
                                                   .beam = {gpu::BEAM_DIRECTIONAL, direction, {}, {}},
                                                   .eta = eta});
      check_balance(result, 1e-6);
      const double cosine = refracted_cosine(cos_i, eta), r = internal_reflectance(cosine, eta);
      const auto planes = by_plane(level, result.deposit, h, n);
      for (int c = 0; c < 3; ++c) {
        const double sigma = double{sigma_s_prime[c]} + sigma_a[c], albedo = sigma_s_prime[c] / sigma;
        const double through = std::exp(-sigma * n * h / cosine);
        for (int i = 0; i <= n; ++i) {
          // Forth and back between the two faces for ever: a geometric series.
          const double forth = hat_integral(sigma / cosine, h, i, n), back = hat_integral(sigma / cosine, h, n - i, n);
          const double pass = r * through;
          const double expected = albedo * (forth + pass * back) / (1 - pass * pass);
          CAPTURE(i);
          const double found = planes[static_cast<std::size_t>(i)][c] / result.entered[c];
          // Without reflection the ray is followed to the far side; with it, to the last thousandth.
          CHECK(std::abs(found - expected) < (eta == 1.0 ? 2e-6 : double{gpu::WALK_END}));
        }
      }
    }
  }
}

TEST_CASE("no power is lost or won, for any element size against the mean free path, beam and method") {
  CheckedContext device;
  const OwnedLevel level = box_level(4, 4.0f, 0.3f);
  for (const float path : mean_free_paths) {
    for (const gpu::BeamRecord& beam : beams_of_all_kinds()) {
      for (const Method method : all_methods) {
        CAPTURE(path);
        CAPTURE(beam.kind);
        CAPTURE(name_of(method));
        const auto optical = [&](const glm::vec3& p) {
          // Channels: even, with a contrast of 10^4 between neighbours, and clear in one half.
          const float contrast = p.y + p.z > 4.0f ? 100.0f : 0.01f;
          const glm::vec3 sigma = glm::vec3(1, contrast, p.x < 2.0f ? 1.0f : 0.0f) / path;
          return optical_of(sigma * glm::vec3(0.9f, 0.5f, 1.0f), sigma * glm::vec3(0.1f, 0.5f, 0.0f));
        };
        const GpuWalk result = walk(device.context, {.level = level,
                                                     .optical = optical,
                                                     .quarter_q = lit_side({-1, 0, 0}),
                                                     .beam = beam,
                                                     .method = method,
                                                     .eta = 1.3});
        check_balance(result, 1e-6);
        CHECK(total(result.deposit).x > 0.02 * result.entered.x);
      }
    }
  }
}

TEST_CASE("the walk repeats bit for bit") {
  CheckedContext device;
  const WalkInput input{
      .level = box_level(6, 6.0f, 0.3f),
      .optical = uniform({1.0f, 0.2f, 0.01f}, {0.1f, 0.0f, 0.001f}),
      .quarter_q = [](const Lit& lit, std::uint32_t k) { return lit.centre.x * static_cast<float>(k); },
      .beam = {gpu::BEAM_LAMBERTIAN, {}, {}, {}},
      .eta = 1.4};
  const GpuWalk first = walk(device.context, input);
  CHECK(first.entered.x > 0);
  for (int repeat = 0; repeat < 3; ++repeat) CHECK(walk(device.context, input).words == first.words);
}

TEST_CASE("Lambertian light falls off with depth as the average over all angles, by eight rays or one") {
  CheckedContext device;
  constexpr int n = 8;
  constexpr double h = 0.25, eta = 1.3;
  const OwnedLevel level = slab_level(n, static_cast<float>(n * h));
  std::vector<double> expected(n, 0);
  double norm = 0;
  constexpr int steps = 2000;
  for (int k = 0; k < steps; ++k) {
    const double cos_i = (k + 0.5) / steps, weight = cos_i * fresnel_transmittance(cos_i, eta);
    norm += weight;
    for (int i = 0; i < n; ++i) {
      expected[static_cast<std::size_t>(i)] += weight * hat_integral(3.0 / refracted_cosine(cos_i, eta), h, i, n);
    }
  }
  for (const bool mean_rays : {false, true}) {
    CAPTURE(mean_rays);
    const GpuWalk result = walk(device.context, {.level = level,
                                                 .optical = uniform({3.0f, 1.5f, 0.7f}, glm::vec3(0)),
                                                 .quarter_q = lit_side({-1, 0, 0}),
                                                 .beam = {gpu::BEAM_LAMBERTIAN, {}, {}, {}},
                                                 .eta = eta,
                                                 .mean_rays = mean_rays});
    check_balance(result, 1e-6);
    const auto planes = by_plane(level, result.deposit, h, n);
    for (int i = 0; i < n; ++i) {
      CAPTURE(i);
      // One ray knows the mean of the depths, not how they differ: of all light a thousandth lies elsewhere.
      CHECK(planes[static_cast<std::size_t>(i)].x / result.entered.x ==
            doctest::Approx(expected[static_cast<std::size_t>(i)] / norm).epsilon(0.01).scale(mean_rays ? 0.1 : 0.01));
    }
  }
}

TEST_CASE("with mean rays a ray ends where a hundredth of its light is left, unless much is absorbed") {
  CheckedContext device;
  constexpr int n = 8;
  const OwnedLevel level = slab_level(n, n);
  for (const auto& [mean_rays, albedo] : {std::pair{false, 1.0f}, {true, 1.0f}, {true, 0.8f}}) {
    CAPTURE(mean_rays);
    CAPTURE(albedo);
    const GpuWalk result =
        walk(device.context, {.level = level,
                              .optical = uniform(glm::vec3(1.5f * albedo), glm::vec3(1.5f * (1 - albedo))),
                              .quarter_q = lit_side({-1, 0, 0}),
                              .mean_rays = mean_rays});
    check_balance(result, 1e-6);
    const auto planes = by_plane(level, result.deposit, 1, n);
    // e^(-1.5 * 3.07) is a hundredth: in the tets before the fourth plane.
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(planes[i].x / result.entered.x ==
            doctest::Approx(double{albedo} * hat_integral(1.5, 1, static_cast<int>(i), n)).epsilon(1e-3).scale(0.01));
    }
    CHECK(planes[4].x > 0);
    CHECK((planes[5].x == 0) == (mean_rays && albedo == 1));
  }
}

TEST_CASE("a face that is lit in part sends its light from the lit quarters") {
  CheckedContext device;
  const OwnedLevel level = box_level(1, 1.0f);
  for (std::uint32_t lit = 0; lit < FACE_QUARTERS; ++lit) {
    // All is scattered at once: the deposit is the origin's barycentric coordinates.
    const GpuWalk result =
        walk(device.context,
             {.level = level,
              .optical = uniform(glm::vec3(1e5f), glm::vec3(0)),
              .quarter_q = [&](const Lit& face,
                               std::uint32_t quarter) { return face.face == 0 && quarter == lit ? 1.0f : 0.0f; },
              .beam = {gpu::BEAM_DIRECTIONAL, -lit_face(level, 0).normal, {}, {}}});
    CHECK(result.entered.x == doctest::Approx(0.5 / FACE_QUARTERS));
    CHECK(result.segments == 1);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const double expected = lit == 3 ? 1.0 / 3 : k == lit ? 2.0 / 3 : 1.0 / 6;
      CHECK(result.deposit[level.faces[0][static_cast<int>(k)]].x / result.entered.x ==
            doctest::Approx(expected).epsilon(1e-4));
    }
  }
}

TEST_CASE("one tet, slivers, needles and flat tets keep the power") {
  CheckedContext device;
  std::vector<OwnedLevel> levels;
  levels.push_back(level_from_tets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}));
  for (const glm::vec3& stretch :
       {glm::vec3(1, 1, 0.001f), glm::vec3(0.001f, 1, 1), glm::vec3(1, 0.001f, 0.001f), glm::vec3(1, 1, 0)}) {
    OwnedLevel box = box_level(3, 3.0f, 0.2f);
    for (auto* points : {&box.vertices, &box.nodes}) {
      for (glm::vec3& p : *points) p *= stretch;
    }
    levels.push_back(box);
  }
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (const float path : {0.01f, 1.0f}) {
      for (const Method method : {Method::fem, Method::quadgraph_fv}) {
        CAPTURE(i);
        CAPTURE(path);
        const GpuWalk result =
            walk(device.context, {.level = levels[i],
                                  .optical = uniform(glm::vec3(0.7f, 1, 0.1f) / path, glm::vec3(0.3f, 0, 0) / path),
                                  .quarter_q = [](const Lit&, std::uint32_t) { return 1.0f; },
                                  .beam = {gpu::BEAM_LAMBERTIAN, {}, {}, {}},
                                  .method = method,
                                  .eta = 1.4});
        check_balance(result, 1e-6);
        for (const glm::dvec3& d : result.deposit) CHECK(std::isfinite(d.x + d.y + d.z));
      }
    }
  }
}

TEST_CASE("the walk is that of the CPU, ray by ray") {
  CheckedContext device;
  WalkInput input{.level = slab_level(5, 5.0f, 0.3f),
                  .optical =
                      [](const glm::vec3& p) {
                        const float wave = 1.0f + std::sin(p.x + 2 * p.y - p.z);
                        return optical_of({wave, 0.2f, p.z > 3 ? 0.0f : 3.0f}, {0.1f, 0.1f * wave, 0});
                      },
                  .quarter_q =
                      [](const Lit& lit, std::uint32_t k) {
                        if (lit.normal.x > -0.9f) return 0.0f;
                        return lit.face % 2 == 0 ? lit.centre.y : lit.face % 3 == k ? 1.0f : 0.25f;
                      },
                  .eta = 1.35};
  std::vector<Quarters> quarters, even;
  for (std::uint32_t f = 0; f < input.level.faces.size(); ++f) {
    quarters.emplace_back();
    for (std::uint32_t k = 0; k < FACE_QUARTERS; ++k) {
      quarters[f][k] = input.quarter_q(lit_face(input.level, f), k) * input.colour;
    }
    even.emplace_back();
    even[f].fill(quarters[f][0]);
  }
  std::vector<gpu::Optical> optical;
  for (const glm::vec3& node : input.level.nodes) optical.push_back(input.optical(node));
  for (const gpu::BeamRecord& beam : beams_of_all_kinds()) {
    for (const Method method : all_methods) {
      CAPTURE(beam.kind);
      CAPTURE(name_of(method));
      input.beam = beam;
      input.method = method;
      const GpuWalk found = walk(device.context, input);
      const Level level = input.level.view();
      const Problem problem{.method = method, .optical = optical, .eta = input.eta};
      const WalkResult expected = walk_source(level, problem, beam, beam.kind == gpu::BEAM_MEAN ? even : quarters);
      for (int c = 0; c < 3; ++c) {
        CHECK(total(found.deposit)[c] == doctest::Approx(total(expected.scattered)[c]).epsilon(1e-5));
        CHECK(found.power.absorbed[c] == doctest::Approx(expected.absorbed[c]).epsilon(1e-5));
        CHECK(found.power.unscattered[c] == doctest::Approx(expected.unscattered_out[c]).epsilon(1e-5));
      }
      CHECK(relative_difference(
                std::vector(found.deposit.begin(), found.deposit.end()),
                std::vector(expected.scattered.begin(),
                            expected.scattered.begin() + static_cast<std::ptrdiff_t>(found.deposit.size()))) < 1e-5);
      CHECK(relative_difference(found.unscattered, expected.unscattered) < 1e-4);
    }
  }
}
