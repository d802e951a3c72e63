// A volume of coefficients carried from the body in which it was found into another one: again a volume.
#pragma once

#include <string>

#include "engine/file/graph.h"
#include "engine/scene/material_map.h"
#include "engine/scene/source_cells.h"
#include "engine/scene/stretch.h"
#include "engine/scene/volume.h"

namespace quadgraph {

struct MapReport {
  Stretch stretch{};
  double coarser = 1;    // how much wider the cells are than the source's would be
  double core = 0;       // share of the body's cells that no place of the source falls on: interpolated
  std::size_t tets = 0;  // of a harmonic map, and those of them that it turns inside out
  std::size_t flipped_tets = 0;
};

struct MappedVolume {
  Volume volume;
  MapReport report{};
};

// Always the same. Throws InputError where the map does not fit the body or the volume, FormatError or InputError for
// the body that `map.from` names.
MappedVolume mapped(const Volume& source, const MaterialMap& map, const QuadGraph& body);

// Of what a map did, a sentence without a full stop.
std::string report_text(const MaterialMap& map, const MapReport& report);

}  // namespace quadgraph
