// What a material looks like, for the panel: its colour, and how far light goes in it.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shaders/shared/shared.h"

namespace quadgraph {

struct MaterialLook {
  glm::vec3 colour{0};  // that a thick body shows in white light, linear
  glm::vec3 second{0};  // the same where its pattern is 1
  float distance = 1;   // 1 / (sigma_s' + sigma_a) of the mean coefficients, mm
  float eta = 1;

  bool operator==(const MaterialLook&) const = default;
};

MaterialLook look_of(const gpu::Material& material);

// Of a text that parse_material reads; none where it is of no such material, as a volume's. The last one is kept.
const std::optional<MaterialLook>& look_of(const std::string& material);

// The text of a material of that colour, as far as it can be had, distance and index, without a pattern.
std::string material_of(const MaterialLook& look);

// A material that has a name.
struct Swatch {
  std::string name;
  MaterialLook look;
};

// All of them, in the order in which they are listed; made at first use.
const std::vector<Swatch>& swatches();

}  // namespace quadgraph
