// A tree over the outside faces of a level for rays: which faces lie together, without the boxes themselves, so that it
// stays good for a body that deforms.
//
// Nodes are numbered as in a heap: 1 is the root, 2 i and 2 i + 1 are the children of i, leaf j is node leaves() + j.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/listener.h"
#include "engine/file/graph.h"

namespace quadgraph {

struct FaceTree {
  std::vector<std::uint32_t> order;       // every outside face once
  std::vector<std::uint32_t> leaf_begin;  // leaf j holds order[leaf_begin[j]] to order[leaf_begin[j + 1] - 1]

  std::uint32_t leaves() const { return static_cast<std::uint32_t>(leaf_begin.size() - 1); }  // a power of two
};

// Halves at the median along the longest side, down to at most four faces.
FaceTree face_tree(const Level& level, const Listener& listener = {});

}  // namespace quadgraph
