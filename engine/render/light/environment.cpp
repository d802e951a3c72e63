#include "engine/render/light/environment.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "engine/optics/surface_boundary.h"

namespace quadgraph {
namespace {

using std::numbers::pi;
constexpr std::uint32_t series_width = 512, series_height = 256;
constexpr double sun_contrast = 16, sun_share = 0.01;
const double sun_cone = std::cos(6 * pi / 180);
constexpr std::size_t most_suns = 4;

double brightness(const glm::vec3& radiance) {
  return (static_cast<double>(radiance.x) + static_cast<double>(radiance.y) + static_cast<double>(radiance.z)) / 3;
}

// sr, of a texel of that row.
double solid_angle(const Image& picture, std::uint32_t row) {
  const double h = picture.height;
  return (std::cos(pi * row / h) - std::cos(pi * (row + 1) / h)) * 2 * pi / picture.width;
}

glm::dvec3 direction_of(const Image& picture, std::size_t texel) {
  const double angle = pi * (static_cast<double>(texel / picture.width) + 0.5) / picture.height;
  const double longitude = 2 * pi * (static_cast<double>(texel % picture.width) + 0.5) / picture.width - pi;
  return {std::sin(angle) * std::sin(longitude), std::cos(angle), std::sin(angle) * std::cos(longitude)};
}

// Brightness above which a texel is part of a peak: a multiple of the mean over all others.
double threshold_of(const Image& picture) {
  double threshold = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 8; ++round) {
    double sum = 0, area = 0;
    for (std::size_t i = 0; i < picture.texels.size(); ++i) {
      const double value = brightness(picture.texels[i]);
      if (value > threshold) continue;
      const double own = solid_angle(picture, static_cast<std::uint32_t>(i / picture.width));
      sum += own * value;
      area += own;
    }
    threshold = sun_contrast * sum / area;
  }
  return threshold;
}

// Texels brighter than the threshold that touch `first`, marked in `taken`.
std::vector<std::size_t> patch_around(const Image& picture, std::size_t first, double threshold,
                                      std::vector<bool>& taken) {
  std::vector<std::size_t> patch = {first};
  taken[first] = true;
  const auto width = static_cast<std::ptrdiff_t>(picture.width), height = static_cast<std::ptrdiff_t>(picture.height);
  for (std::size_t k = 0; k < patch.size(); ++k) {
    const auto x = static_cast<std::ptrdiff_t>(patch[k]) % width, y = static_cast<std::ptrdiff_t>(patch[k]) / width;
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(y - 1, 0); j <= std::min(y + 1, height - 1); ++j) {
      for (std::ptrdiff_t i = x - 1; i <= x + 1; ++i) {
        const auto next = static_cast<std::size_t>(j * width + (i + width) % width);
        if (taken[next] || brightness(picture.texels[next]) <= threshold) continue;
        taken[next] = true;
        patch.push_back(next);
      }
    }
  }
  return patch;
}

struct Peak {
  Sun sun;
  double flux = 0;
  std::vector<std::size_t> texels;
  bool narrow = true;
};

Peak peak_of(const Image& picture, std::vector<std::size_t> texels, double threshold) {
  Peak peak;
  glm::dvec3 irradiance(0), towards(0);
  for (const std::size_t i : texels) {
    const double value = brightness(picture.texels[i]);
    const double excess = (1 - threshold / value) * solid_angle(picture, static_cast<std::uint32_t>(i / picture.width));
    irradiance += excess * glm::dvec3(picture.texels[i]);
    towards += excess * value * direction_of(picture, i);
    peak.flux += excess * value;
  }
  towards = glm::normalize(towards);
  for (const std::size_t i : texels) {
    peak.narrow = peak.narrow && glm::dot(direction_of(picture, i), towards) > sun_cone;
  }
  peak.sun = {glm::vec3(towards), glm::vec3(irradiance)};
  peak.texels = std::move(texels);
  return peak;
}

double ray_kernel(double angle) {
  constexpr double radius = 1.0 / 16;  // of a cone of 1/256 of a hemisphere's cosine-weighted directions
  return std::exp(-angle * angle / (radius * radius));
}

std::vector<double> normalised(std::vector<double> degrees) {
  const double whole = degrees[0];
  for (double& degree : degrees) degree /= whole;
  return degrees;
}

}  // namespace

std::vector<Sun> take_suns(Image& picture) {
  const double threshold = threshold_of(picture);
  double whole = 0;
  std::vector<bool> taken(picture.texels.size(), false);
  std::vector<Peak> peaks;
  for (std::size_t i = 0; i < picture.texels.size(); ++i) {
    const double value = brightness(picture.texels[i]);
    whole += value * solid_angle(picture, static_cast<std::uint32_t>(i / picture.width));
    if (taken[i] || value <= threshold) continue;
    peaks.push_back(peak_of(picture, patch_around(picture, i, threshold, taken), threshold));
  }
  std::erase_if(peaks, [&](const Peak& peak) { return !peak.narrow || peak.flux < sun_share * whole; });
  std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.flux > b.flux; });
  if (peaks.size() > most_suns) peaks.resize(most_suns);
  std::vector<Sun> suns;
  for (const Peak& peak : peaks) {
    suns.push_back(peak.sun);
    for (const std::size_t i : peak.texels) {
      picture.texels[i] *= static_cast<float>(threshold / brightness(picture.texels[i]));
    }
  }
  return suns;
}

Environment environment_of(Image picture) {
  std::vector<Sun> suns = take_suns(picture);
  return {series_of(resampled(picture, series_width, series_height), environment_degree), std::move(suns)};
}

std::vector<double> irradiance_degrees(const OpticalSurface& surface, int degree) {
  return degrees_of([&](double c) { return c > 0 ? c * surface_transmittance(c, surface) : 0; }, degree);
}

std::vector<double> ray_degrees(int degree) {
  return normalised(degrees_of([](double c) { return ray_kernel(std::acos(c)); }, degree));
}

std::vector<double> reflection_degrees(double alpha, int degree) {
  std::vector<double> lobe = normalised(degrees_of(
      [&](double c) {
        const double half = 0.5 * (1 + c);  // squared cosine of the angle to the half vector
        const double base = half * (alpha * alpha - 1) + 1;
        return std::max(c, 0.0) / (base * base);
      },
      degree));
  const std::vector<double> ray = ray_degrees(degree);
  for (std::size_t l = 0; l < lobe.size(); ++l) lobe[l] *= ray[l];
  return lobe;
}

}  // namespace quadgraph
