#include "engine/solve/level_elements.h"

#include "shaders/assemble/assembly_shared.h"

namespace quadgraph {
const Neighbours& LevelElements::around(device::Device& device, const Level& level) {
  if (!around_) around_ = vertex_neighbours(level, [&] { device.heed(); });
  return *around_;
}

void LevelElements::make_shapes(device::Device& device, const Level& level, std::uint32_t slice_rows) {
  if (row_shape.size() > 0) return;
  const Neighbours& rows = around(device, level);
  const FemShape shape = fem_shape(level, rows, slice(rows, slice_rows), [&] { device.heed(); });
  entry_shape = device::upload<glm::vec2>(device, shape.entry, prefix_ + "entry_shape");
  entry_area = device::upload<float>(device, shape.area, prefix_ + "entry_area");
  row_shape = device::upload<glm::vec2>(device, shape.row, prefix_ + "row_shape");
}

void LevelElements::make_rings(device::Device& device, const Level& level, std::uint32_t slice_rows) {
  if (face_area.size() > 0) return;
  const Neighbours& rows = around(device, level);
  const FemRings rings = fem_rings(level, rows, slice(rows, slice_rows), [&] { device.heed(); });
  make_tets(device, level);
  edge_count = static_cast<std::uint32_t>(rings.edge_entry.size());
  edge_entry = device::upload<glm::uvec2>(device, rings.edge_entry, prefix_ + "edge_entry");
  ring_offset = device::upload<std::uint32_t>(device, rings.ring_offset, prefix_ + "ring_offset");
  ring = device::upload<std::uint32_t>(device, rings.ring, prefix_ + "ring");
  tet_shape = {device, std::uint64_t{gpu::TET_SHAPE} * level.tet_count() * sizeof(float), device::Place::device,
               prefix_ + "tet_shape"};
  face_area = {device, level.face_count() * sizeof(float), device::Place::device, prefix_ + "face_area"};
  measured = false;
}

void LevelElements::make_tets(device::Device& device, const Level& level) {
  if (tet_incidence.size() > 0) return;
  const TetIncidence tets = quadgraph::tet_incidence(level, [&] { device.heed(); });
  tet_offset = device::upload<std::uint32_t>(device, tets.offset, prefix_ + "tet_offset");
  tet_incidence = device::upload<std::uint32_t>(device, tets.tet, prefix_ + "tet_incidence");
}

}  // namespace quadgraph
