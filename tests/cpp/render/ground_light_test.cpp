// The light that the ground gets from what leaves the body, against closed forms.
#include "engine/render/picture/ground_light.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "shaders/display/ground_shared.h"
#include "tests/cpp/fixtures/checked_context.h"
#include "tests/cpp/fixtures/one_body.h"
#include "tests/cpp/fixtures/render_shapes.h"

using namespace quadgraph;

namespace {

constexpr std::uint32_t side = gpu::GROUND_LIGHT_SIZE;

// Over the ground at height 0 of the axis that points up.
std::vector<glm::vec4> lit(const Shape& shape, const glm::vec3& exitance, const GroundPart& part) {
  const CheckedContext checked;
  const OneBody refractions(checked.context, 1);
  const LevelBuffers level = upload_as_level(checked.context, shape, 0, refractions);
  const std::vector<glm::vec3> values(shape.faces.size(), exitance);
  const auto leaving = device::upload<glm::vec3>(checked.context, values, "exitance");
  Level at_rest;
  at_rest.vertices = shape.vertices;
  at_rest.faces = shape.faces;
  GroundLight light(checked.context, at_rest);
  device::Commands commands(checked.context);
  light.record(commands, {at_rest, level, leaving}, part);
  commands.submit_and_wait();
  return device::download<glm::vec4>(checked.context, light.light());
}

double far_of(std::uint32_t texel, const GroundPart& part) {
  const glm::dvec2 at(texel % side + 0.5, texel / side + 0.5);
  return double{part.half_width} * glm::length(2.0 * at / double{side} - 1.0);
}

}  // namespace

TEST_CASE(
    "under a ball of exitance M the ground has the irradiance M r^2 h / d^3, and the ball that share of its sky") {
  const glm::vec3 exitance(3, 2, 0.5f);
  for (const bool z_up : {false, true}) {
    for (const float height : {12.0f, 25.0f}) {
      CAPTURE(height);
      const glm::vec3 up = z_up ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0), aside = glm::vec3(4, 4, 4) - 4.0f * up;
      const GroundPart part{.middle = aside, .half_width = 60, .z_up = z_up};
      const auto light = lit(sphere(aside + height * up, 10, 5), exitance, part);
      for (std::uint32_t i = 0; i < light.size(); ++i) {
        const double expected = 100 * height / std::pow(std::hypot(height, far_of(i, part)), 3);
        const double tolerance = height < 20 ? 0.05 : 0.01;  // worse where patches are near
        CHECK(light[i].w == doctest::Approx(expected).epsilon(tolerance));
        for (int c = 0; c < 3; ++c) CHECK(light[i][c] == doctest::Approx(exitance[c] * light[i].w).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("the ground within reach gets the power that goes there: half of a ball's, less what goes beyond") {
  const double height = 20, half_width = 60, radius = 10;
  const GroundPart part{.middle = {0, 0, 0}, .half_width = static_cast<float>(half_width)};
  const auto light = lit(sphere({0, static_cast<float>(height), 0}, radius, 5), glm::vec3(1), part);
  double power = 0;
  const double texel = std::pow(2 * half_width / side, 2);
  for (std::uint32_t i = 0; i < light.size(); ++i) {
    if (far_of(i, part) < half_width) power += light[i].x * texel;
  }
  const double within = 1 - height / std::hypot(height, half_width);
  CHECK(power == doctest::Approx(2 * std::numbers::pi * radius * radius * within).epsilon(0.01));
}

TEST_CASE("under a plate that is nearer than its parts are wide there are no holes between these") {
  // 40 mm wide, 0.4 mm above: parts are a millimetre wide, some of them two. Its upper side is not seen.
  Shape plate;
  constexpr int cells = 40;
  for (int i = 0; i <= cells; ++i) {
    for (int k = 0; k <= cells; ++k) {
      plate.vertices.emplace_back(i - 0.5f * cells, 0.4f, k - 0.5f * cells);
      if (i == cells || k == cells) continue;
      const auto at = static_cast<std::uint32_t>((cells + 1) * i + k), across = at + cells + 1;
      plate.faces.emplace_back(at, across, across + 1);
      plate.faces.emplace_back(at, across + 1, at + 1);
    }
  }
  const GroundPart part{.middle = {0, 0, 0}, .half_width = 30};
  const auto light = lit(plate, glm::vec3(1), part);
  for (std::uint32_t i = 0; i < light.size(); ++i) {
    if (far_of(i, part) > 15) continue;
    CHECK(light[i].w > 0.4f);
    CHECK(light[i].w < 1.0001f);
  }
}

TEST_CASE("no ground gets more than its whole sky") {
  const auto light = lit(sphere({0, 10.001f, 0}, 10, 4), glm::vec3(1), {.middle = {0, 0, 0}, .half_width = 3});
  float most = 0;
  for (const glm::vec4& texel : light) {
    CHECK(texel.w <= 1.0001f);
    most = std::max(most, texel.w);
  }
  CHECK(most > 0.5f);
}
