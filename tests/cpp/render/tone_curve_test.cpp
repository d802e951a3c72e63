// Curves from radiance to a screen, the balance of white, and the exposure that goes with them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "engine/base/error.h"
#include "engine/render/picture/picture.h"

using namespace quadgraph;

namespace {

constexpr auto every_curve = {ToneCurve::agx_punchy, ToneCurve::agx, ToneCurve::aces, ToneCurve::linear};

glm::vec3 shown(ToneCurve curve, const glm::vec3& radiance, float stops = 0) {
  return gpu::tone_mapped(tone_transform({.curve = curve}, stops), radiance);
}

// The published general form of the sigmoid, with its scale worked out of the pivot, for AgX's numbers.
double sigmoid(double x) {
  const double pivot = 10 / 16.5, slope = 2, power = x < pivot ? 3 : 3.25;
  const double across = x < pivot ? pivot : 1 - pivot, up = 0.5;
  const double scale =
      std::pow(std::pow(slope * across, -power) * (std::pow(slope * across / up, power) - 1), -1 / power);
  const double term = slope * (x - pivot) / (x < pivot ? -scale : scale);
  return (x < pivot ? -scale : scale) * term / std::pow(1 + std::pow(term, power), 1 / power) + 0.5;
}

// sRGB codes, 0 to 1, by the published transform in double precision; the outset is the inverse of the inset. The look
// is a colour decision list of the codes between (ASC CDL: power, then saturation).
glm::dvec3 agx_codes(const glm::dvec3& radiance, double power, double saturation) {
  const glm::dmat3 inset(0.842479062253094, 0.0423282422610123, 0.0423756549057051, 0.0784335999999992,
                         0.878468636469772, 0.0784336, 0.0792237451477643, 0.0791661274605434, 0.879142973793104);
  glm::dvec3 colour = inset * radiance;
  for (int c = 0; c < 3; ++c) {
    const double stops = std::log2(std::max(colour[c], 1e-10));
    const double code = sigmoid(std::clamp((stops + 12.47393) / (4.026069 + 12.47393), 0.0, 1.0));
    colour[c] = std::pow(std::max(code, 0.0), power);
  }
  const double luminance = glm::dot(colour, {0.2126, 0.7152, 0.0722});
  colour = luminance + saturation * (colour - luminance);
  return glm::clamp(glm::inverse(inset) * colour, 0.0, 1.0);
}

// One covered pixel for each radiance.
Picture picture_of(const std::vector<glm::vec3>& radiances) {
  Picture picture{.width = static_cast<std::uint32_t>(radiances.size()),
                  .height = 1,
                  .scattered = {},
                  .specular = std::vector<float>(3 * radiances.size()),
                  .unscattered = std::vector<float>(3 * radiances.size()),
                  .transmittance = std::vector<float>(3 * radiances.size()),
                  .alpha = std::vector<float>(radiances.size(), 1)};
  for (const glm::vec3& radiance : radiances) {
    for (int c = 0; c < 3; ++c) picture.scattered.push_back(radiance[c]);
  }
  return picture;
}

}  // namespace

TEST_CASE("every curve starts at 0, never falls, ends at white and takes any number") {
  for (const ToneCurve curve : every_curve) {
    CAPTURE(name_of(curve));
    CHECK(glm::length(shown(curve, glm::vec3(0))) < 1e-6f);
    CHECK(glm::length(shown(curve, glm::vec3(-1))) < 1e-6f);
    float last = 0;
    for (int i = 1; i < 4000; ++i) {
      const glm::vec3 value = shown(curve, glm::vec3(1e-4f * std::pow(1.01f, static_cast<float>(i))));
      CHECK(value.x >= last);
      CHECK(value.x <= 1);
      CHECK(value.y == doctest::Approx(value.x).epsilon(1e-3));  // greys stay grey
      CHECK(value.z == doctest::Approx(value.x).epsilon(1e-3));
      last = value.x;
    }
    CHECK(last == doctest::Approx(1).epsilon(1e-3));
    for (const float stops : {-1e30f, 1e30f}) {
      const glm::vec3 value = shown(curve, {1e30f, NAN, INFINITY}, stops);
      CHECK(value == glm::clamp(value, 0.0f, 1.0f));
    }
  }
  CHECK(shown(ToneCurve::aces, glm::vec3(0.18f)).x ==
        doctest::Approx(0.267).epsilon(0.01));  // published at middle grey
  CHECK(srgb_encode(shown(ToneCurve::agx, glm::vec3(0.18f)).x) == doctest::Approx(0.5).epsilon(1e-3));  // the same
  CHECK(shown(ToneCurve::linear, {0.1f, 0.5f, 2}) == glm::vec3(0.1f, 0.5f, 1));
}

