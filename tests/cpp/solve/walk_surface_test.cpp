// What the walk of the buried source does at the surface: refraction, reflection, and light that never scatters.
#include "engine/optics/fresnel.h"
#include "tests/cpp/fixtures/walk_fixtures.h"

using namespace quadgraph;

TEST_CASE("a clear slab passes and reflects light as Fresnel says, none of it scattered") {
  CheckedContext device;
  const OwnedLevel level = slab_level(3, 3.0f, 0.2f);
  for (const double eta : {1.0, 1.3, 2.5}) {
    for (const float sine : {0.0f, 0.7f, 0.95f}) {
      CAPTURE(eta);
      CAPTURE(sine);
      const GpuWalk result =
          walk(device.context, {.level = level,
                                .optical = uniform(glm::vec3(0), glm::vec3(0)),
                                .quarter_q = lit_side({-1, 0, 0}),
                                .beam = {gpu::BEAM_DIRECTIONAL, {std::sqrt(1 - sine * sine), 0, sine}, {}, {}},
                                .eta = eta});
      check_balance(result, 1e-6);
      CHECK(total(result.deposit) == glm::dvec3(0));
      CHECK(result.power.absorbed == glm::dvec3(0));
      // What enters meets the far face first: 1 - R passes, R comes back, and so on.
      const double r = internal_reflectance(refracted_cosine(std::sqrt(1 - double{sine} * sine), eta), eta);
      glm::dvec3 far(0), near(0);
      for (std::uint32_t f = 0; f < level.faces.size(); ++f) {
        const float x = lit_face(level, f).normal.x;
        if (x > 0.999f) far += result.unscattered[f];
        if (x < -0.999f) near += result.unscattered[f];
        if (std::abs(x) <= 0.999f) CHECK(result.unscattered[f] == glm::dvec3(0));
      }
      for (int c = 0; c < 3; ++c) {
        CHECK(far[c] / result.entered[c] == doctest::Approx(1 / (1 + r)).epsilon(2e-6));
        CHECK(near[c] / result.entered[c] == doctest::Approx(r / (1 + r)).epsilon(2e-6));
      }
    }
  }
}

TEST_CASE("light comes out where Snell's law takes it") {
  CheckedContext device;
  const OwnedLevel level = box_level(8, 8.0f);
  for (const double eta : {1.0, 1.5, 2.0}) {
    std::uint32_t entry = 0;
    const glm::vec3 wanted(0, 2.3f, 1.6f);
    for (std::uint32_t f = 0; f < level.faces.size(); ++f) {
      if (glm::distance(lit_face(level, f).centre, wanted) < glm::distance(lit_face(level, entry).centre, wanted))
        entry = f;
    }
    const Lit at = lit_face(level, entry);
    REQUIRE(at.normal.x < -0.999f);
    const glm::dvec3 outside = glm::normalize(glm::dvec3(1, 0.1, 0.6));
    const GpuWalk result = walk(
        device.context, {.level = level,
                         .optical = uniform(glm::vec3(0), glm::vec3(0)),
                         .quarter_q = [&](const Lit& lit, std::uint32_t) { return lit.face == entry ? 1.0f : 0.0f; },
                         .beam = {gpu::BEAM_DIRECTIONAL, glm::vec3(outside), {}, {}},
                         .eta = eta});
    const double sine_over_cosine =
        std::sqrt(1 / (refracted_cosine(outside.x, eta) * refracted_cosine(outside.x, eta)) - 1);
    const glm::dvec3 sideways = glm::normalize(glm::dvec3(0, outside.y, outside.z));
    const glm::dvec3 expected = glm::dvec3(8, at.centre.y, at.centre.z) + 8 * sine_over_cosine * sideways;
    REQUIRE(expected.z < 8);
    std::uint32_t brightest = 0;
    for (std::uint32_t f = 0; f < level.faces.size(); ++f) {
      if (result.unscattered[f].x > result.unscattered[brightest].x) brightest = f;
    }
    const Lit out = lit_face(level, brightest);
    CAPTURE(eta);
    CHECK(out.normal.x > 0.999f);
    // Inside the triangle that lights up: within its longest distance from centroid to corner, 1 mm cells.
    CHECK(glm::distance(glm::dvec3(out.centre), expected) < std::sqrt(5.0) / 3);
    CHECK(result.unscattered[brightest].x / result.entered.x ==
          doctest::Approx(1 - internal_reflectance(refracted_cosine(outside.x, eta), eta)).epsilon(1e-5));
  }
}

TEST_CASE("nothing leaves beyond the critical angle") {
  CheckedContext device;
  const OwnedLevel level = box_level(4, 4.0f, 0.2f);
  // What came in through x = 0 is at most asin(1/1.5) = 41.8 degrees from x, so 48.2 degrees or more from y and z.
  const GpuWalk result = walk(device.context, {.level = level,
                                               .optical = uniform(glm::vec3(0), glm::vec3(0)),
                                               .quarter_q = lit_side({-1, 0, 0}),
                                               .beam = {gpu::BEAM_LAMBERTIAN, {}, {}, {}},
                                               .eta = 1.5});
  check_balance(result, 1e-6);
  for (std::uint32_t f = 0; f < level.faces.size(); ++f) {
    if (std::abs(lit_face(level, f).normal.x) < 0.5f) CHECK(result.unscattered[f] == glm::dvec3(0));
  }
  CHECK(total(result.unscattered).x == doctest::Approx(result.entered.x).epsilon(1e-6));
}

TEST_CASE("light that a clear body traps ends as unscattered, in finite time") {
  CheckedContext device;
  const OwnedLevel level = level_from_tets({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2, 3}});
  const GpuWalk result = walk(device.context, {.level = level,
                                               .optical = uniform(glm::vec3(0), glm::vec3(0)),
                                               .quarter_q = [](const Lit&, std::uint32_t) { return 1.0f; },
                                               .beam = {gpu::BEAM_LAMBERTIAN, {}, {}, {}},
                                               .eta = 3});
  check_balance(result, 1e-6);
  CHECK(result.power.unscattered.x == doctest::Approx(result.entered.x).epsilon(1e-6));
  CHECK(total(result.unscattered).x < 0.9 * result.entered.x);
}
