// Facets of a rough surface, as often as they are seen.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "shaders/shared/microfacets.h"

namespace quadgraph {

// A way at that cosine with the normal of the surface, which is the third axis.
inline glm::vec3 way_at(double cosine) {
  const float z = std::max(static_cast<float>(cosine), gpu::LEAST_SEEN_COSINE);
  return {std::sqrt(std::max(1 - z * z, 0.0f)), 0, z};
}

// The mean of what `of` is for each facet that is seen along `way`, a Sum.
template <typename Sum, typename Of>
Sum mean_over_facets(const glm::vec3& way, float alpha, const Of& of) {
  constexpr int side = 16;  // of each of the two numbers that a facet is drawn by
  Sum sum(0);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      sum += of(gpu::visible_facet(way, alpha, (glm::vec2(i, j) + 0.5f) / static_cast<float>(side)));
    }
  }
  return sum / static_cast<double>(side * side);
}

}  // namespace quadgraph
