#include <algorithm>
#include <memory>

#include "engine/base/error.h"
#include "engine/reference/tet_points.h"
#include "engine/scene/mapped_volume.h"
#include "engine/scene/material_map.h"
#include "engine/scene/volume.h"

namespace quadgraph {
namespace {

// Of the box around one body of the finest level.
glm::dvec3 centre_of_body(const Level& level, std::uint32_t body) {
  std::vector<glm::vec3> vertices;
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    if (level.body_of_tet(t) != body) continue;
    for (int k = 0; k < 4; ++k) vertices.push_back(level.vertices[level.tets[t][k]]);
  }
  const RestBox box = rest_box(vertices);
  return 0.5 * (box.low + box.high);
}

BodyMaterial material_of_body(const QuadGraph& graph, std::uint32_t body, const std::string& text) {
  const std::optional<VolumeName> name = volume_name(text);
  if (!name) return body_material(text);
  if (name->map) {
    throw InputError("a map found of a volume for one of several bodies, allowed is a volume that lies there as it is");
  }
  const auto volume = std::make_shared<const Volume>(read_volume(name->file));
  const glm::dvec3 centre = centre_of_body(graph.levels()[0], body);
  return {.text = text,
          .eta = volume->eta,
          .coat = name->coat,
          .at = [volume, centre](std::span<const glm::vec3> points, std::span<const float>) {
            return volume->at(points, centre);
          }};
}

// Throws InputError for a name that the file does not have.
void check_names(const std::map<std::string, std::string>& materials, std::span<const std::string> bodies) {
  std::string allowed;
  for (const std::string& body : bodies) allowed += (allowed.empty() ? "" : ", ") + body;
  for (const auto& [name, material] : materials) {
    if (std::ranges::find(bodies, name) != bodies.end()) continue;
    throw InputError("materials: a body '" + name + "' found, " +
                     (bodies.empty() ? "the file has one body without a name: set its material"
                                     : "the bodies of the file are " + allowed));
  }
}

}  // namespace

std::string set_materials(Engine& engine, std::string_view material,
                          const std::map<std::string, std::string>& materials) {
  if (materials.empty()) return set_material(engine, material);
  const std::vector<std::string>& bodies = engine.graph().bodies();
  check_names(materials, bodies);
  std::vector<BodyMaterial> of_bodies;
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    const auto named = materials.find(bodies[i]);
    try {
      of_bodies.push_back(
          material_of_body(engine.graph(), i, named == materials.end() ? std::string(material) : named->second));
    } catch (const InputError& error) {
      throw InputError("material of '" + bodies[i] + "': " + error.what());
    }
  }
  engine.set_materials(of_bodies);
  return {};
}

std::string set_material(Engine& engine, std::string_view text) {
  const std::optional<VolumeName> name = volume_name(text);
  if (!name) {
    engine.set_material(text);
    return {};
  }
  const Volume volume = read_volume(name->file);
  if (!name->map) {
    set_material(engine, volume, name->coat);
    return {};
  }
  const MappedVolume made = mapped(volume, *name->map, engine.graph());
  set_material(engine, made.volume, name->coat);
  return report_text(*name->map, made.report);
}

void set_material(Engine& engine, const Volume& volume, const Coat& coat) {
  const std::span<const Level> levels = engine.graph().levels();
  const RestBox box = rest_box(levels.empty() ? engine.graph().display().vertices : levels[0].vertices);
  const glm::dvec3 centre = 0.5 * (box.low + box.high);
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    const std::vector<gpu::Optical> elsewhere =
        i == 0 ? volume.at(points_in_tets(levels[i]), centre) : std::vector<gpu::Optical>{};
    engine.set_optical(i, volume.at(levels[i].nodes, centre), volume.eta, elsewhere, coat);
  }
  const glm::uvec3 size(volume.cells[0], volume.cells[1], volume.cells[2]);
  engine.set_optical(OpticalGrid{.size = size,
                                 .optical = volume.optical,
                                 .spacing = glm::vec3(volume.spacing),
                                 .first = glm::vec3(volume.first(centre)),
                                 .eta = volume.eta},
                     coat);
  if (!levels.empty()) engine.set_certainty(volume.certainty_at(levels[0].vertices, centre));
}

}  // namespace quadgraph