TEST_CASE("a picture by AgX has the codes of the published transform and of its look, within one") {
  std::vector<glm::vec3> radiances;
  for (int i = 0; i < 2000; ++i) {
    const float strength = std::exp2(-14 + 20 * static_cast<float>(i) / 2000);
    const float turn = 2.4f * static_cast<float>(i);
    radiances.push_back(strength *
                        (glm::vec3(1) + 0.95f * glm::vec3(std::cos(turn), std::cos(turn + 2), std::cos(turn + 4))));
  }
  struct Look {
    ToneCurve curve;
    double power, saturation;
  };
  for (const Look& look : {Look{ToneCurve::agx, 1, 1}, Look{ToneCurve::agx_punchy, 1.35, 1.4}}) {
    const auto bytes = to_srgb8(picture_of(radiances), {.exposure_stops = 0.0f, .curve = look.curve});
    for (std::size_t i = 0; i < radiances.size(); ++i) {
      const glm::dvec3 expected = 255.0 * agx_codes(radiances[i], look.power, look.saturation);
      for (int c = 0; c < 3; ++c) {
        CHECK(std::abs(bytes[3 * i + static_cast<std::size_t>(c)] - expected[c]) <= 1.0);
      }
    }
  }
}

TEST_CASE("what is bright loses its colour by AgX and keeps it by ACES") {
  const auto saturation = [](ToneCurve curve, float stops) {
    const glm::vec3 colour = shown(curve, {1, 0.05f, 0.02f}, stops);
    return 1 - std::min({colour.x, colour.y, colour.z}) / std::max({colour.x, colour.y, colour.z});
  };
  CHECK(saturation(ToneCurve::agx, 4) < 0.5f * saturation(ToneCurve::agx, -2));
  for (const float stops : {-2.0f, 0.0f, 2.0f}) {
    CHECK(saturation(ToneCurve::agx_punchy, stops) > saturation(ToneCurve::agx, stops));
  }
  CHECK(saturation(ToneCurve::aces, 2) > 0.9f);
}

TEST_CASE("automatic exposure brings a grey to the same place on the screen by every curve") {
  for (const ToneCurve curve : every_curve) {
    CAPTURE(name_of(curve));
    const Brightness target = exposure_target(curve), usual = exposure_target(ToneCurve::aces);
    const auto place = [&](ToneCurve by, double grey) {
      return srgb_encode(shown(by, glm::vec3(static_cast<float>(grey))).x);
    };
    CHECK(place(curve, target.luminance) == doctest::Approx(0.76).epsilon(0.01));  // three quarters of full sRGB
    CHECK(place(curve, target.luminance) == doctest::Approx(place(ToneCurve::aces, usual.luminance)).epsilon(1e-3));
    CHECK(place(curve, target.brightest) <= doctest::Approx(place(ToneCurve::aces, usual.brightest)).epsilon(1e-3));
    const Picture picture = picture_of(std::vector<glm::vec3>(50, glm::vec3(0.03f)));
    const auto bytes = to_srgb8(picture, {.curve = curve});
    CHECK(std::abs(bytes[0] - 255 * place(curve, target.luminance)) <= 1);
    const auto red = to_srgb8(picture_of(std::vector<glm::vec3>(50, glm::vec3(0.3f, 0.01f, 0.01f))), {.curve = curve});
    CHECK(red[0] > 180);
    CHECK(red[0] < (curve == ToneCurve::agx_punchy ? 255 : 250));  // its look brings a colour that bright near the edge
    CHECK(red[1] < red[0] / 2);
  }
}

