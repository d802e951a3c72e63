#include "engine/optics/material.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>

#include "engine/base/closest_name.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/optics/colour.h"
#include "engine/optics/fresnel.h"
#include "engine/optics/named_materials.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

constexpr std::array<std::string_view, gpu::PATTERNS> patterns = {"none",  "veins", "clouds",  "bands",
                                                                  "rings", "spots", "checker", "layers"};
constexpr std::string_view allowed_keys =
    "pattern, eta, roughness, coat, coat_eta, coat_roughness, period, sharpness, sigma_s_prime, sigma_a, or "
    "reflectance, mean_free_path, or sigma_s and g in place of sigma_s_prime, or g beside it, and these six after "
    "second_";
constexpr std::string_view roughness_key = "roughness";

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

void check_colour(std::string_view key, const glm::vec3& value) {
  for (int c = 0; c < 3; ++c) {
    const bool fits = value[c] >= 0 && value[c] <= gpu::COEFFICIENT_MAX;
    if (!fits) bad_field(key, number_text(value[c]), "0 to 1e6 (1/mm)");
  }
}

void check_g(std::string_view key, const glm::vec3& value) {
  for (int c = 0; c < 3; ++c) {
    if (!(std::abs(value[c]) < 1)) bad_field(key, number_text(value[c]), "a number above -1 and below 1");
  }
}

// One of the two sets of coefficients, and a colour in place of them, or a phase function beside the absorption.
struct Set {
  std::string_view prefix;
  glm::vec3& sigma_s_prime;
  glm::vec3& sigma_a;
  glm::vec3& known_g;
  std::optional<glm::vec3> reflectance = {}, mean_free_path = {}, sigma_s = {}, g = {};

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
    } else if (name == key("sigma_s")) {
      sigma_s = parse_colour(name, value);
    } else if (name == key("g")) {
      g = parse_colour(name, value);
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

  // The reduced coefficient, if a phase function was given (docs/physics.md, "Similarity relation").
  void reduce() {
    if (sigma_s) check_colour(key("sigma_s"), *sigma_s);
    if (!g) return;
    check_g(key("g"), *g);
    for (int c = 0; c < 3; ++c) {
      if (sigma_s) sigma_s_prime[c] = (1 - (*g)[c]) * (*sigma_s)[c];
    }
    known_g = *g;
  }
};

std::uint32_t parse_pattern(std::string_view text) {
  const auto found = std::find(patterns.begin(), patterns.end(), text);
  if (found == patterns.end()) bad_field("pattern", text, joined(patterns) + meant(text, patterns));
  return static_cast<std::uint32_t>(found - patterns.begin());
}

void check_range(std::string_view key, float value, const Range& range, const std::string& allowed) {
  if (!range.contains(value)) bad_field(key, std::to_string(value), allowed);
}

// Takes one field that is not a coefficient; false if there is none of that name. Roughness and coat are of the
// surface, and not of the coefficients: stated_roughness and stated_coat tell them.
bool take_field(gpu::Material& material, std::string_view key, std::string_view value) {
  if (key == "eta") {
    material.eta = parse_number(key, value);
  } else if (key == "pattern") {
    material.pattern = parse_pattern(value);
  } else if (key == "period") {
    material.period = parse_number(key, value);
  } else if (key == "sharpness") {
    material.sharpness = parse_number(key, value);
  } else if (key == roughness_key) {
    check_range(key, parse_number(key, value), roughness_range, roughness_range.text());
  } else {
    Coat checked;
    return take_coat(checked, key, value);
  }
  return true;
}

// A material by its name. Throws InputError if there is none.
gpu::Material named(std::string_view name) {
  if (const NamedMaterial* row = named_material(name)) return parse_material(row->text);
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

  // A colour is wanted whole and without coefficients, a phase function whole and in place of the reduced scattering;
  // without one, coefficients are wanted unless they are known.
  void check(const Set& set, bool known) const {
    if (set.reflectance || set.mean_free_path) {
      want(set, {"reflectance", "mean_free_path"});
      refuse(set, {"sigma_s_prime", "sigma_s", "g", "sigma_a"}, "none beside a reflectance");
    } else if (set.sigma_s) {
      want(set, {"sigma_s", "g"});
      refuse(set, {"sigma_s_prime"}, "none beside a sigma_s");
      if (!known) want(set, {"sigma_a"});
    } else if (!known) {
      want(set, {"sigma_s_prime", "sigma_a"});
    }
  }

 private:
  void want(const Set& set, std::initializer_list<std::string_view> names) const {
    for (std::string_view name : names) {
      if (!has(set.key(name))) bad_field(set.key(name), "nothing", "a value (it is required)");
    }
  }

  void refuse(const Set& set, std::initializer_list<std::string_view> names, const std::string& allowed) const {
    for (std::string_view name : names) {
      if (has(set.key(name))) bad_field(set.key(name), "a value", allowed);
    }
  }

  std::vector<std::string_view> keys_;
};

}  // namespace

