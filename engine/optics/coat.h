// A clear layer on the surface of a body, thin beside all else: a film of water, a lacquer (docs/physics.md, "Coats").
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/base/range.h"

namespace quadgraph {

struct Coat {
  float share = 0;          // of the surface that lies under it, 0 to 1
  float eta = 1.5f;         // index of refraction over that outside, 1 to 3
  float roughness = 0.03f;  // GGX alpha of its upper side, in roughness_range

  bool operator==(const Coat&) const = default;
};

inline constexpr Range coat_range{.low = 0, .high = 1};

struct NamedCoat {
  std::string_view name;
  Coat coat;
};

// "water", "lacquer".
std::span<const NamedCoat> named_coats();

// What a part "key=value" of a material's text says of the coat: coat=, a name or a share, coat_eta=,
// coat_roughness=. False if it is of something else. Throws InputError naming the field, what was found and what is
// allowed.
bool take_coat(Coat& coat, std::string_view key, std::string_view value);

// Of all parts of a material's text; none where no part speaks of one. Throws InputError as take_coat.
Coat stated_coat(std::string_view text);

// The text without what it says of a coat, and that with another one in its place.
std::string without_coat(std::string_view text);
std::string with_coat(std::string_view text, const Coat& coat);

}  // namespace quadgraph
