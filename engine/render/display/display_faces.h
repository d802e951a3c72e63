// Where the triangles of the display mesh lie on the surface that was solved on.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/listener.h"
#include "engine/file/graph.h"

namespace quadgraph {

// Per display triangle the outside face of `level` (the finest) under its centroid: found from the faces of its
// vertices, going over edges towards the centroid. Where the display mesh is the surface of the level, each triangle's
// own face.
std::vector<std::uint32_t> display_faces(const DisplayMesh& mesh, const Level& level, const Listener& listener = {});

}  // namespace quadgraph
