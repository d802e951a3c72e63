// Whether bodies that have been moved lie in each other.
#pragma once

#include <string>

#include "engine/deform/body_poses.h"
#include "engine/reference/tet_locator.h"

namespace quadgraph {

// Names the bodies of which one has a vertex of its surface, of some thousands that are looked at, within the other, as
// `placed` puts them; empty where none has. `locator`: of level 0 at rest. Surfaces that cross between all of these
// vertices are not found.
std::string overlap_text(const QuadGraph& graph, const Deformer& placed, const TetLocator& locator);

}  // namespace quadgraph
