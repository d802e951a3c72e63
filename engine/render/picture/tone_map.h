// From linear radiance to what a screen shows.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string_view>

#include "engine/base/names.h"
#include "engine/render/picture/white_balance.h"
#include "shaders/display/tone_curve.h"

namespace quadgraph {

struct Picture;

// By the numbers that shaders/display/tone_curve.h has.
enum class ToneCurve : std::uint32_t {
  agx_punchy = TONE_AGX_PUNCHY,
  agx = TONE_AGX,
  aces = TONE_ACES,
  linear = TONE_LINEAR
};

template <>
struct Names<ToneCurve> {
  static constexpr std::string_view what = "tone";
  static constexpr auto values = std::to_array<Named<ToneCurve>>(
      {{ToneCurve::agx_punchy, "agx-punchy", "AgX with its look Punchy, darker and of stronger colours"},
       {ToneCurve::agx, "agx", "filmic, what is bright loses its colour (AgX, Sobotka 2022)"},
       {ToneCurve::aces, "aces", "filmic, each channel by itself (Narkowicz 2015)"},
       {ToneCurve::linear, "linear", "as it is, clipped where it is brighter than the screen"}});
};

struct ToneOptions {
  // Radiance is multiplied by 2^stops before the curve; empty: auto_exposure of the picture.
  std::optional<float> exposure_stops{};
  // Linear display colour in [0, 1] behind the object at the top and at the bottom of the picture.
  glm::vec3 background_top{0.008f, 0.0085f, 0.01f};
  glm::vec3 background_bottom{0.05f, 0.052f, 0.057f};
  ToneCurve curve = ToneCurve::agx_punchy;
  float white_balance = daylight_kelvin;  // colour temperature of what is shown white, in kelvin_range
  bool transparent = false;               // in PNG nothing is behind the object, neither that nor the surroundings

  bool operator==(const ToneOptions&) const = default;
};

// sRGB transfer function (IEC 61966-2-1) of a linear value in [0, 1].
float srgb_encode(float linear);

// Throws InputError for a colour temperature out of range.
void check_options(const ToneOptions& options);

// What radiance becomes on a screen: tone_mapped of shaders/display/tone_curve.h with this.
gpu::ToneTransform tone_transform(const ToneOptions& options, float exposure_stops);

// The quantile of the covered pixels' luminance that auto_exposure brings to where the curve shows three quarters of
// full sRGB: thin parts that glow then keep their shape above it.
inline constexpr double exposure_quantile = 0.95;

// The exposure_quantile of the luminance and of the brightest channel of covered pixels.
struct Brightness {
  double luminance = 0, brightest = 0;
};

// Where automatic exposure brings them, at most. Every curve shows a grey of the first as the others do. The second is
// so that surfaces of a saturated colour, whose luminance is low, keep their shape by curves that clip, and their
// colour by AgX, which takes it from what is brighter.
Brightness exposure_target(ToneCurve curve);

// Stops that auto_exposure takes for a picture of that brightness, in the balance of white that it is shown with.
float exposure_for(const Brightness& brightness, ToneCurve curve);

// Stops that bring the quantiles to their places. Depends on the picture, the curve and the balance of white; 0 for a
// black one.
float auto_exposure(const Picture& picture, const ToneOptions& options);

// The stops of `options`, or else those of auto_exposure.
float exposure_of(const Picture& picture, const ToneOptions& options);

// Parses "auto" or a number of stops. Throws InputError.
std::optional<float> parse_exposure(std::string_view text);

// Parses "studio" (the default gradient), "black", "white", "transparent" (black where there is no alpha), or a linear
// grey or R/G/B in [0, 1] into `options`. Throws InputError.
void parse_background(std::string_view text, ToneOptions& options);

}  // namespace quadgraph
