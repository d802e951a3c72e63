#include "engine/render/light/spherical_harmonics.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

namespace quadgraph {
namespace {

using std::numbers::pi;

std::size_t triangle(int l, int m) {
  return static_cast<std::size_t>(l * (l + 1) / 2 + m);
}

// Orthonormal associated Legendre functions of degree l and order m >= 0 at the cosine c, times sqrt 2 for m > 0.
std::vector<double> legendre(double c, int degree) {
  std::vector<double> p(triangle(degree, degree) + 1);
  const double s = std::sqrt(std::max(1 - c * c, 0.0));
  double diagonal = std::sqrt(1 / (4 * pi));
  for (int m = 0; m <= degree; ++m) {
    if (m > 0) diagonal *= s * std::sqrt((2.0 * m + 1) / (2.0 * m)) * (m == 1 ? std::numbers::sqrt2 : 1);
    p[triangle(m, m)] = diagonal;
    if (m < degree) p[triangle(m + 1, m)] = c * std::sqrt(2.0 * m + 3) * diagonal;
    for (int l = m + 2; l <= degree; ++l) {
      const double square = 1.0 * l * l - 1.0 * m * m, before = 1.0 * (l - 1) * (l - 1) - 1.0 * m * m;
      p[triangle(l, m)] =
          std::sqrt((4.0 * l * l - 1) / square) *
          (c * p[triangle(l - 1, m)] - std::sqrt(before / (4.0 * (l - 1) * (l - 1) - 1)) * p[triangle(l - 2, m)]);
    }
  }
  return p;
}

// cos and sin of m times the longitude of every column, m after m.
struct Waves {
  std::vector<double> cosine, sine;

  Waves(std::uint32_t width, int degree) {
    for (int m = 0; m <= degree; ++m) {
      for (std::uint32_t i = 0; i < width; ++i) {
        const double longitude = 2 * pi * (i + 0.5) / width - pi;
        cosine.push_back(std::cos(m * longitude));
        sine.push_back(std::sin(m * longitude));
      }
    }
  }
};

std::size_t place(int l, int m) {
  return static_cast<std::size_t>(l * l + l + m);
}

}  // namespace

SphereSeries series_of(const Image& sphere, int degree) {
  SphereSeries series{degree, std::vector<glm::dvec3>(place(degree, degree) + 1, glm::dvec3(0))};
  const Waves waves(sphere.width, degree);
  for (std::uint32_t j = 0; j < sphere.height; ++j) {
    const double top = std::cos(pi * j / sphere.height), bottom = std::cos(pi * (j + 1) / sphere.height);
    const std::vector<double> p = legendre(0.5 * (top + bottom), degree);
    const double texel = (top - bottom) * 2 * pi / sphere.width;  // sr
    for (int m = 0; m <= degree; ++m) {
      glm::dvec3 even(0), odd(0);
      for (std::uint32_t i = 0; i < sphere.width; ++i) {
        const glm::dvec3 value(sphere.texels[std::size_t{j} * sphere.width + i]);
        const std::size_t at = static_cast<std::size_t>(m) * sphere.width + i;
        even += waves.cosine[at] * value;
        odd += waves.sine[at] * value;
      }
      for (int l = m; l <= degree; ++l) {
        series.coefficients[place(l, m)] += texel * p[triangle(l, m)] * even;
        if (m > 0) series.coefficients[place(l, -m)] += texel * p[triangle(l, m)] * odd;
      }
    }
  }
  return series;
}

std::vector<double> degrees_of(const std::function<double(double)>& kernel, int degree) {
  // By the angle, in which kernels with a narrow peak or an edge are sampled well.
  constexpr int steps = 8192;
  std::vector<double> factor(static_cast<std::size_t>(degree) + 1, 0.0);
  for (int i = 0; i < steps; ++i) {
    const double angle = pi * (i + 0.5) / steps, c = std::cos(angle);
    const double weight = 2 * pi * kernel(c) * std::sin(angle) * pi / steps;
    double before = 0, p = 1;  // Bonnet's recursion
    for (int l = 0; l <= degree; ++l) {
      factor[static_cast<std::size_t>(l)] += weight * p;
      const double next = ((2 * l + 1) * c * p - l * before) / (l + 1);
      before = p;
      p = next;
    }
  }
  return factor;
}

std::vector<glm::vec3> sphere_picture(const SphereSeries& series, std::span<const double> factor, std::uint32_t width,
                                      std::uint32_t height) {
  const int degree = std::min(series.degree, static_cast<int>(factor.size()) - 1);
  const Waves waves(width, degree);
  std::vector<glm::vec3> picture;
  for (std::uint32_t j = 0; j < height; ++j) {
    const std::vector<double> p = legendre(std::cos(pi * (j + 0.5) / height), degree);
    std::vector<glm::dvec3> row(width, glm::dvec3(0));
    for (int m = 0; m <= degree; ++m) {
      glm::dvec3 even(0), odd(0);
      for (int l = m; l <= degree; ++l) {
        const double share = factor[static_cast<std::size_t>(l)] * p[triangle(l, m)];
        even += share * series.coefficients[place(l, m)];
        if (m > 0) odd += share * series.coefficients[place(l, -m)];
      }
      for (std::uint32_t i = 0; i < width; ++i) {
        const std::size_t at = static_cast<std::size_t>(m) * width + i;
        row[i] += waves.cosine[at] * even + waves.sine[at] * odd;
      }
    }
    for (const glm::dvec3& value : row) picture.push_back(glm::vec3(glm::max(value, glm::dvec3(0))));
  }
  return picture;
}

}  // namespace quadgraph