const std::vector<std::string>& material_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const NamedMaterial& row : named_materials()) list.emplace_back(row.name);
    return list;
  }();
  return names;
}

std::string_view material_source(std::string_view name) {
  const NamedMaterial* row = named_material(name);
  if (!row) named(name);
  return row->source;
}

std::optional<float> stated_roughness(std::string_view text) {
  const auto parts = split(text, ',');
  const NamedMaterial* row = named_material(parts[0]);
  std::optional<float> found = row ? stated_roughness(row->text) : std::nullopt;
  for (std::string_view part : parts) {
    const std::size_t at = part.find('=');
    if (part.substr(0, at) == roughness_key) found = parse_number(roughness_key, part.substr(at + 1));
  }
  return found;
}

std::string_view pattern_name(const gpu::Material& material) {
  return patterns[material.pattern];
}

gpu::Material parse_material(std::string_view text) {
  auto parts = split(text, ',');
  const bool starts_with_name = parts[0].find('=') == std::string_view::npos;
  gpu::Material material{{}, {}, default_eta, gpu::PATTERN_NONE, {}, {}, 10, 1, {}, {}};
  if (starts_with_name) {
    material = named(parts[0]);
    parts.erase(parts.begin());
  }
  const bool had_pattern = material.pattern != gpu::PATTERN_NONE;
  Set first{"", material.sigma_s_prime, material.sigma_a, material.g};
  Set second{"second_", material.second_sigma_s_prime, material.second_sigma_a, material.second_g};
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
                               "second_sigma_s", "second_g", "period", "sharpness"}) {
    if (material.pattern == gpu::PATTERN_NONE && given.has(key)) bad_field(key, "a value", "one beside a pattern");
  }
  check_range("eta", material.eta, {.low = min_eta, .high = max_eta}, "1 to 3");
  first.show(material.eta);
  second.show(material.eta);
  first.reduce();
  second.reduce();
  check_material(material);
  return material;
}

ScatteringAngles angles_of(const gpu::Material& material) {
  if (material.pattern != gpu::PATTERN_NONE && material.second_g != material.g) return {.same = false};
  return {.g = material.g};
}

ScatteringAngles angles_of(std::span<const ScatteringAngles> bodies) {
  if (bodies.empty()) return {};
  const auto differs = [&](const ScatteringAngles& body) { return body != bodies[0]; };
  return std::ranges::any_of(bodies, differs) ? ScatteringAngles{.same = false} : bodies[0];
}

std::string phase_warning(const ScatteringAngles& angles, KnownAngles known) {
  if (angles.same && (known == KnownAngles::measured || angles.g == glm::vec3(0))) return "";
  const std::string where =
      ", most in bodies that are thin or absorb much (docs/accuracy.md, \"Scattering that goes forwards\"), is not in "
      "it";
  if (angles.same && known == KnownAngles::swept) {
    return "the stated error is that of sweeps, which know of the angles of scattering by two moments: what the others "
           "change" +
           where + "; at rest walks measure it";
  }
  const std::string said =
      "the stated error is that of sigma_s_prime = (1 - g) sigma_s: what the angles of scattering change besides" +
      where;
  return angles.same ? said + "; sweeps know of them, and at rest walks measure what is left"
                     : said + ", and sweeps and walks know of it only where g is the same everywhere";
}

void check_material(const gpu::Material& material) {
  check_colour("sigma_s_prime", material.sigma_s_prime);
  check_colour("sigma_a", material.sigma_a);
  check_range("eta", material.eta, {.low = min_eta, .high = max_eta}, "1 to 3");
  check_g("g", material.g);
  if (material.pattern == gpu::PATTERN_NONE) return;
  if (material.pattern >= gpu::PATTERNS) {
    bad_field("pattern", std::to_string(material.pattern), "0 to " + std::to_string(gpu::PATTERNS - 1));
  }
  check_colour("second_sigma_s_prime", material.second_sigma_s_prime);
  check_colour("second_sigma_a", material.second_sigma_a);
  check_g("second_g", material.second_g);
  check_range("period", material.period, {.low = 1e-3, .high = 1e6}, "0.001 to 1000000 (mm)");
  check_range("sharpness", material.sharpness, {.low = 1, .high = 1000}, "1 to 1000");
}

}  // namespace quadgraph
