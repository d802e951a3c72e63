// Functions that shaders call, where they are not those of the standard library.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/cpp/fixtures/shader_functions.h"

using namespace quadgraph::cpu::tested;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// In units of the last place of what is right.
double units_off(float found, double right) {
  const double size = std::max(std::abs(right), 1e-30);
  return std::abs(double{found} - right) / (std::exp2(std::floor(std::log2(size))) * 0x1p-23);
}

}  // namespace

TEST_CASE("logarithms are right to two units in the last place, from the least to the largest number and near 1") {
  double worst = 0;
  const auto look = [&](float x) {
    const vec3 natural = log(vec3(x)), binary = log2(vec3(x));
    worst = std::max(worst, units_off(natural.y(), std::log(double{x})));
    worst = std::max(worst, units_off(binary.z(), std::log2(double{x})));
    CHECK(log(x) == natural.x());
    CHECK(log2(x) == binary.x());
  };
  for (float x = std::numeric_limits<float>::min(); x < infinity; x *= 1.0173f) look(x);
  for (int k = 1; k <= 23; ++k) {
    look(1 + std::ldexp(1.0f, -k));
    look(1 - std::ldexp(1.0f, -k - 1));
  }
  CHECK(worst < 2);
}

TEST_CASE("logarithms of what has none are what GLSL leaves them") {
  const vec3 x(0.0f, infinity, -1.0f);
  CHECK(log(x).x() == -infinity);
  CHECK(log(x).y() == infinity);
  CHECK(std::isnan(log(x).z()));
  CHECK(log2(x).x() == -infinity);
  CHECK(std::isnan(log2(std::numeric_limits<float>::quiet_NaN())));
  CHECK(log2(8.0f) == 3);
  CHECK(log(1.0f) == 0);
}
