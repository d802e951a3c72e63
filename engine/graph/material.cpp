#include "engine/graph/material.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "engine/graph/colour.h"
#include "engine/graph/error.h"
#include "engine/graph/fresnel.h"

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

constexpr std::string_view marble_veins = "marble-veins";
constexpr float default_eta = 1.3f;

gpu::Material homogeneous(const glm::vec3& sigma_s_prime, const glm::vec3& sigma_a, float eta) {
  gpu::Material material{};
  material.sigma_s_prime = sigma_s_prime;
  material.sigma_a = sigma_a;
  material.eta = eta;
  material.kind = gpu::MATERIAL_HOMOGENEOUS;
  material.vein_sigma_s_prime = sigma_s_prime;
  material.vein_sigma_a = sigma_a;
  material.vein_period = 16.0f;
  material.vein_sharpness = 14.0f;
  return material;
}

std::optional<gpu::Material> named(std::string_view name) {
  const bool veins = name == marble_veins;
  const std::string_view wanted = veins ? "marble" : name;
  const auto row = std::find_if(measured.begin(), measured.end(), [&](const auto& m) { return m.name == wanted; });
  if (row == measured.end()) return std::nullopt;
  gpu::Material material = homogeneous(row->sigma_s_prime, row->sigma_a, row->eta);
  if (veins) {
    material.kind = gpu::MATERIAL_MARBLE_VEINS;
    material.vein_sigma_s_prime = {1.2f, 1.2f, 1.2f};
    material.vein_sigma_a = {0.85f, 0.78f, 0.74f};
  }
  return material;
}

std::string all_names() {
  std::string names;
  for (const std::string& name : material_names()) names += (names.empty() ? "" : ", ") + name;
  return names;
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

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

glm::vec3 parse_colour(std::string_view key, std::string_view text) {
  const auto parts = split(text, '/');
  if (parts.size() == 1) return glm::vec3(parse_number(key, text));
  if (parts.size() != 3) bad_field(key, text, "one number or R/G/B");
  return {parse_number(key, parts[0]), parse_number(key, parts[1]), parse_number(key, parts[2])};
}

// A colour in place of coefficients.
struct Shown {
  std::optional<glm::vec3> reflectance, mean_free_path;

  bool set(std::string_view key, std::string_view value) {
    auto& field = key == "reflectance" ? reflectance : mean_free_path;
    if (key != "reflectance" && key != "mean_free_path") return false;
    field = parse_colour(key, value);
    return true;
  }
};

// Replaces the coefficients by those that look like that.
void show(gpu::Material& material, const Shown& shown) {
  for (int c = 0; c < 3; ++c) {
    const float length = (*shown.mean_free_path)[c];
    if (!(length > 0)) bad_field("mean_free_path", std::to_string(length), "a number > 0 (mm)");
    const double albedo = albedo_of(static_cast<double>((*shown.reflectance)[c]), static_cast<double>(material.eta));
    material.sigma_s_prime[c] = static_cast<float>(albedo / static_cast<double>(length));
    material.sigma_a[c] = static_cast<float>((1 - albedo) / static_cast<double>(length));
  }
}

// Sets one field; false if the key is unknown.
bool set_field(gpu::Material& material, std::string_view key, std::string_view value) {
  if (key == "sigma_s_prime") {
    material.sigma_s_prime = parse_colour(key, value);
  } else if (key == "sigma_a") {
    material.sigma_a = parse_colour(key, value);
  } else if (key == "eta") {
    material.eta = parse_number(key, value);
  } else if (material.kind != gpu::MATERIAL_MARBLE_VEINS) {
    return false;
  } else if (key == "vein_sigma_s_prime") {
    material.vein_sigma_s_prime = parse_colour(key, value);
  } else if (key == "vein_sigma_a") {
    material.vein_sigma_a = parse_colour(key, value);
  } else if (key == "vein_period") {
    material.vein_period = parse_number(key, value);
  } else if (key == "vein_sharpness") {
    material.vein_sharpness = parse_number(key, value);
  } else {
    return false;
  }
  return true;
}

std::string allowed_keys(const gpu::Material& material) {
  std::string keys = "sigma_s_prime, sigma_a, eta, or reflectance, mean_free_path, eta";
  if (material.kind == gpu::MATERIAL_MARBLE_VEINS) {
    keys += ", vein_sigma_s_prime, vein_sigma_a, vein_period, vein_sharpness";
  }
  return keys;
}

void check_colour(std::string_view key, const glm::vec3& value) {
  for (int c = 0; c < 3; ++c) {
    const bool fits = std::isfinite(value[c]) && value[c] >= 0;
    if (!fits) bad_field(key, std::to_string(value[c]), "a number >= 0 (1/mm)");
  }
}

void check_range(std::string_view key, float value, float low, float high, const std::string& allowed) {
  if (!(value >= low && value <= high)) bad_field(key, std::to_string(value), allowed);
}

}  // namespace

