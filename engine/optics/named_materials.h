// The materials that have a name. docs/materials.md shows them.
#pragma once

#include <span>
#include <string_view>

namespace quadgraph {

struct NamedMaterial {
  std::string_view name;
  std::string_view text;    // as parse_material reads it
  std::string_view source;  // where its coefficients are from, in words
};

// In the order in which they are listed to the user.
std::span<const NamedMaterial> named_materials();

// Null if there is none of that name.
const NamedMaterial* named_material(std::string_view name);

}  // namespace quadgraph
