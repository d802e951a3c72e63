// What batches of random walks say of a part of the surface, by patch.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/reference/solution.h"
#include "engine/solve/surface_parts.h"

namespace quadgraph {

// Groups of walks that share nothing: what these differ by is the noise.
inline constexpr std::uint32_t walk_batches = 16;

// Power of the solution and of the walks, W.
struct PatchSums {
  struct Patch {
    double area = 0;  // mm^2; 0: none of it is of the part
    glm::dvec3 solved{0};
    std::array<glm::dvec3, walk_batches> walked{};
  };
  std::vector<Patch> patches = std::vector<Patch>(most_patches);
};

// How far the solution is off, as measured; zero where too few walks came there.
CertifiedPart certified(const PatchSums& part);

// The third of the surface whose patches send out least. By face it would be where the noise of the solution is low.
std::vector<bool> dimmest_patches(const PatchSums& whole);

double sum_of_channels(const glm::dvec3& v);

}  // namespace quadgraph
