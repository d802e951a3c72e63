#include "engine/render/picture/tone_map.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/render/picture/picture.h"

namespace quadgraph {
namespace {

double luminance(const glm::vec3& colour) {
  return 0.2126 * double{colour.x} + 0.7152 * double{colour.y} + 0.0722 * double{colour.z};  // ITU-R BT.709
}

}  // namespace

void check_options(const ToneOptions& options) {
  if (kelvin_range.contains(double{options.white_balance})) return;
  throw InputError("white balance: found " + number_text(options.white_balance) + ", expected " + kelvin_range.text() +
                   " K");
}

gpu::ToneTransform tone_transform(const ToneOptions& options, float exposure_stops) {
  // Finite, so that no radiance times it is none of all numbers.
  const float scale = std::exp2(std::clamp(exposure_stops, -100.0f, 100.0f));
  const glm::mat3 rows = scale * glm::transpose(white_balance(options.white_balance));
  return {rows[0], rows[1], rows[2], static_cast<std::uint32_t>(options.curve)};
}

float srgb_encode(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

Brightness exposure_target(ToneCurve curve) {
  switch (curve) {
    case ToneCurve::agx_punchy:
      return {1.2353, 1.2353};
    case ToneCurve::agx:
      return {0.8415, 0.9};
    case ToneCurve::linear:
      return {0.5408, 0.7805};
    default:
      return {0.4, 0.9};
  }
}

float exposure_for(const Brightness& seen, ToneCurve curve) {
  if (!(seen.luminance > 0)) return 0;
  const Brightness target = exposure_target(curve);
  return static_cast<float>(
      std::min(std::log2(target.luminance / seen.luminance), std::log2(target.brightest / seen.brightest)));
}

float auto_exposure(const Picture& picture, const ToneOptions& options) {
  const glm::mat3 balance = white_balance(options.white_balance);
  std::vector<double> luminances, brightest;
  for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
    if (picture.alpha[i] != 1.0f) continue;
    const glm::vec3 seen =
        balance * glm::vec3(picture.radiance(3 * i), picture.radiance(3 * i + 1), picture.radiance(3 * i + 2));
    luminances.push_back(luminance(seen));
    brightest.push_back(static_cast<double>(std::max({seen.x, seen.y, seen.z})));
  }
  if (luminances.empty()) return 0;
  const auto quantile = [](std::vector<double>& values) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(exposure_quantile * static_cast<double>(values.size()));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  return exposure_for({quantile(luminances), quantile(brightest)}, options.curve);
}

float exposure_of(const Picture& picture, const ToneOptions& options) {
  if (picture.false_colour) return options.exposure_stops.value_or(0.0f);
  return options.exposure_stops ? *options.exposure_stops : auto_exposure(picture, options);
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