const std::vector<std::string>& material_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Measured& m : measured) list.emplace_back(m.name);
    list.emplace_back(marble_veins);
    return list;
  }();
  return names;
}

gpu::Material parse_material(std::string_view text) {
  auto parts = split(text, ',');
  gpu::Material material = homogeneous(glm::vec3(-1), glm::vec3(-1), default_eta);
  const bool starts_with_name = parts[0].find('=') == std::string_view::npos;
  if (starts_with_name) {
    const auto found = named(parts[0]);
    if (!found) {
      throw InputError("material '" + std::string(parts[0]) + "': allowed are " + all_names() +
                       ", or sigma_s_prime=...,sigma_a=...,eta=...");
    }
    material = *found;
    parts.erase(parts.begin());
  }
  Shown shown;
  std::vector<std::string_view> seen;
  for (std::string_view part : parts) {
    const std::size_t at = part.find('=');
    const std::string_view key = part.substr(0, at);
    if (at == std::string_view::npos) bad_field(part, part, "key=value");
    if (std::find(seen.begin(), seen.end(), key) != seen.end()) bad_field(key, part, "one value");
    const std::string_view value = part.substr(at + 1);
    if (!shown.set(key, value) && !set_field(material, key, value)) bad_field(key, part, allowed_keys(material));
    seen.push_back(key);
  }
  const auto given = [&](std::string_view key) { return std::find(seen.begin(), seen.end(), key) != seen.end(); };
  const bool by_colour = shown.reflectance || shown.mean_free_path;
  using Required = std::array<std::string_view, 2>;
  for (std::string_view required :
       by_colour ? Required{"reflectance", "mean_free_path"} : Required{"sigma_s_prime", "sigma_a"}) {
    if (!given(required) && (by_colour || !starts_with_name))
      bad_field(required, "nothing", "a value (it is required)");
  }
  for (std::string_view other : {"sigma_s_prime", "sigma_a"}) {
    if (by_colour && given(other)) bad_field(other, "a value", "none beside reflectance and mean_free_path");
  }
  check_range("eta", material.eta, static_cast<float>(min_eta), static_cast<float>(max_eta), "1 to 3");
  if (by_colour) show(material, shown);
  check_material(material);
  return material;
}

void check_material(const gpu::Material& material) {
  check_colour("sigma_s_prime", material.sigma_s_prime);
  check_colour("sigma_a", material.sigma_a);
  check_range("eta", material.eta, static_cast<float>(min_eta), static_cast<float>(max_eta), "1 to 3");
  if (material.kind == gpu::MATERIAL_HOMOGENEOUS) return;
  if (material.kind != gpu::MATERIAL_MARBLE_VEINS) bad_field("kind", std::to_string(material.kind), "0 or 1");
  check_colour("vein_sigma_s_prime", material.vein_sigma_s_prime);
  check_colour("vein_sigma_a", material.vein_sigma_a);
  check_range("vein_period", material.vein_period, 1e-3f, 1e6f, "0.001 to 1000000 (mm)");
  check_range("vein_sharpness", material.vein_sharpness, 1.0f, 1000.0f, "1 to 1000");
}

}  // namespace quadgraph