TEST_CASE("the white of a colour temperature is that of the standard illuminants") {
  struct Known {
    double kelvin, x, y, off;
  };
  // A is a black body of 2856 K; D50 to D75 are stated for 1.4388 / 1.438 of their nominal temperatures.
  for (const Known& known :
       {Known{2856, 0.44757, 0.40745, 5e-4}, Known{5003, 0.34567, 0.35850, 3e-4}, Known{5503, 0.33242, 0.34743, 3e-4},
        Known{6504, 0.31271, 0.32902, 3e-4}, Known{7504, 0.29902, 0.31485, 3e-4}}) {
    const glm::dvec2 found = white_chromaticity(known.kelvin);
    CHECK(std::abs(found.x - known.x) < known.off);
    CHECK(std::abs(found.y - known.y) < known.off);
  }
  glm::dvec2 last = white_chromaticity(kelvin_range.low);
  for (double kelvin = kelvin_range.low + 1; kelvin <= kelvin_range.high; ++kelvin) {
    const glm::dvec2 next = white_chromaticity(kelvin);
    CHECK(glm::distance(next, last) < 1e-3);  // without a jump
    CHECK(next.x < last.x);                   // ever bluer
    last = next;
  }
}

TEST_CASE(
    "the balance of white makes the white of its temperature grey, as bright as before, and else changes nothing") {
  CHECK(white_balance(daylight_kelvin) == glm::mat3(1));
  // Linear sRGB of what has the chromaticity of illuminant A and luminance 1.
  const glm::dmat3 xyz_from_rgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375, 0.0721750,
                                0.9503041);
  const glm::vec3 lamp(glm::inverse(xyz_from_rgb) * glm::dvec3(1.09850, 1, 0.35585));
  CHECK(lamp.x > 3 * lamp.z);
  const glm::vec3 white = white_balance(2856) * lamp;
  for (int c = 0; c < 3; ++c) CHECK(white[c] == doctest::Approx(1).epsilon(0.01));
  // Of other temperatures it is warmer or cooler than that.
  const glm::vec3 warm = white_balance(9000) * glm::vec3(1), cool = white_balance(4000) * glm::vec3(1);
  CHECK(warm.x > 1.05f * warm.z);
  CHECK(cool.z > 1.05f * cool.x);
  const glm::vec3 usual = white_balance(6500) * glm::vec3(0.2f, 0.5f, 0.8f);
  CHECK(glm::distance(usual, glm::vec3(0.2f, 0.5f, 0.8f)) < 1e-3f);
  CHECK_THROWS_WITH_AS(check_options(ToneOptions{.white_balance = 900}), doctest::Contains("white balance: found 900"),
                       InputError);
}

TEST_CASE("a picture in lamplight is shown as grey by the balance of its temperature") {
  const glm::dmat3 xyz_from_rgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375, 0.0721750,
                                0.9503041);
  const glm::vec3 lamp(glm::inverse(xyz_from_rgb) * glm::dvec3(1.09850, 1, 0.35585));
  const Picture picture = picture_of(std::vector<glm::vec3>(10, 0.2f * lamp));
  for (const ToneCurve curve : every_curve) {
    const auto plain = to_srgb8(picture, {.curve = curve});
    const auto balanced = to_srgb8(picture, {.curve = curve, .white_balance = 2856});
    CHECK(plain[0] > plain[2] + 40);
    CHECK(std::abs(balanced[0] - balanced[2]) <= 3);
    CHECK(std::abs(balanced[1] - 194) <= 3);  // three quarters of full sRGB: the exposure sees what is shown
  }
}
