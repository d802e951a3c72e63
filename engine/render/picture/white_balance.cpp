#include "engine/render/picture/white_balance.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace quadgraph {
namespace {

constexpr double black_body_until = 4000, daylight_from = 5000;  // K

double cubic(double t, double c3, double c2, double c1, double c0) {
  return ((c3 * t + c2) * t + c1) * t + c0;
}

// Between 1667 and 4000 K, or 25000 K.
glm::dvec2 black_body(double kelvin) {
  const double t = 1e3 / kelvin;
  const double x = kelvin <= 4000 ? cubic(t, -0.2661239, -0.2343589, 0.8776956, 0.179910)
                                  : cubic(t, -3.0258469, 2.1070379, 0.2226347, 0.240390);
  if (kelvin <= 2222) return {x, cubic(x, -1.1063814, -1.34811020, 2.18555832, -0.20219683)};
  if (kelvin <= 4000) return {x, cubic(x, -0.9549476, -1.37418593, 2.09137015, -0.16748867)};
  return {x, cubic(x, 3.0817580, -5.87338670, 3.75112997, -0.37001483)};
}

// Between 4000 and 25000 K.
glm::dvec2 daylight(double kelvin) {
  const double t = 1e3 / kelvin;
  const double x =
      kelvin <= 7000 ? cubic(t, -4.6070, 2.9678, 0.09911, 0.244063) : cubic(t, -2.0064, 1.9018, 0.24748, 0.237040);
  return {x, cubic(x, 0, -3.000, 2.870, -0.275)};
}

glm::dvec3 xyz_of(const glm::dvec2& white) {
  return {white.x / white.y, 1, (1 - white.x - white.y) / white.y};
}

}  // namespace

glm::dvec2 white_chromaticity(double kelvin) {
  if (kelvin <= black_body_until) return black_body(kelvin);
  if (kelvin >= daylight_from) return daylight(kelvin);
  return glm::mix(black_body(kelvin), daylight(kelvin),
                  (kelvin - black_body_until) / (daylight_from - black_body_until));
}

glm::mat3 white_balance(float kelvin) {
  if (kelvin == daylight_kelvin) return glm::mat3(1);
  // Columns of both, as GLM has them. sRGB (IEC 61966-2-1) to XYZ; XYZ to the cones of Bradford.
  const glm::dmat3 xyz_from_rgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375, 0.0721750,
                                0.9503041);
  const glm::dmat3 cones_from_xyz(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);
  const glm::dvec3 usual = cones_from_xyz * xyz_of(white_chromaticity(double{daylight_kelvin}));
  const glm::dvec3 ratio = usual / (cones_from_xyz * xyz_of(white_chromaticity(double{kelvin})));
  const glm::dmat3 scaled(ratio.x, 0, 0, 0, ratio.y, 0, 0, 0, ratio.z);
  const glm::dmat3 cones_from_rgb = cones_from_xyz * xyz_from_rgb;
  return glm::mat3(glm::inverse(cones_from_rgb) * scaled * cones_from_rgb);
}

}  // namespace quadgraph
