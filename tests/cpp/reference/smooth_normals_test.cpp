// Normals of the smooth surface, and rays that leave by them.
#include "engine/reference/smooth_normals.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "engine/optics/fresnel.h"
#include "engine/reference/entering.h"
#include "engine/reference/radiance.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"

using namespace quadgraph;

namespace {

glm::dvec3 corner_of(const Level& level, std::uint32_t f, std::size_t k) {
  return glm::dvec3(level.vertices[level.faces[f][static_cast<int>(k)]]);
}

// Largest distance of the corner normals of a ball from those of the sphere.
double off_the_sphere(const OwnedLevel& owned) {
  const Level level = owned.view();
  const std::vector<CornerNormals> normals = smooth_normals(level);
  double worst = 0;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    for (std::size_t k = 0; k < 3; ++k)
      worst = std::max(worst, glm::distance(normals[f][k], glm::normalize(corner_of(level, f, k))));
  }
  return worst;
}

// RMS by which the light that comes straight through a clear ball is off along rays that enter it under 30 degrees:
// after such a chord the angle with the sphere is that of the start.
double chord_error(const OwnedLevel& owned, bool smooth) {
  const Level level = owned.view();
  const std::vector<CornerNormals> normals = smooth_normals(level);
  const std::vector<glm::dvec3> phi(level.vertices.size(), glm::dvec3(0));
  Uncollided none;
  none.entry = none.depth = phi;
  const std::vector<gpu::Optical> clear(level.nodes.size(), {glm::vec3(0), glm::vec3(0)});
  const double eta = 1.4, angle = 0.5;
  const Problem problem{Method::fem, Source::buried, Model::sp3, clear, eta};
  const InsideLight light{phi, none,
                          smooth ? std::span<const CornerNormals>(normals) : std::span<const CornerNormals>()};
  const double expected = 1 - internal_reflectance(std::cos(angle), eta);
  double sum = 0;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::dvec3 centre = (corner_of(level, f, 0) + corner_of(level, f, 1) + corner_of(level, f, 2)) / 3.0;
    const glm::dvec3 n = glm::normalize(centre);
    const glm::dvec3 across = glm::normalize(glm::cross(n, glm::dvec3(0.3, -0.5, 0.81)));
    const glm::dvec3 inward = -std::cos(angle) * n + std::sin(angle) * across;
    const Gathered found = gather(level, problem, light, f, glm::dvec3(1.0 / 3), inward);
    const double error = (found.escapes.empty() ? 0.0 : found.escapes.front().share.x) - expected;
    sum += error * error;
  }
  return std::sqrt(sum / level.face_count());
}

}  // namespace

TEST_CASE("on a ball they are the sphere's") {
  for (const int n : {8, 12}) {
    CAPTURE(n);
    CHECK(off_the_sphere(ball_level(n, 10.0)) < 1e-6);
  }
}

TEST_CASE("a box stays flat: its edges are creases") {
  const OwnedLevel owned = box_level(3, 6.0f);
  const Level level = owned.view();
  const std::vector<CornerNormals> normals = smooth_normals(level);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    for (const glm::dvec3& n : normals[f]) CHECK(glm::distance(n, frame_of(level, f).normal) < 1e-6);
  }
}

TEST_CASE(
    "light comes through a clear ball as through a sphere, by the square of the edges sooner than by flat faces") {
  const double coarse = chord_error(ball_level(6, 10.0), true), fine = chord_error(ball_level(12, 10.0), true);
  CHECK(fine < coarse / 2.5);
  CHECK(fine < chord_error(ball_level(12, 10.0), false) / 4);
}
