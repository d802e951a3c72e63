#include "engine/optics/material.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>

#include "engine/base/closest_name.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/optics/colour.h"
#include "engine/optics/fresnel.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

struct Measured {
  std::string_view name;
  glm::vec3 sigma_s_prime;  // 1/mm
  glm::vec3 sigma_a;        // 1/mm
  float eta;
};

// Jensen et al. 2001, "A Practical Model for Subsurface Light Transport", Figure 5.
const std::array<Measured, 12> measured = {{
    {"apple", {2.29f, 2.39f, 1.97f}, {0.0030f, 0.0034f, 0.046f}, 1.3f},
    {"chicken1", {0.15f, 0.21f, 0.38f}, {0.015f, 0.077f, 0.19f}, 1.3f},
    {"chicken2", {0.19f, 0.25f, 0.32f}, {0.018f, 0.088f, 0.20f}, 1.3f},
    {"cream", {7.38f, 5.47f, 3.15f}, {0.0002f, 0.0028f, 0.0163f}, 1.3f},
    {"ketchup", {0.18f, 0.07f, 0.03f}, {0.061f, 0.97f, 1.45f}, 1.3f},
    {"marble", {2.19f, 2.62f, 3.00f}, {0.0021f, 0.0041f, 0.0071f}, 1.5f},
    {"potato", {0.68f, 0.70f, 0.55f}, {0.0024f, 0.0090f, 0.12f}, 1.3f},
    {"skimmilk", {0.70f, 1.22f, 1.90f}, {0.0014f, 0.0025f, 0.0142f}, 1.3f},
    {"skin1", {0.74f, 0.88f, 1.01f}, {0.032f, 0.17f, 0.48f}, 1.3f},
    {"skin2", {1.09f, 1.59f, 1.79f}, {0.013f, 0.070f, 0.145f}, 1.3f},
    {"spectralon", {11.6f, 20.4f, 14.9f}, {0.0f, 0.0f, 0.0f}, 1.3f},
    {"wholemilk", {2.55f, 3.21f, 3.77f}, {0.0011f, 0.0024f, 0.014f}, 1.3f},
}};

// In the words that a user writes. Coefficients are made up, to look like the stone, the wood and the wax.
struct Procedural {
  std::string_view name, text;
};

const std::array<Procedural, 7> procedural = {{
    {"marble-veins",
     "marble,pattern=veins,second_sigma_s_prime=1.2,second_sigma_a=0.85/0.78/0.74,period=16,sharpness=14"},
    {"jade",
     "reflectance=0.30/0.62/0.42,mean_free_path=0.8,eta=1.6,pattern=clouds,second_reflectance=0.04/0.22/0.11,"
     "second_mean_free_path=0.6,period=14,sharpness=4"},
    {"agate",
     "reflectance=0.90/0.84/0.74,mean_free_path=0.9,eta=1.54,pattern=bands,second_reflectance=0.38/0.09/0.04,"
     "second_mean_free_path=0.5,period=5,sharpness=4"},
    {"wax",
     "reflectance=0.86/0.80/0.66,mean_free_path=0.7,eta=1.44,pattern=spots,second_reflectance=0.10/0.32/0.48,"
     "second_mean_free_path=0.5,period=7,sharpness=5"},
    {"wood",
     "reflectance=0.66/0.45/0.25,mean_free_path=0.3,eta=1.5,pattern=rings,second_reflectance=0.32/0.16/0.07,"
     "second_mean_free_path=0.25,period=5,sharpness=2"},
    {"checker",
     "reflectance=0.8,mean_free_path=0.5,eta=1.3,pattern=checker,second_reflectance=0.15/0.2/0.4,"
     "second_mean_free_path=0.5,period=12,sharpness=1"},
    {"layered-skin",
     "sigma_s_prime=1.1/1.5/1.9,sigma_a=0.05/0.22/0.5,eta=1.4,pattern=layers,second_sigma_s_prime=1.3/1.2/1.1,"
     "second_sigma_a=0.004/0.012/0.02,period=1.5,sharpness=3"},
}};

constexpr std::array<std::string_view, gpu::PATTERNS> patterns = {"none",  "veins", "clouds",  "bands",
                                                                  "rings", "spots", "checker", "layers"};
constexpr std::string_view allowed_keys =
    "pattern, eta, period, sharpness, sigma_s_prime, sigma_a, or reflectance, mean_free_path, and these four after "
    "second_";

