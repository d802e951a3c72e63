#include "engine/optics/coat.h"

#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/optics/fresnel.h"
#include "engine/optics/material.h"

namespace quadgraph {
namespace {

constexpr std::string_view share_key = "coat", eta_key = "coat_eta", roughness_key = "coat_roughness";

// Water of 20 degrees, 589 nm [Hale 1973]; a lacquer as glTF's KHR_materials_clearcoat has it.
constexpr std::array named{NamedCoat{"water", {.share = 1, .eta = 1.333f, .roughness = 0.02f}},
                           NamedCoat{"lacquer", {.share = 1, .eta = 1.5f, .roughness = 0.03f}}};

float number_of(std::string_view key, std::string_view text, const Range& range, const std::string& also = "") {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  if (whole && range.contains(value)) return value;
  throw InputError("material field '" + std::string(key) + "': found '" + std::string(text) + "', allowed is " + also +
                   range.text());
}

bool is_of_coat(std::string_view part) {
  const std::string_view key = part.substr(0, part.find('='));
  return key == share_key || key == eta_key || key == roughness_key;
}

}  // namespace

std::span<const NamedCoat> named_coats() {
  return named;
}

bool take_coat(Coat& coat, std::string_view key, std::string_view value) {
  if (key == share_key) {
    for (const NamedCoat& each : named) {
      if (each.name != value) continue;
      coat = each.coat;
      return true;
    }
    coat.share = number_of(key, value, coat_range, "water, lacquer, or a share of the surface from ");
  } else if (key == eta_key) {
    coat.eta = number_of(key, value, {.low = min_eta, .high = max_eta});
  } else if (key == roughness_key) {
    coat.roughness = number_of(key, value, roughness_range);
  } else {
    return false;
  }
  return true;
}

// A name goes before what is said beside it, wherever it stands.
Coat stated_coat(std::string_view text) {
  Coat coat;
  for (const bool first : {true, false}) {
    for (std::string_view part : split(text, ',')) {
      const std::size_t at = part.find('=');
      if (at == std::string_view::npos) continue;
      const std::string_view key = part.substr(0, at);
      if ((key == share_key) == first) take_coat(coat, key, part.substr(at + 1));
    }
  }
  return coat;
}

std::string without_coat(std::string_view text) {
  std::string left;
  for (std::string_view part : split(text, ',')) {
    if (is_of_coat(part)) continue;
    left += (left.empty() ? "" : ",") + std::string(part);
  }
  return left;
}

std::string with_coat(std::string_view text, const Coat& coat) {
  const std::string whole = without_coat(text);
  if (coat.share == 0) return whole;
  for (const NamedCoat& each : named) {
    if (each.coat == coat) return whole + "," + std::string(share_key) + "=" + std::string(each.name);
  }
  return whole + "," + std::string(share_key) + "=" + number_text(coat.share) + "," + std::string(eta_key) + "=" +
         number_text(coat.eta) + "," + std::string(roughness_key) + "=" + number_text(coat.roughness);
}

}  // namespace quadgraph
