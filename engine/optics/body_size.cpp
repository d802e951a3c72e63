#include "engine/optics/body_size.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <optional>

#include "engine/base/text.h"
#include "engine/optics/named_materials.h"
#include "engine/optics/surface_boundary.h"

namespace quadgraph {
namespace {

// A colour is another one where a channel is so far below or above what it should be, encoded as sRGB, the brightest
// channel being 1. On bunnies of 30, 80 and 300 mm that look as their names say it is .14 below and .20 above at most,
// on the one that does not, of honey and 300 mm, .21 below. A pale colour still is of the same material.
constexpr double deeper_colour = 0.18, paler_colour = 0.3;

// A body is clear that scatters less than this share of what it is meant to scatter.
constexpr double clear_share = 1.0 / 3;

constexpr double deepest = 1e9;  // mean chord of a body through which no light comes, mm

// Of a layer that diffuse light enters from both sides: Kubelka and Munk 1931, of half of it over a mirror. The mean
// chord of a layer is twice its thickness, so that without scattering exp(-sigma_a chord) is left.
double sent_back(double scattering, double absorption, double chord) {
  const double s = 0.75 * scattering * chord / 4, k = 2 * absorption * chord / 4;
  if (k == 0) return 1;
  if (s < 1e-9) return std::exp(-2 * k);
  const double a = 1 + k / s, b = std::sqrt(a * a - 1), c = b / std::tanh(b * s);
  return (1 - a + c) / (a - 1 + c);
}

double scattered_share(const gpu::Material& material, double chord) {
  const glm::dvec3 s(material.sigma_s_prime);
  return -std::expm1(-std::max({s.x, s.y, s.z}) * chord);
}

double encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

// sRGB of a colour at an exposure that makes its brightest channel 1.
glm::dvec3 shown(const glm::dvec3& colour) {
  const double most = std::max({colour.x, colour.y, colour.z});
  if (!(most > 0)) return glm::dvec3(0);
  return {encoded(colour.x / most), encoded(colour.y / most), encoded(colour.z / most)};
}

std::string hex(const glm::dvec3& colour) {
  const glm::dvec3 bytes = glm::round(255.0 * colour);
  char text[16];
  std::snprintf(text, sizeof(text), "#%02X%02X%02X", static_cast<unsigned>(bytes.x), static_cast<unsigned>(bytes.y),
                static_cast<unsigned>(bytes.z));
  return text;
}

std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), value < 9.95 ? "%.2g" : "%.0f", value);
  return text;
}

// The mean chord at which a text's material looks as promised; nothing where a text promises nothing.
std::optional<double> promised_chord(std::string_view text) {
  const auto parts = split(text, ',');
  const auto says = [&](std::string_view key) {
    return std::any_of(parts.begin(), parts.end(),
                       [&](std::string_view part) { return part.substr(0, part.find('=')) == key; });
  };
  if (says("reflectance")) return deepest;
  const bool own = says("sigma_s_prime") || says("sigma_s") || says("sigma_a");
  return named_material(parts[0]) && !own ? std::optional(meant_chord) : std::nullopt;
}

// Share of diffuse light that the surface reflects back into the body.
double reflected_inside(const gpu::Material& material) {
  const auto eta = static_cast<double>(material.eta);
  return 1 - diffuse_transmittance(eta) / (eta * eta);
}

glm::dvec3 colour_of(const gpu::Material& material, double inside, double chord) {
  glm::dvec3 colour;
  for (int c = 0; c < 3; ++c) {
    const double back = sent_back(static_cast<double>(material.sigma_s_prime[c]),
                                  static_cast<double>(material.sigma_a[c]), std::min(chord, deepest));
    colour[c] = (1 - inside) * back / (1 - inside * back);
  }
  return colour;
}

struct Look {
  glm::dvec3 colour;  // as `shown`
  double scattered;   // share of the light
};

// Looks of a material by the mean chord.
struct Looks {
  const gpu::Material& material;
  double inside = reflected_inside(material);

  Look operator()(double chord) const {
    return {shown(colour_of(material, inside, chord)), scattered_share(material, chord)};
  }
};

bool is_clear(const Look& found, const Look& meant) {
  return found.scattered < clear_share * meant.scattered;
}

bool has_other_colour(const Look& found, const Look& meant) {
  const glm::dvec3 above = found.colour - meant.colour;
  return std::min({above.x, above.y, above.z}) <= -deeper_colour ||
         std::max({above.x, above.y, above.z}) >= paler_colour;
}

// By how much a body's size, or the coefficients, are to be multiplied so that the material looks as meant.
double remedy(const Looks& looks, double chord, double promised) {
  if (promised < deepest) return promised / chord;
  const Look meant = looks(promised);
  double factor = 1;
  for (Look found = looks(chord); is_clear(found, meant) || has_other_colour(found, meant);) {
    factor *= 1.1;
    found = looks(factor * chord);
  }
  return factor;
}

}  // namespace

glm::dvec3 body_colour(const gpu::Material& material, double chord) {
  return colour_of(material, reflected_inside(material), chord);
}

std::string size_warning(std::string_view text, const gpu::Material& material, double chord) {
  const std::optional<double> promised = promised_chord(text);
  if (!promised || !(chord > 0) || !std::isfinite(chord)) return "";
  const Looks looks{material};
  const Look found = looks(chord), meant = looks(*promised);
  const bool clear = is_clear(found, meant);
  if (!clear && !has_other_colour(found, meant)) return "";
  const bool by_name = *promised < deepest;
  const std::string body = "a body that light crosses in " + digits(chord) + " mm on average";
  const double factor = remedy(looks, chord, *promised), times = factor > 1 ? factor : 1 / factor;
  const std::string size = digits(times) + (factor > 1 ? " times as large" : " times smaller"),
                    numbers = digits(times) + (factor > 1 ? " times as large" : " times smaller");
  std::string said = by_name ? std::string(split(text, ',')[0]) + ": " : "reflectance: ";
  said += clear ? body + " is nearly clear of it: " + digits(100 * found.scattered) + "% of the light is scattered, " +
                      digits(100 * meant.scattered) + "% are meant"
                : body + " shows about " + hex(found.colour) + ", not " + hex(meant.colour) + " as it is meant";
  return said + "; one " + size + " (--longest, --unit) looks as meant, or this one with " +
         (by_name ? "sigma_s_prime and sigma_a " + numbers : "a mean_free_path " + digits(times) + " times smaller");
}

}  // namespace quadgraph
