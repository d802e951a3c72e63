// Bytes of what passes read and write, by which they say how much they move.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "shaders/source/walk_shared.h"

namespace quadgraph {

inline constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);
inline constexpr std::uint64_t index_bytes = sizeof(std::uint32_t);
inline constexpr std::uint64_t sum_bytes = FIXED_WORDS * sizeof(std::uint32_t);  // a sum in fixed point

}  // namespace quadgraph
