// The standard error of a picture that is the mean of several: that of independent pictures, from their means alone.
#include "engine/render/picture/picture_noise.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

using namespace quadgraph;

namespace {

constexpr std::size_t noisy_pictures = 5;  // of three pixels, of which the body covers two
constexpr std::size_t noisy_values = 9;    // RGB of them
constexpr std::size_t covered_pixels = 2;  // pixels

struct Drawn {
  std::vector<std::vector<double>> scattered = {}, specular = {};

  Drawn() {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(0.5, 1.5);
    for (std::size_t k = 0; k < noisy_pictures; ++k) {
      scattered.emplace_back(noisy_values);
      specular.emplace_back(noisy_values);
      for (double& value : scattered.back()) value = uniform(generator);
      for (double& value : specular.back()) value = 0.1 * uniform(generator);
    }
  }

  // Of the first so many.
  Picture mean(std::size_t number) const {
    Picture picture;
    picture.width = 3;
    picture.height = 1;
    picture.unscattered.assign(noisy_values, 0.25f);
    picture.alpha = {1, 1, 0.5f};
    for (std::size_t i = 0; i < noisy_values; ++i) {
      double first = 0, second = 0;
      for (std::size_t k = 0; k < number; ++k) {
        first += scattered[k][i] / static_cast<double>(number);
        second += specular[k][i] / static_cast<double>(number);
      }
      picture.scattered.push_back(static_cast<float>(first));
      picture.specular.push_back(static_cast<float>(second));
    }
    return picture;
  }
};

// Of the mean of numbers.
double standard_error(const std::vector<double>& numbers) {
  double mean = 0, squares = 0;
  for (const double number : numbers) mean += number / static_cast<double>(numbers.size());
  for (const double number : numbers) squares += (number - mean) * (number - mean);
  return std::sqrt(squares / static_cast<double>(numbers.size() * (numbers.size() - 1)));
}

}  // namespace

TEST_CASE("the standard error of a mean of pictures follows from the means on the way there") {
  const Drawn drawn;
  PictureNoise noise;
  noise.add(drawn.mean(1));
  CHECK(noise.standard_error().empty());
  CHECK(noise.relative() == 0);
  for (std::size_t number = 2; number <= noisy_pictures; ++number) noise.add(drawn.mean(number));
  const std::vector<float> found = noise.standard_error();
  REQUIRE(found.size() == noisy_values);
  for (std::size_t i = 0; i < noisy_values; ++i) {
    std::vector<double> radiance;
    for (std::size_t k = 0; k < noisy_pictures; ++k) radiance.push_back(drawn.scattered[k][i] + drawn.specular[k][i]);
    CHECK(double{found[i]} == doctest::Approx(standard_error(radiance)).epsilon(1e-4));
  }
}

TEST_CASE("the relative noise is of scattered light, channels together, where the body covers the pixel") {
  const Drawn drawn;
  PictureNoise noise;
  for (std::size_t number = 1; number <= noisy_pictures; ++number) noise.add(drawn.mean(number));
  double squares = 0, light = 0;
  for (std::size_t pixel = 0; pixel < covered_pixels; ++pixel) {
    std::vector<double> sums(noisy_pictures);
    for (std::size_t k = 0; k < noisy_pictures; ++k) {
      for (std::size_t c = 0; c < 3; ++c) sums[k] += drawn.scattered[k][3 * pixel + c];
    }
    squares += std::pow(standard_error(sums), 2);
    double mean = 0;
    for (const double sum : sums) mean += sum / static_cast<double>(noisy_pictures);
    light += mean * mean;
  }
  CHECK(noise.relative() == doctest::Approx(std::sqrt(squares / light)).epsilon(1e-4));
}
