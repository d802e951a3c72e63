// The part of space that a volume is known in, from which maps take it.
#pragma once

#include <memory>
#include <optional>

#include "engine/file/graph.h"
#include "engine/scene/body_surface.h"
#include "engine/scene/material_map.h"
#include "engine/scene/source_cells.h"

namespace quadgraph {

// The body that a map's `from` names, or the box of the middles of the volume's outermost cells.
class SourceDomain {
 public:
  // Throws FormatError or InputError for the body.
  SourceDomain(const Volume& volume, const MaterialMap& map);

  const SourceCells& cells() const { return *cells_; }
  const glm::dvec3& low() const { return low_; }  // mm
  const glm::dvec3& high() const { return high_; }
  glm::dvec3 middle() const { return 0.5 * (low_ + high_); }
  glm::dvec3 size() const { return high_ - low_; }

  // What lengths of a body become where its box is laid over this one, axis by axis; 1 along one in which it is flat.
  glm::dvec3 fit(const BodySurface& body) const;

  // None of a block: of a domain that fills its box.
  const BodySurface* surface() const { return surface_.get(); }

  // Along how many axes the volume differs.
  int axes() const;
  double least_side() const;  // mm, of the box, along those axes

  // A place along an axis brought into the box, as `repeat` says.
  double within(double place, int axis, MapRepeat repeat) const;

 private:
  std::optional<QuadGraph> body_;
  std::unique_ptr<BodySurface> surface_;
  std::unique_ptr<SourceCells> cells_;
  glm::dvec3 low_{0}, high_{0};
};

// The cells that a box wants, `anchor` the middle of one; `coarser`: what their spacing grew by, so that they are not
// too many.
CellGrid grid_around(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& anchor, glm::dvec3 spacing,
                     double& coarser);

}  // namespace quadgraph
