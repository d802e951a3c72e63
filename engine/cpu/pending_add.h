// How shaders add to sums (engine/cpu/pending_sums.h).
#pragma once

#include "engine/cpu/glsl.h"
#include "engine/cpu/pending_sums.h"

namespace quadgraph::cpu::QG_LEVEL {

// Adds whole numbers from 0 to 2^63.
inline void add_later(PendingSums& sums, uint* target, vec3 value) {
  const std::uintptr_t number = reinterpret_cast<std::uintptr_t>(target) / (words_of_sum * sizeof(uint));
  PendingSum& sum = sums.places()[number % PendingSums::place_count];
  if (sum.target != target) sums.replace(sum, target);
  for (std::size_t c = 0; c < channels_of_sum; ++c)
    sum.value[c] += static_cast<std::uint64_t>(static_cast<std::int64_t>(value[c]));
}

}  // namespace quadgraph::cpu::QG_LEVEL
