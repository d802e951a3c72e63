// Where a body is in the pictures of near, far and orthographic cameras, to a part of a pixel.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "tests/cpp/fixtures/display_stage.h"

using namespace quadgraph;

namespace {

constexpr std::uint32_t side = 400;  // pixels of a picture
constexpr float margin = 1.05f;      // of the picture's half height over the ball's silhouette
constexpr double least = 0.05;       // pixels

// Where what is covered lies, pixels from the picture's middle to the right and up.
glm::dvec2 middle_of(const std::vector<float>& alpha) {
  glm::dvec2 sum(0);
  double covered = 0;
  for (std::uint32_t i = 0; i < alpha.size(); ++i) {
    sum += double{alpha[i]} * glm::dvec2(i % side + 0.5 - 0.5 * side, 0.5 * side - i / side - 0.5);
    covered += alpha[i];
  }
  return sum / covered;
}

double radius_of(const std::vector<float>& alpha) {
  double covered = 0;
  for (const float a : alpha) covered += a;
  return std::sqrt(covered / std::numbers::pi);
}

// How far the silhouettes of two pictures are apart, pixels: the mean along that of a ball.
double apart(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(double{a[i]} - double{b[i]});
  return sum / (2 * std::numbers::pi * radius_of(a));
}

// Whether a pixel and all around it are covered: at the silhouette Fresnel's transmittance falls within a pixel.
bool inside(const std::vector<float>& alpha, std::size_t pixel) {
  for (const std::size_t row : {pixel - side, pixel, pixel + side}) {
    for (const std::size_t near : {row - 1, row, row + 1}) {
      if (near >= alpha.size() || alpha[near] < 1) return false;
    }
  }
  return true;
}

// From which a ball is as large in the picture as from anywhere else.
View from(float distance, float radius) {
  const double slope = margin * radius / std::sqrt(double{distance} * distance - double{radius} * radius);
  return {.azimuth = 33,
          .elevation = 21,
          .distance = distance,
          .vertical_fov = static_cast<float>(2 * std::atan(slope) * 180 / std::numbers::pi)};
}

}  // namespace

TEST_CASE("a ball in an orthographic picture has its radius, at any distance") {
  constexpr float radius = 10;
  DisplayStage stage(sphere({3, -20, 8}, radius, 6), glm::vec3(1));
  for (const float distance : {0.5f, 50.0f, 1e5f}) {
    const View view{.azimuth = 10, .elevation = 30, .distance = distance, .orthographic = 25.0f};
    const std::vector<float> alpha = stage.picture({}, 1.3f, view, side, side).alpha;
    CHECK(radius_of(alpha) == doctest::Approx(radius * side / 25).epsilon(1e-3));
    CHECK(glm::length(middle_of(alpha)) < least);
  }
}

TEST_CASE("a body stays where it is in the picture, from nearby to a kilometre away, up to parallel rays") {
  constexpr float radius = 40;
  const glm::vec3 centre(113.7f, 61.3f, -48.9f);
  DisplayStage stage(sphere(centre, radius, 6), glm::vec3(1));
  View parallel = from(1000, radius);
  parallel.orthographic = 2 * margin * radius;
  const Picture limit = stage.picture({}, 1.3f, parallel, side, side);
  CHECK(glm::length(middle_of(limit.alpha)) < least);
  for (const float distance : {50.0f, 60.0f, 400.0f, 4e3f, 1e4f, 1e5f, 1e6f}) {
    CAPTURE(distance);
    const Picture picture = stage.picture({}, 1.3f, from(distance, radius), side, side);
    const double off = glm::length(middle_of(picture.alpha)), moved = apart(picture.alpha, limit.alpha);
    MESSAGE(distance, " mm: ", off, " pixels off, silhouette ", moved, " from that of parallel rays");
    CHECK(off < least);
    CHECK(radius_of(picture.alpha) == doctest::Approx(0.5 * side / margin).epsilon(1e-3));
    if (distance < 1e4f) continue;
    CHECK(moved < least);
    double worst = 0;
    for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
      if (!inside(picture.alpha, i) || !inside(limit.alpha, i)) continue;
      worst = std::max(worst, std::abs(double{picture.scattered[3 * i]} / double{limit.scattered[3 * i]} - 1));
    }
    MESSAGE(distance, " mm: radiance at most ", worst, " off");
    CHECK(worst < 0.005);
  }
}

TEST_CASE("a tiny ball a tenth of a mm away stays where it is") {
  DisplayStage stage(sphere({13.7f, 21.3f, -8.9f}, 0.04f, 5), glm::vec3(1));
  const Picture picture = stage.picture({}, 1.3f, from(0.1f, 0.04f), side, side);
  CHECK(glm::length(middle_of(picture.alpha)) < least);
}

TEST_CASE("a tenth of a mm from its surface a body has no holes, however large it is") {
  for (const float radius : {10.0f, 1000.0f}) {
    CAPTURE(radius);
    const glm::vec3 centre(5, -7, 3);
    DisplayStage stage(sphere(centre, radius, 7), glm::vec3(1));
    const View down{.azimuth = 33, .elevation = 21, .distance = radius + 0.1f, .vertical_fov = 60};
    const Camera camera = place_camera(down, bounding_sphere(stage.shape.vertices), 1);
    const glm::vec3 eye = camera.eye, aslant = eye + camera.right - 1.6f * camera.backward;
    for (const View& view : {down, View{.vertical_fov = 60, .eye = eye, .look_at = aslant}}) {
      const Picture picture = stage.picture({}, 1.3f, view, side, side);
      CHECK(*std::min_element(picture.alpha.begin(), picture.alpha.end()) == 1);
    }
  }
}
