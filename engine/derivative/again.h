// What light that enters again leaves along its rays, those of BEAM_MEAN (engine/reference/entering.h), as a matrix.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/derivative/source.h"

namespace quadgraph {

class AgainMatrix {
 public:
  struct Entry {
    std::uint32_t face, to;
    glm::dvec3 share;  // W per W/mm^2
  };

  AgainMatrix(const Level& level, const Problem& problem, const Parameters& at);

  // Adds what q, W/mm^2 per outside face, leaves.
  void add(std::span<const glm::dvec3> q, Walked& walked) const;
  // The transpose: per outside face.
  std::vector<glm::dvec3> transposed(const Walked& weights) const;

 private:
  std::size_t face_count_;
  std::vector<Entry> scattered_, unscattered_;
};

}  // namespace quadgraph
