// What the rows of a level are made of, whatever the model: made once for all operators on it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/device/memory.h"
#include "engine/file/graph.h"
#include "engine/solve/row_structure.h"

namespace quadgraph {

struct LevelElements {
  bool moved = false;  // vertices do not lie as in the file

  // fem: what rows are assembled from where the body is at rest and its coefficients are the same everywhere
  // (AssembleEvenPush).
  device::Buffer entry_shape, entry_area, row_shape;

  // fem: in all other cases.
  std::uint32_t edge_count = 0;
  device::Buffer edge_entry, ring_offset, ring;  // AssembleEdgesPush
  device::Buffer tet_shape, face_area;           // ShapePush
  bool measured = false;                         // they belong to the present vertices

  // Also of polygrids: the tets at every vertex.
  device::Buffer tet_offset, tet_incidence;

  explicit LevelElements(std::uint32_t number) : prefix_("assembly/level " + std::to_string(number) + " ") {}

  // The vertices around every vertex.
  const Neighbours& around(device::Device& device, const Level& level);

  // Make what is not there. slice_rows: of the rows.
  void make_shapes(device::Device& device, const Level& level, std::uint32_t slice_rows);
  void make_rings(device::Device& device, const Level& level, std::uint32_t slice_rows);
  void make_tets(device::Device& device, const Level& level);

 private:
  std::string prefix_;
  std::optional<Neighbours> around_;
};

}  // namespace quadgraph