std::string joined(std::span<const std::string_view> names) {
  std::string text;
  for (std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

std::vector<std::string_view> all_names() {
  return {material_names().begin(), material_names().end()};
}

[[noreturn]] void bad_field(std::string_view key, std::string_view found, const std::string& allowed) {
  throw InputError("material field '" + std::string(key) + "': found '" + std::string(found) + "', allowed is " +
                   allowed);
}

float parse_number(std::string_view key, std::string_view text) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    bad_field(key, text, "a finite number");
  }
  return value;
}

glm::vec3 parse_colour(std::string_view key, std::string_view text) {
  const auto parts = split(text, '/');
  if (parts.size() == 1) return glm::vec3(parse_number(key, text));
  if (parts.size() != 3) bad_field(key, text, "one number or R/G/B");
  return {parse_number(key, parts[0]), parse_number(key, parts[1]), parse_number(key, parts[2])};
}

// One of the two sets of coefficients, and a colour in place of them.
struct Set {
  std::string_view prefix;
  glm::vec3& sigma_s_prime;
  glm::vec3& sigma_a;
  std::optional<glm::vec3> reflectance = {}, mean_free_path = {};

  std::string key(std::string_view name) const { return std::string(prefix) + std::string(name); }

  bool take(std::string_view name, std::string_view value) {
    if (name == key("sigma_s_prime")) {
      sigma_s_prime = parse_colour(name, value);
    } else if (name == key("sigma_a")) {
      sigma_a = parse_colour(name, value);
    } else if (name == key("reflectance")) {
      reflectance = parse_colour(name, value);
    } else if (name == key("mean_free_path")) {
      mean_free_path = parse_colour(name, value);
    } else {
      return false;
    }
    return true;
  }

  // Coefficients that look like the colour, if one was given.
  void show(float eta) {
    const double most = diffuse_reflectance(1, static_cast<double>(eta));
    for (int c = 0; reflectance && c < 3; ++c) {
      const float length = (*mean_free_path)[c];
      if (!(length > 0)) bad_field(key("mean_free_path"), std::to_string(length), "a number > 0 (mm)");
      const auto shown = static_cast<double>((*reflectance)[c]);
      if (!(shown >= 0 && shown < most)) {
        bad_field(key("reflectance"), std::to_string(shown),
                  "0 to " + std::to_string(most) + ", which nothing that does not shine exceeds at this eta");
      }
      const double albedo = albedo_of(shown, static_cast<double>(eta));
      sigma_s_prime[c] = static_cast<float>(albedo / static_cast<double>(length));
      sigma_a[c] = static_cast<float>((1 - albedo) / static_cast<double>(length));
    }
  }
};

std::uint32_t parse_pattern(std::string_view text) {
  const auto found = std::find(patterns.begin(), patterns.end(), text);
  if (found == patterns.end()) bad_field("pattern", text, joined(patterns) + meant(text, patterns));
  return static_cast<std::uint32_t>(found - patterns.begin());
}

// Takes one field that is not a coefficient; false if there is none of that name.
bool take_field(gpu::Material& material, std::string_view key, std::string_view value) {
  if (key == "eta") {
    material.eta = parse_number(key, value);
  } else if (key == "pattern") {
    material.pattern = parse_pattern(value);
  } else if (key == "period") {
    material.period = parse_number(key, value);
  } else if (key == "sharpness") {
    material.sharpness = parse_number(key, value);
  } else {
    return false;
  }
  return true;
}

void check_colour(std::string_view key, const glm::vec3& value) {
  for (int c = 0; c < 3; ++c) {
    const bool fits = value[c] >= 0 && value[c] <= gpu::COEFFICIENT_MAX;
    if (!fits) bad_field(key, number_text(value[c]), "0 to 1e6 (1/mm)");
  }
}

void check_range(std::string_view key, float value, float low, float high, const std::string& allowed) {
  if (!(value >= low && value <= high)) bad_field(key, std::to_string(value), allowed);
}

// A material by its name. Throws InputError if there is none.
gpu::Material named(std::string_view name) {
  const auto row = std::find_if(measured.begin(), measured.end(), [&](const auto& m) { return m.name == name; });
  if (row != measured.end()) {
    return {row->sigma_s_prime, row->sigma_a, row->eta, gpu::PATTERN_NONE, row->sigma_s_prime, row->sigma_a, 10, 1};
  }
  const auto made = std::find_if(procedural.begin(), procedural.end(), [&](const auto& p) { return p.name == name; });
  if (made != procedural.end()) return parse_material(made->text);
  throw InputError("material '" + std::string(name) + "'" + meant(name, all_names()) + ": allowed are " +
                   joined(all_names()) + ", or sigma_s_prime=...,sigma_a=...,eta=...");
}

