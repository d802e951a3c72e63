#include "engine/render/picture/tone_map.h"

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/render/picture/picture.h"

namespace quadgraph {
namespace {

double luminance(const Picture& picture, std::size_t pixel) {
  constexpr double weight[3] = {0.2126, 0.7152, 0.0722};  // ITU-R BT.709
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum += weight[c] * static_cast<double>(picture.radiance(3 * pixel + c));
  }
  return sum;
}

}  // namespace

float filmic(float radiance) {
  const float x = std::max(radiance, 0.0f);
  // The curve is 1 from x = 7.4 on; the bound keeps the quotient finite for any x.
  if (!(x < 1e3f)) return 1.0f;
  return std::min(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 1.0f);
}

float srgb_encode(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float exposure_for(const Brightness& seen) {
  if (!(seen.luminance > 0)) return 0;
  return static_cast<float>(
      std::min(std::log2(exposure_bright / seen.luminance), std::log2(exposure_most / seen.brightest)));
}

float auto_exposure(const Picture& picture) {
  std::vector<double> luminances, brightest;
  for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
    if (picture.alpha[i] != 1.0f) continue;
    luminances.push_back(luminance(picture, i));
    brightest.push_back(static_cast<double>(
        std::max({picture.radiance(3 * i), picture.radiance(3 * i + 1), picture.radiance(3 * i + 2)})));
  }
  if (luminances.empty()) return 0;
  const auto quantile = [](std::vector<double>& values) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(exposure_quantile * static_cast<double>(values.size()));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  return exposure_for({quantile(luminances), quantile(brightest)});
}

float exposure_of(const Picture& picture, const ToneOptions& options) {
  if (picture.false_colour) return options.exposure_stops.value_or(0.0f);
  return options.exposure_stops ? *options.exposure_stops : auto_exposure(picture);
}

std::optional<float> parse_exposure(std::string_view text) {
  if (text == "auto") return std::nullopt;
  return static_cast<float>(parse_number(text, "exposure (auto or stops)"));
}

void parse_background(std::string_view text, ToneOptions& options) {
  options.transparent = text == "transparent";
  if (text == "studio") {
    options.background_top = ToneOptions().background_top;
    options.background_bottom = ToneOptions().background_bottom;
    return;
  }
  const glm::vec3 colour = text == "black" || options.transparent ? glm::vec3(0)
                           : text == "white"
                               ? glm::vec3(1)
                               : parse_rgb(text, "background (studio, black, white, transparent, grey or R/G/B)");
  if (glm::any(glm::lessThan(colour, glm::vec3(0))) || glm::any(glm::greaterThan(colour, glm::vec3(1)))) {
    throw InputError("background: found '" + std::string(text) + "', expected values in [0, 1]");
  }
  options.background_top = options.background_bottom = colour;
}

}  // namespace quadgraph
