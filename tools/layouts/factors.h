// Half precision, and the powers of two that bring values into its range.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/gtc/packing.hpp>

#include "tools/layouts/layout.h"

namespace quadgraph::layouts {

// By what a layout multiplies before it rounds to half precision; 1 for what it does not round.
struct Factors {
  double g = 1, m = 1, b = 1, absorption = 1, relaxation = 1;
  glm::dvec3 weight{1};  // of the blocks of each channel
};

Factors factors_of(const Matrix& matrix, const Layout& layout);

inline std::uint32_t halves(double low, double high) {
  return glm::packHalf2x16({static_cast<float>(low), static_cast<float>(high)});
}

// `value` after it was kept in half precision, multiplied by `factor`.
inline double through_half(double value, double factor) {
  return static_cast<double>(glm::unpackHalf1x16(glm::packHalf1x16(static_cast<float>(value * factor)))) / factor;
}

inline glm::dvec3 through_half(const glm::dvec3& v, const glm::dvec3& factor) {
  return {through_half(v.x, factor.x), through_half(v.y, factor.y), through_half(v.z, factor.z)};
}

}  // namespace quadgraph::layouts
