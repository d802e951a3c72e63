// From linear radiance to what a screen shows.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string_view>

namespace quadgraph {

struct Picture;

struct ToneOptions {
  // Radiance is multiplied by 2^stops before the curve; empty: auto_exposure of the picture.
  std::optional<float> exposure_stops{};
  // Linear display colour in [0, 1] behind the object at the top and at the bottom of the picture.
  glm::vec3 background_top{0.008f, 0.0085f, 0.01f};
  glm::vec3 background_bottom{0.05f, 0.052f, 0.057f};
  bool transparent = false;  // in PNG nothing is behind the object, neither that nor the surroundings

  bool operator==(const ToneOptions&) const = default;
};

// Filmic curve per channel: "ACES Filmic Tone Mapping Curve" (Narkowicz 2015), a rational fit to the ACES reference
// transform. 0 at 0, monotone, clamped to [0, 1].
float filmic(float radiance);

// sRGB transfer function (IEC 61966-2-1) of a linear value in [0, 1].
float srgb_encode(float linear);

// The quantile of the covered pixels' luminance that auto_exposure brings to `exposure_bright`, which the curve shows
// at three quarters of full sRGB: thin parts that glow then keep their shape above it.
inline constexpr double exposure_quantile = 0.95;
inline constexpr double exposure_bright = 0.4;

// The exposure_quantile of the brightest channel is brought to no more than this, so that surfaces of a saturated
// colour, whose luminance is low, keep their shape too.
inline constexpr double exposure_most = 0.9;

// The exposure_quantile of the luminance and of the brightest channel of covered pixels.
struct Brightness {
  double luminance = 0, brightest = 0;
};

// Stops that auto_exposure takes for a picture of that brightness.
float exposure_for(const Brightness& brightness);

// Stops that bring the quantiles to their places. Depends on nothing but the picture; 0 for a black one.
float auto_exposure(const Picture& picture);

// The stops of `options`, or else those of auto_exposure.
float exposure_of(const Picture& picture, const ToneOptions& options);

// Parses "auto" or a number of stops. Throws InputError.
std::optional<float> parse_exposure(std::string_view text);

// Parses "studio" (the default gradient), "black", "white", "transparent" (black where there is no alpha), or a linear
// grey or R/G/B in [0, 1] into `options`. Throws InputError.
void parse_background(std::string_view text, ToneOptions& options);

}  // namespace quadgraph
