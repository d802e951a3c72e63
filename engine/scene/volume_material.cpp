#include "engine/reference/tet_points.h"
#include "engine/scene/mapped_volume.h"
#include "engine/scene/material_map.h"
#include "engine/scene/volume.h"

namespace quadgraph {

std::string set_material(Engine& engine, std::string_view text) {
  const std::optional<VolumeName> name = volume_name(text);
  if (!name) {
    engine.set_material(text);
    return {};
  }
  const Volume volume = read_volume(name->file);
  if (!name->map) {
    set_material(engine, volume);
    return {};
  }
  const MappedVolume made = mapped(volume, *name->map, engine.graph());
  set_material(engine, made.volume);
  return report_text(*name->map, made.report);
}

void set_material(Engine& engine, const Volume& volume) {
  const std::span<const Level> levels = engine.graph().levels();
  const RestBox box = rest_box(levels.empty() ? engine.graph().display().vertices : levels[0].vertices);
  const glm::dvec3 centre = 0.5 * (box.low + box.high);
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    const std::vector<gpu::Optical> elsewhere =
        i == 0 ? volume.at(points_in_tets(levels[i]), centre) : std::vector<gpu::Optical>{};
    engine.set_optical(i, volume.at(levels[i].nodes, centre), volume.eta, elsewhere);
  }
  const glm::uvec3 size(volume.cells[0], volume.cells[1], volume.cells[2]);
  engine.set_optical(OpticalGrid{.size = size,
                                 .optical = volume.optical,
                                 .spacing = glm::vec3(volume.spacing),
                                 .first = glm::vec3(volume.first(centre)),
                                 .eta = volume.eta});
  if (!levels.empty()) engine.set_certainty(volume.certainty_at(levels[0].vertices, centre));
}

}  // namespace quadgraph
