// Which outside face of a level is nearest to a place.
#pragma once

#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "engine/file/face_tree.h"

namespace quadgraph {

class NearestFace {
 public:
  struct Found {
    std::uint32_t face = 0;
    float distance = 0;  // mm
  };

  // Wants vertices and at least one face of `level`, which must outlive it.
  explicit NearestFace(const Level& level);

  // Of faces that are equally near, always the same one. `guess`: a face that is thought to be near, which saves
  // looking at most others; of faces that are as near it is the one.
  Found find(const glm::vec3& point, std::optional<std::uint32_t> guess = {}) const;

 private:
  struct Box {
    glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};

    void hold(const glm::vec3& p) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    float squared_distance(const glm::vec3& p) const;
  };

  void look_at(std::uint32_t face, const glm::vec3& p, Found& nearest) const;
  void descend(std::uint32_t node, const glm::vec3& p, Found& nearest) const;

  const Level& level_;
  FaceTree tree_;
  std::vector<Box> boxes_;
};

}  // namespace quadgraph
