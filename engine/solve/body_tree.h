// The tree over the outside faces of one level (engine/file/face_tree.h) on the device. Which faces lie together
// stays; their boxes follow the shape.
#pragma once

#include <cstdint>
#include <string>

#include "engine/file/graph.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/workspace.h"
#include "shaders/shared/body_shared.h"

namespace quadgraph {

class BodyTree {
 public:
  // `purpose`: what its memory counts for.
  BodyTree(device::Device& device, const Level& level, const std::string& purpose);

  // The vertices of the level have moved.
  void moved() { behind_ = true; }

  // The boxes, if they are behind the shape.
  void record(Workspace& work, const LevelBuffers& level);

  // Calls `pass(first, count)` for the nodes first to first + count - 1, layer by layer, leaves before their parents.
  template <typename Pass>
  void upwards(const Pass& pass) const {
    for (std::uint32_t first = leaves_; first > 0; first /= 2) pass(first, first);
  }

  gpu::TreeRef ref() const;
  std::uint32_t leaves() const { return leaves_; }
  std::uint32_t nodes() const { return 2 * leaves_; }  // the first one is none

 private:
  std::string purpose_;
  std::uint32_t leaves_ = 0;
  bool behind_ = true;
  device::Buffer order_, leaf_begin_, boxes_;
};

}  // namespace quadgraph
