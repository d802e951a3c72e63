// Pictures on the sphere by degree, for smoothing: a kernel that depends on the angle alone multiplies every degree by
// a number (Ramamoorthi and Hanrahan 2001).
//
// The sphere as a picture: row j of H lies between the angles pi j / H and pi (j + 1) / H from the top, column i of W
// between the longitudes 2 pi i / W - pi and 2 pi (i + 1) / W - pi.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/render/light/image_file.h"

namespace quadgraph {

// Coefficients of the real orthonormal functions of degree l up to `degree`; l^2 + l + m is that of order m, which goes
// with cos(m longitude) for m > 0, with sin(-m longitude) for m < 0.
struct SphereSeries {
  int degree = 0;
  std::vector<glm::dvec3> coefficients;
};

SphereSeries series_of(const Image& sphere, int degree);

// 2 pi times the integral of kernel(c) P_l(c) over the cosine c from -1 to 1, for every degree up to `degree`: what a
// convolution with the kernel multiplies the degrees by.
std::vector<double> degrees_of(const std::function<double(double)>& kernel, int degree);

// The picture of width x height of the series with degree l multiplied by factor[l]; degrees beyond are left out, and
// what is negative counts as 0.
std::vector<glm::vec3> sphere_picture(const SphereSeries& series, std::span<const double> factor, std::uint32_t width,
                                      std::uint32_t height);

}  // namespace quadgraph
