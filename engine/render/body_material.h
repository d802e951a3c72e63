// What one of several bodies in a file is made of.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "engine/file/graph.h"
#include "engine/optics/material.h"

namespace quadgraph {

struct BodyMaterial {
  std::string text{};  // as it was said
  float eta = default_eta;
  float roughness = default_roughness;  // GGX alpha
  Coat coat{};
  bool wants_depth = false;
  ScatteringAngles angles{};
  // Coefficients at points, mm, in the shape at rest; depths: mm below the surface, empty unless they are wanted.
  std::function<std::vector<gpu::Optical>(std::span<const glm::vec3> points, std::span<const float> depths)> at{};
};

// At points of a level, mm at rest, each by the material of its body.
std::vector<gpu::Optical> coefficients(const Level& level, std::span<const glm::vec3> points,
                                       const std::function<std::uint32_t(std::uint32_t)>& body_of,
                                       std::span<const BodyMaterial> materials);

// Of a material's text. Throws InputError as parse_material.
BodyMaterial body_material(const std::string& text);

// "cup: porcelain; stone: jade".
std::string text_of(std::span<const BodyMaterial> materials, std::span<const std::string> bodies);

// Which bodies have not the index of refraction that their material says, as they lie within another; empty if none.
// outermost: as of QuadGraph.
std::string index_warning(std::span<const BodyMaterial> materials, std::span<const std::string> bodies,
                          const std::vector<std::uint32_t>& outermost);

}  // namespace quadgraph
