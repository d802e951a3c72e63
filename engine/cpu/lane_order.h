// Lanes in another order, and where the least one is: what shaders/source/tet_ray.glsl does by components elsewhere.
#pragma once

#include <array>
#include <cstring>

#include "engine/cpu/lane_functions.h"

namespace quadgraph::cpu::QG_LEVEL {

using ByteLanes = unsigned char __attribute__((vector_size(16)));

// By the last six bits of a crossing (shaders/shared/body_shared.h), for each byte of the result that of the argument.
constexpr std::array<std::array<unsigned char, 16>, 64> lane_orders = [] {
  std::array<std::array<unsigned char, 16>, 64> orders{};
  for (unsigned crossing = 0; crossing < orders.size(); ++crossing) {
    const unsigned last = crossing ^ crossing >> 2 ^ crossing >> 4;
    const std::array<unsigned, 4> places = {crossing & 3, crossing >> 2 & 3, crossing >> 4, last & 3};
    for (unsigned k = 0; k < 16; ++k) orders[crossing][4 * places[k / 4] + k % 4] = static_cast<unsigned char>(k);
  }
  return orders;
}();

inline vec4 onward(vec4 v, uint crossing) {
  ByteLanes order;
  std::memcpy(&order, lane_orders[crossing & 63u].data(), sizeof(order));
  return vec4(Lanes(__builtin_shuffle(ByteLanes(Lanes(v.lanes)), order)));
}

inline float least_of(vec4 v, uint& place) {
  const Lanes halves = lesser(v.lanes, __builtin_shuffle(Lanes(v.lanes), IntLanes{2, 3, 0, 1}));
  const Lanes least = lesser(halves, __builtin_shuffle(halves, IntLanes{1, 0, 3, 2}));
  const IntLanes is_least = Lanes(v.lanes) == least;
#ifdef __SSE4_1__
  place = static_cast<uint>(__builtin_ctz(static_cast<uint>(_mm_movemask_ps(Lanes(is_least))) | 8u));
#else
  place = is_least[0] != 0 ? 0u : is_least[1] != 0 ? 1u : is_least[2] != 0 ? 2u : 3u;
#endif
  return least[0];
}

}  // namespace quadgraph::cpu::QG_LEVEL
