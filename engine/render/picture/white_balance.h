// Colours of a picture as an eye sees them that is used to light of another colour temperature.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "engine/base/range.h"

namespace quadgraph {

inline constexpr Range kelvin_range{.low = 1667, .high = 25000};

inline constexpr float daylight_kelvin = 6504;  // of D65, the white of sRGB

// CIE 1931 x, y of light of a correlated colour temperature, K in kelvin_range: of a black body below 4000 K (Kang et
// al. 2002), of daylight from 5000 K on (CIE D), between them from the one to the other.
glm::dvec2 white_chromaticity(double kelvin);

// Takes linear sRGB to linear sRGB, and the white of `kelvin` to that of daylight_kelvin with the same luminance
// (Bradford). The identity for daylight_kelvin.
glm::mat3 white_balance(float kelvin);

}  // namespace quadgraph
