// What the display makes of a known exitance, and the reflection of a light.
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "engine/optics/fresnel.h"
#include "engine/optics/surface_boundary.h"
#include "tests/cpp/fixtures/display_stage.h"

using namespace quadgraph;

namespace {

float brightest(const std::vector<float>& values) {
  return *std::max_element(values.begin(), values.end());
}

}  // namespace

TEST_CASE("the norm of F_t: pi without a boundary, and 1 - the outside diffuse reflectance with one") {
  CHECK(radiance_norm(1.0) == doctest::Approx(std::numbers::pi).epsilon(1e-6));
  // Diffuse reflectance from outside at eta = 1.5: 0.0918 (Duntley's closed form).
  CHECK(radiance_norm(1.5) / std::numbers::pi == doctest::Approx(1 - 0.0918).epsilon(2e-4));
}

TEST_CASE("without a boundary uniform exitance M is a flat picture of M / pi") {
  const glm::dvec3 exitance(1, 2, -0.5);
  DisplayStage stage(sphere({0, 0, 0}, 10, 5), exitance);
  const Picture picture = stage.picture({}, 1.0f, {}, 64, 48);
  std::size_t covered = 0;
  double worst = 0;
  for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
    covered += picture.alpha[i] == 1 ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = picture.alpha[i] * exitance[static_cast<int>(c)] / std::numbers::pi;
      worst = std::max(worst, std::abs(picture.scattered[3 * i + c] - expected));
    }
  }
  CHECK(worst < 1e-6);
  CHECK(brightest(picture.specular) == 0);
  // The sphere fits the height: pi/4 of a square of 48 pixels, less the margin.
  CHECK(covered > 1550);
  CHECK(covered < 1810);
}

TEST_CASE("with a boundary radiance is M F_t(cos) / norm at every pixel") {
  constexpr float radius = 10;
  DisplayStage stage(sphere({0, 0, 0}, radius, 6), glm::vec3(1));
  const View view{.azimuth = 0, .elevation = 0, .distance = 1000.0f, .up = UpAxis::y, .vertical_fov = 1.2f};
  constexpr std::uint32_t side = 129;
  const Picture picture = stage.picture({}, 1.5f, view, side, side);
  const double pixel_mm = 2 * 1000 * std::tan(0.6 * std::numbers::pi / 180) / side;
  double worst = 0;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const double u = (x + 0.5 - 0.5 * side) * pixel_mm, v = (y + 0.5 - 0.5 * side) * pixel_mm;
      const double off = (u * u + v * v) / (radius * radius);
      if (off > 0.9) continue;
      const double expected = fresnel_transmittance(std::sqrt(1 - off), 1.5) / radiance_norm(1.5);
      worst = std::max(worst, std::abs(picture.scattered[3 * (y * side + x)] / expected - 1));
    }
  }
  MESSAGE("worst relative error of the displayed radiance ", worst);
  CHECK(worst < 0.005);
}

TEST_CASE("a picture of several tiles is the one of a single tile, finer") {
  DisplayStage stage(sphere({0, 0, 0}, 10, 5), glm::vec3(0));
  // Exitance that varies evenly across the picture, so that a tile out of place shows.
  std::vector<glm::vec3> exitance = stage.shape.vertices;
  for (glm::vec3& m : exitance) m.z = m.x + m.y;
  stage.set_exitance(exitance);
  const View view{.azimuth = 0, .elevation = 0, .distance = 1000.0f, .up = UpAxis::y, .vertical_fov = 1.2f};
  const Picture large = stage.picture({}, 1.0f, view, 1024, 700);
  const Picture small = stage.picture({}, 1.0f, view, 512, 350);
  double worst = 0;
  std::size_t compared = 0;
  for (std::size_t y = 0; y < 350; ++y) {
    for (std::size_t x = 0; x < 512; ++x) {
      const std::size_t i = y * 512 + x, above = 2 * y * 1024 + 2 * x, below = above + 1024;
      const float covered = large.alpha[above] + large.alpha[above + 1] + large.alpha[below] + large.alpha[below + 1];
      if (small.alpha[i] != 1 || covered != 4) continue;
      ++compared;
      for (std::size_t c = 0; c < 3; ++c) {
        const double mean = 0.25 * (large.scattered[3 * above + c] + large.scattered[3 * above + 3 + c] +
                                    large.scattered[3 * below + c] + large.scattered[3 * below + 3 + c]);
        worst = std::max(worst, std::abs(small.scattered[3 * i + c] - mean));
      }
    }
  }
  CHECK(compared > 50000);
  // A pixel away the radiance differs by about 0.06 / pi = 0.02; the view from afar leaves nearly no perspective.
  CHECK(worst < 0.002);
}

TEST_CASE("the surface reflects where the mirror direction is, and only with a boundary") {
  constexpr float radius = 10;
  DisplayStage stage(sphere({0, 0, 0}, radius, 6), glm::vec3(0));
  // Light from the right, camera in front: the mirror normal lies half-way, at x = sin 45 degrees.
  const std::vector<Light> lights = {parse_light("directional:-1,0,0:1")};
  const View view{.azimuth = 0, .elevation = 0, .distance = 1000.0f, .up = UpAxis::y, .vertical_fov = 1.2f};
  constexpr std::uint32_t side = 257;
  const Picture picture = stage.picture(lights, 1.5f, view, side, side, 0.1f);
  std::size_t peak = 0;
  for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
    if (picture.specular[3 * i] > picture.specular[3 * peak]) peak = i;
  }
  const double pixel_mm = 2 * 1000 * std::tan(0.6 * std::numbers::pi / 180) / side;
  const double x = (static_cast<double>(peak % side) + 0.5 - 0.5 * side) * pixel_mm;
  const double y = (static_cast<double>(peak / side) + 0.5 - 0.5 * side) * pixel_mm;
  CHECK(x == doctest::Approx(radius * std::sqrt(0.5)).epsilon(0.02));
  CHECK(std::abs(y) < 0.2);
  // D = 1/(pi alpha^2), masking near 1, cos 45 on both sides: F D / (4 cos) to first order in alpha.
  const double fresnel = 1 - fresnel_transmittance(std::sqrt(0.5), 1.5);
  const double expected = fresnel / (std::numbers::pi * 0.01) / (4 * std::sqrt(0.5));
  CHECK(picture.specular[3 * peak] == doctest::Approx(expected).epsilon(0.03));

  CHECK(brightest(stage.picture(lights, 1.0f, view, side, side).specular) == 0);
}

TEST_CASE("a body in another's shadow reflects nothing") {
  Shape two = sphere({0, 0, 0}, 10, 5);
  two.append(sphere({0, 25, 0}, 12, 5));
  DisplayStage stage(two, glm::vec3(1));
  // Light straight down: the upper sphere is wider and hides the whole lower one.
  const View view{.azimuth = 0, .elevation = 0, .distance = 300.0f, .up = UpAxis::y, .vertical_fov = 20};
  const Picture picture = stage.picture({parse_light("directional:0,-1,0:1")}, 1.5f, view, 256, 256);
  float upper = 0, lower = 0;
  for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
    float& half = i < picture.alpha.size() / 2 ? upper : lower;
    half = std::max(half, picture.specular[3 * i]);
  }
  CHECK(upper > 0.01f);
  CHECK(lower < 1e-3f * upper);
}