// What a text has set of a material.
class Given {
 public:
  void add(std::string_view key, std::string_view part) {
    if (has(key)) bad_field(key, part, "one value");
    keys_.push_back(key);
  }

  bool has(std::string_view key) const { return std::find(keys_.begin(), keys_.end(), key) != keys_.end(); }

  // A colour is wanted whole and without coefficients; without one, coefficients are wanted unless they are known.
  void check(const Set& set, bool known) const {
    const bool colour = set.reflectance || set.mean_free_path;
    if (known && !colour) return;
    for (std::string_view name : {"sigma_s_prime", "sigma_a"}) {
      if (colour && has(set.key(name))) bad_field(set.key(name), "a value", "none beside a reflectance");
      if (!colour && !has(set.key(name))) bad_field(set.key(name), "nothing", "a value (it is required)");
    }
    for (std::string_view name : {"reflectance", "mean_free_path"}) {
      if (colour && !has(set.key(name))) bad_field(set.key(name), "nothing", "a value (it is required)");
    }
  }

 private:
  std::vector<std::string_view> keys_;
};

}  // namespace

const std::vector<std::string>& material_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Measured& m : measured) list.emplace_back(m.name);
    for (const Procedural& p : procedural) list.emplace_back(p.name);
    return list;
  }();
  return names;
}

std::string_view material_source(std::string_view name) {
  const bool is_measured = std::any_of(measured.begin(), measured.end(), [&](const auto& m) { return m.name == name; });
  if (is_measured) return "measured: Jensen et al. 2001, Figure 5";
  named(name);
  return "made up: chosen by eye, to look like what the name says";
}

std::string_view pattern_name(const gpu::Material& material) {
  return patterns[material.pattern];
}

gpu::Material parse_material(std::string_view text) {
  auto parts = split(text, ',');
  const bool starts_with_name = parts[0].find('=') == std::string_view::npos;
  gpu::Material material{{}, {}, default_eta, gpu::PATTERN_NONE, {}, {}, 10, 1};
  if (starts_with_name) {
    material = named(parts[0]);
    parts.erase(parts.begin());
  }
  const bool had_pattern = material.pattern != gpu::PATTERN_NONE;
  Set first{"", material.sigma_s_prime, material.sigma_a};
  Set second{"second_", material.second_sigma_s_prime, material.second_sigma_a};
  Given given;
  for (std::string_view part : parts) {
    const std::size_t at = part.find('=');
    const std::string_view key = part.substr(0, at);
    if (at == std::string_view::npos) bad_field(part, part, "key=value");
    given.add(key, part);
    const std::string_view value = part.substr(at + 1);
    if (!take_field(material, key, value) && !first.take(key, value) && !second.take(key, value)) {
      bad_field(key, part, std::string(allowed_keys));
    }
  }
  given.check(first, starts_with_name);
  if (material.pattern != gpu::PATTERN_NONE) given.check(second, had_pattern);
  for (std::string_view key : {"second_sigma_s_prime", "second_sigma_a", "second_reflectance", "second_mean_free_path",
                               "period", "sharpness"}) {
    if (material.pattern == gpu::PATTERN_NONE && given.has(key)) bad_field(key, "a value", "one beside a pattern");
  }
  check_range("eta", material.eta, static_cast<float>(min_eta), static_cast<float>(max_eta), "1 to 3");
  first.show(material.eta);
  second.show(material.eta);
  check_material(material);
  return material;
}

void check_material(const gpu::Material& material) {
  check_colour("sigma_s_prime", material.sigma_s_prime);
  check_colour("sigma_a", material.sigma_a);
  check_range("eta", material.eta, static_cast<float>(min_eta), static_cast<float>(max_eta), "1 to 3");
  if (material.pattern == gpu::PATTERN_NONE) return;
  if (material.pattern >= gpu::PATTERNS) {
    bad_field("pattern", std::to_string(material.pattern), "0 to " + std::to_string(gpu::PATTERNS - 1));
  }
  check_colour("second_sigma_s_prime", material.second_sigma_s_prime);
  check_colour("second_sigma_a", material.second_sigma_a);
  check_range("period", material.period, 1e-3f, 1e6f, "0.001 to 1000000 (mm)");
  check_range("sharpness", material.sharpness, 1.0f, 1000.0f, "1 to 1000");
}

}  // namespace quadgraph
