// What is seen of a body through its other parts.
#include "engine/reference/leaving.h"

#include <doctest/doctest.h>

#include <numbers>

#include "engine/optics/fresnel.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"

using namespace quadgraph;

namespace {

using std::numbers::pi;

// Two slabs of 2 mm across a gap of 3 mm, uniformly lit inside, the lower one `ratio` times as bright.
struct Slabs {
  OwnedLevel owned = facing_slabs(4, 10.0f, 2.0f, 3.0f);
  Level level = owned.view();
  std::vector<gpu::Optical> optical;
  std::vector<glm::dvec3> phi;
  Uncollided none;
  std::vector<VertexScale> scale;
  std::uint32_t top = 0;

  explicit Slabs(float sigma_t) {
    optical.assign(level.nodes.size(), {glm::vec3(0.8f * sigma_t), glm::vec3(0.2f * sigma_t)});
    for (const glm::vec3& p : level.vertices) phi.emplace_back(4 * pi * (p.y > 0 ? 1.0 : 5.0));
    none.entry.assign(phi.size(), glm::dvec3(0));
    none.depth.assign(phi.size(), glm::dvec3(0));
    for (std::uint32_t v = 0; v < level.surface_vertex_count; ++v) {
      scale.push_back({glm::dvec3(level.vertices[v].y > 0 ? 1.1 : 0.7), glm::dvec3(0)});
    }
    top = nearest({5, 3.5f, 3.5f});
  }

  std::uint32_t nearest(const glm::vec3& place) const {
    std::uint32_t best = 0;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      if (glm::distance(centre(f), place) < glm::distance(centre(best), place)) best = f;
    }
    return best;
  }

  glm::vec3 centre(std::uint32_t f) const { return level.nodes[level.tet_count() + f]; }

  LeavingLight along(double eta, const glm::dvec3& outside) const {
    const Problem problem{Method::fem, Source::buried, Model::sp3, optical, eta};
    return leaving(level, problem, {phi, none}, scale, top, glm::dvec3(1.0 / 3), outside);
  }
};

}  // namespace

TEST_CASE("a slab is seen through another: e^-tau of it, scaled by its own factor") {
  const glm::dvec3 up = glm::normalize(glm::dvec3(0.1, 1, -0.15));
  for (const float sigma_t : {0.2f, 0.6f, 1.2f}) {
    CAPTURE(sigma_t);
    const Slabs slabs(sigma_t);
    const LeavingLight found = slabs.along(1.0, up);
    const double left = std::exp(-2.0 * double{sigma_t} / up.y), albedo = 0.8;
    const double expected = albedo * (1 - left) * (1.1 * 1.0 + left * 0.7 * 5.0);
    CHECK(found.radiance.x == doctest::Approx(expected).epsilon(1e-5));
    CHECK(found.seen.x == doctest::Approx(left * left).epsilon(1e-5));
  }
}

TEST_CASE("behind a thick slab nothing is seen, and behind nothing all that comes through") {
  const glm::dvec3 up = glm::normalize(glm::dvec3(0.1, 1, -0.15));
  const LeavingLight thick = Slabs(4.0f).along(1.0, up);
  CHECK(thick.radiance.x == doctest::Approx(0.8 * 1.1).epsilon(1e-3));
  CHECK(thick.seen.x < 1e-3);
  // Back along this way the ray leaves the gap by its side.
  const Slabs thin(0.3f);
  const glm::dvec3 slanted = glm::normalize(glm::dvec3(0.05, 1, 1.05));
  const LeavingLight beside = thin.along(1.0, slanted);
  const double left = std::exp(-2.0 * 0.3 / slanted.y);
  CHECK(beside.seen.x == doctest::Approx(left).epsilon(1e-5));
  CHECK(beside.radiance.x == doctest::Approx(0.8 * 1.1 * (1 - left)).epsilon(1e-5));
}

TEST_CASE("radiance is at least that of the least exitance, also where the fluence undershoots") {
  const glm::dvec3 up = glm::normalize(glm::dvec3(0.1, 1, -0.15));
  Slabs slabs(4.0f);
  for (VertexScale& scale : slabs.scale) scale.least = glm::dvec3(0.4 * pi);
  CHECK(slabs.along(1.0, up).radiance.x == doctest::Approx(0.8 * 1.1).epsilon(1e-3));
  for (glm::dvec3& phi : slabs.phi) phi = -phi;
  CHECK(slabs.along(1.0, up).radiance.x == doctest::Approx(0.4).epsilon(1e-3));
}

TEST_CASE("a refracting slab takes its Fresnel share at every surface on the way") {
  const Slabs slabs(0.4f);
  const glm::dvec3 up(0, 1, 0);
  const double eta = 1.4, t = fresnel_transmittance(1.0, eta), r = 1 - t, e = std::exp(-2.0 * 0.4);
  // One slab of radiance 1 inside, with all reflections between its surfaces; its second crossing is not followed.
  const double inside = 0.8 * (1 - e) / (1 - r * e);
  const LeavingLight found = slabs.along(eta, up);
  const double expected = t / (eta * eta) * (1.1 * inside + t * t * e * 0.7 * 5.0 * inside);
  CHECK(found.radiance.x == doctest::Approx(expected).epsilon(2e-3));
}
