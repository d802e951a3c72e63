#include "engine/scene/material_look.h"

#include <algorithm>
#include <glm/common.hpp>

#include "engine/base/text.h"
#include "engine/optics/colour.h"
#include "engine/optics/material.h"

namespace quadgraph {
namespace {

constexpr double brightest = 0.97;  // of the reflectance of what absorbs nothing, which has no inverse

glm::vec3 colour_of(const glm::vec3& sigma_s_prime, const glm::vec3& sigma_a, float eta) {
  glm::vec3 colour(0);
  for (int i = 0; i < 3; ++i) {
    const double scattered = double{sigma_s_prime[i]}, all = scattered + double{sigma_a[i]};
    if (all > 0) colour[i] = static_cast<float>(diffuse_reflectance(scattered / all, double{eta}));
  }
  return colour;
}

}  // namespace

MaterialLook look_of(const gpu::Material& material) {
  MaterialLook look;
  look.eta = material.eta;
  look.colour = colour_of(material.sigma_s_prime, material.sigma_a, material.eta);
  const bool mixed = material.pattern != gpu::PATTERN_NONE;
  look.second = mixed ? colour_of(material.second_sigma_s_prime, material.second_sigma_a, material.eta) : look.colour;
  const glm::vec3 all = material.sigma_s_prime + material.sigma_a;
  look.distance = 3 / std::max(all.x + all.y + all.z, 1e-6f);
  return look;
}

const std::optional<MaterialLook>& look_of(const std::string& material) {
  static std::string text;
  static std::optional<MaterialLook> look;
  if (material == text) return look;
  text = material;
  look.reset();
  try {
    look = look_of(parse_material(material));
  } catch (const std::exception&) {  // a volume's file
  }
  return look;
}

std::string material_of(const MaterialLook& look) {
  const auto most = static_cast<float>(brightest * diffuse_reflectance(1, double{look.eta}));
  const glm::vec3 colour = glm::clamp(look.colour, glm::vec3(0.001f), glm::vec3(most));
  return formatted("reflectance=%.4g/%.4g/%.4g,mean_free_path=%.4g,eta=%.4g", double{colour.x}, double{colour.y},
                   double{colour.z}, double{look.distance}, double{look.eta});
}

const std::vector<Swatch>& swatches() {
  static const std::vector<Swatch> all = [] {
    std::vector<Swatch> made;
    for (const std::string& name : material_names()) made.push_back({name, look_of(parse_material(name))});
    return made;
  }();
  return all;
}

}  // namespace quadgraph
