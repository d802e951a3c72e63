// Light from all around, as a picture of the surroundings says: what is smooth in it by degree, and peaks like the sun
// as lights of their own, which spherical functions and rays would blur or miss.
//
// Its own frame: right, up and ahead. The picture is a map by longitude and latitude whose middle lies ahead, whose top
// row lies up and whose right half lies to the right of what is ahead.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "engine/optics/optical_surface.h"
#include "engine/render/light/image_file.h"
#include "engine/render/light/spherical_harmonics.h"

namespace quadgraph {

// A peak of the picture.
struct Sun {
  glm::vec3 towards{0};     // unit: (right, up, ahead)
  glm::vec3 irradiance{0};  // on a plane that faces it, of texels in W/(mm^2 sr): W/mm^2
};

struct Environment {
  SphereSeries series;    // of the picture without its peaks
  std::vector<Sun> suns;  // at most four, the strongest first
};

// Degree of the series: structures of 3 degrees.
inline constexpr int environment_degree = 64;

Environment environment_of(Image picture);

// The peaks of a picture, which it has afterwards no longer. One is connected texels more than 16 times as bright as
// the rest of the picture is on average, within a cone of 6 degrees, that bring at least a hundredth of the light. As
// much of them as is that bright stays.
std::vector<Sun> take_suns(Image& picture);

// What the kernels below make of the degrees, up to `degree`.
// Irradiance that enters a face by the direction of its normal: max(cos, 0) F_t(cos).
std::vector<double> irradiance_degrees(const OpticalSurface& surface, int degree);
// Radiance as rays see it that stand for 1/256 of a hemisphere.
std::vector<double> ray_degrees(int degree);
// Radiance that a surface of GGX roughness `alpha` reflects, over its reflectance, by the mirrored view: the light that
// arrives, weighted with the lobe of a view along the normal (Karis 2013), without structures finer than a ray's.
std::vector<double> reflection_degrees(double alpha, int degree);

}  // namespace quadgraph
