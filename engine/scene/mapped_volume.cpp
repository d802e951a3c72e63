#include "engine/scene/mapped_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/base/all_cores.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/scene/harmonic_map.h"
#include "engine/scene/shell_map.h"
#include "engine/scene/source_domain.h"

namespace quadgraph {
namespace {

std::string short_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

// Each axis by itself, so that the source's box, `scale` times as large, is the body's.
MappedVolume box_mapped(const SourceDomain& source, const MaterialMap& map, const BodySurface& body) {
  const SourceCells& cells = source.cells();
  MappedVolume made;
  glm::dvec3 longer(1), spacing = cells.grid().spacing;
  double product = 1;
  StretchCount count(std::max(source.axes(), 1));
  glm::dmat3 back(0);
  for (int axis = 0; axis < 3; ++axis) {
    if (!cells.varies_along(axis)) continue;
    longer[axis] = double{map.scale} / source.fit(body)[axis];
    product *= longer[axis];
    back[axis][axis] = 1 / longer[axis];
  }
  count.add(back, 1);
  made.report.stretch = count.percentiles();
  spacing *= longer;
  const glm::dvec3 anchor = body.middle() + longer * (cells.low() - source.middle());
  CellGrid grid{.cells = cells.grid().cells, .first = anchor, .spacing = spacing};
  if (map.repeat == MapRepeat::mirror && map.scale < 1) {
    grid = grid_around(body.low(), body.high(), anchor, spacing, made.report.coarser);
  }
  std::vector<float> values(grid.count() * cells.channels(), 0);
  on_all_cores(grid.count(), [&](std::size_t cell) {
    glm::dvec3 place = source.middle() + (grid.place(cell) - body.middle()) / longer;
    for (int axis = 0; axis < 3; ++axis) {
      if (map.scale < 1) place[axis] = source.within(place[axis], axis, map.repeat);
    }
    cells.add(place, 1, std::span(values).subspan(cell * cells.channels(), cells.channels()));
  });
  made.volume = cells.volume_of(grid, values, std::cbrt(product));
  return made;
}

}  // namespace

MappedVolume mapped(const Volume& source, const MaterialMap& map, const QuadGraph& body) {
  const SourceDomain domain(source, map);
  if (domain.axes() == 0) return {.volume = source};  // the same everywhere
  const BodySurface surface(body);
  switch (map.kind) {
    case MapKind::box:
      return box_mapped(domain, map, surface);
    case MapKind::shell:
      return shell_mapped(domain, map, surface);
    default:
      return harmonically_mapped(domain, surface);
  }
}

std::string report_text(const MaterialMap& map, const MapReport& report) {
  const Stretch& s = report.stretch;
  std::string text = "map " + std::string(name_of(map.kind)) + ": a mm of the source is " + short_number(s.median) +
                     " mm of the body (" + short_number(s.low) + " to " + short_number(s.high) + " in 90%)";
  if (map.kind == MapKind::shell) text += ", " + percent_text(report.core) + " of the inside is interpolated";
  if (report.tets > 0) {
    text += ", " + std::to_string(report.flipped_tets) + " of " + std::to_string(report.tets) + " tets are inside out";
  }
  if (report.coarser > 1) text += ", cells are " + short_number(report.coarser) + " times as wide as the source's";
  return text;
}

}  // namespace quadgraph
