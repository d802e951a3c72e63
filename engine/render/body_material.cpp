#include "engine/render/body_material.h"

#include <algorithm>

#include "engine/base/text.h"
#include "engine/optics/depth.h"
#include "engine/reference/operator.h"
#include "engine/reference/tet_points.h"
#include "engine/render/body_grid.h"
#include "engine/render/engine_implementation.h"
#include "shaders/material/material.h"

namespace quadgraph {
namespace {

std::vector<gpu::Optical> at_nodes(const Level& level, std::span<const BodyMaterial> materials) {
  const auto body_of = [&](std::uint32_t node) {
    return node < level.tet_count() ? level.body_of_tet(node) : level.body_of_face(node - level.tet_count());
  };
  return coefficients(level, level.nodes, body_of, materials);
}

// Bodies within others have no surface to the air: as smooth, of the index and coated as the outermost around them.
std::vector<BodyMaterial> at_surfaces(std::span<const BodyMaterial> materials,
                                      const std::vector<std::uint32_t>& outermost) {
  std::vector<BodyMaterial> found(materials.begin(), materials.end());
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].eta = materials[outermost[i]].eta;
    found[i].roughness = materials[outermost[i]].roughness;
    found[i].coat = materials[outermost[i]].coat;
  }
  return found;
}

// Squares of indices over those of the outermost bodies around.
std::vector<float> etendue_of(std::span<const BodyMaterial> materials, const std::vector<std::uint32_t>& outermost) {
  std::vector<float> found;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const float ratio = materials[i].eta / materials[outermost[i]].eta;
    found.push_back(ratio * ratio);
  }
  return found;
}

void check_materials(std::span<const BodyMaterial> materials, std::span<const std::string> bodies) {
  if (bodies.empty()) throw InputError("materials: found for a file of one body without a name; set its material");
  if (materials.size() != bodies.size()) {
    throw InputError("materials: " + std::to_string(materials.size()) + " found, one for each of " +
                     std::to_string(bodies.size()) + " bodies wanted");
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    try {
      check_eta(static_cast<double>(materials[i].eta));
    } catch (const InputError& error) {
      throw InputError("material of '" + bodies[i] + "': " + error.what());
    }
  }
}

}  // namespace

std::vector<gpu::Optical> coefficients(const Level& level, std::span<const glm::vec3> points,
                                       const std::function<std::uint32_t(std::uint32_t)>& body_of,
                                       std::span<const BodyMaterial> materials) {
  std::vector<std::vector<std::uint32_t>> rows(materials.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) rows[body_of(i)].push_back(i);
  std::vector<gpu::Optical> optical(points.size());
  for (std::size_t body = 0; body < materials.size(); ++body) {
    std::vector<glm::vec3> places;
    for (std::uint32_t row : rows[body]) places.push_back(points[row]);
    const BodyMaterial& material = materials[body];
    const std::vector<float> depths = material.wants_depth ? depth_below_surface(level, places) : std::vector<float>{};
    const std::vector<gpu::Optical> found = material.at(places, depths);
    for (std::size_t k = 0; k < found.size(); ++k) optical[rows[body][k]] = found[k];
  }
  return optical;
}

std::string index_warning(std::span<const BodyMaterial> materials, std::span<const std::string> bodies,
                          const std::vector<std::uint32_t>& outermost) {
  std::string text;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const float own = materials[i].eta, around = materials[outermost[i]].eta;
    if (own == around) continue;
    text += (text.empty() ? "" : "; ") + bodies[i] + " has the index of refraction " + number_text(around) + " of " +
            bodies[outermost[i]] + ", which it lies within, and not its own of " + number_text(own);
  }
  if (!text.empty()) {
    text +=
        ": what the surface between them mirrors and bends is left out by this method; --method fem and "
        "quadgraph-fv know it";
  }
  return text;
}

BodyMaterial body_material(const std::string& text) {
  const gpu::Material material = parse_material(text);
  const bool layered = material.pattern == gpu::PATTERN_LAYERS;
  return {.text = text,
          .eta = material.eta,
          .roughness = stated_roughness(text).value_or(default_roughness),
          .coat = stated_coat(text),
          .wants_depth = layered,
          .angles = angles_of(material),
          .at = [material, layered](std::span<const glm::vec3> points, std::span<const float> depths) {
            std::vector<gpu::Optical> optical;
            for (std::size_t i = 0; i < points.size(); ++i) {
              optical.push_back(gpu::material_at(material, points[i], layered ? depths[i] : 0));
            }
            return optical;
          }};
}

std::string text_of(std::span<const BodyMaterial> materials, std::span<const std::string> bodies) {
  std::string text;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    text += (text.empty() ? "" : "; ") + bodies[i] + ": " + materials[i].text;
  }
  return text;
}

void Engine::set_materials(std::span<const BodyMaterial> given) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  const std::vector<std::string>& bodies = self.graph.bodies();
  check_materials(given, bodies);
  const std::vector<BodyMaterial> materials = at_surfaces(given, self.graph.outermost());
  Simulation& simulation = self.levels();
  const std::vector<Level>& levels = self.graph.levels();
  const std::vector<gpu::Optical> elsewhere = coefficients(
      levels[0], points_in_tets(levels[0]),
      [&](std::uint32_t i) { return levels[0].body_of_tet(i % levels[0].tet_count()); }, materials);
  std::vector<float> eta;
  std::vector<OpticalSurface> surfaces;
  for (const BodyMaterial& material : materials) {
    eta.push_back(material.eta);
    surfaces.emplace_back(double{material.eta}, material.coat, material.roughness);
  }
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    simulation.set_optical(i, at_nodes(levels[i], materials), eta,
                           i == 0 ? std::span(elsewhere) : std::span<const gpu::Optical>());
  }
  simulation.set_etendue(etendue_of(given, self.graph.outermost()));
  std::vector<ScatteringAngles> angles;
  for (const BodyMaterial& material : materials) angles.push_back(material.angles);
  simulation.set_angles(angles_of(angles));
  self.paths.set([&self, materials] { return grid_of_bodies(self.graph.levels()[0], materials, self.graph.bodies()); });
  self.material = text_of(materials, bodies);
  self.certainty = {};
  self.body_roughness.emplace(self.device, self.graph, materials);
  self.index_warning = index_warning(given, bodies, self.graph.outermost());
  self.set_surfaces(std::move(surfaces));
}

}  // namespace quadgraph
