// Sums of power in fixed point; see POWER_UNIT.
#ifndef QUADGRAPH_FIXED_POINT_GLSL
#define QUADGRAPH_FIXED_POINT_GLSL

#include "source/walk_shared.h"

// Adds `value` >= 0, scaled, to element `i`. A float times a power of two splits into two words without loss, but for
// the bits below the unit.
#ifdef QG_PROCESSOR
PendingSums& pending_sums = PendingSums::of_thread();  // engine/cpu/pending_sums.h

void add_power(Uints sums, uint i, vec3 value) {
  add_later(pending_sums, sums.at + FIXED_WORDS * i, roundEven(value / POWER_UNIT));
}
#else
void add_power(Uints sums, uint i, vec3 value) {
  vec3 units = value / POWER_UNIT;
  vec3 high = floor(units * exp2(-32.0));
  uvec3 low_word = uvec3(roundEven(units - high * exp2(32.0)));
  uvec3 high_word = uvec3(high);
  if (low_word == uvec3(0) && high_word == uvec3(0)) return;
  // All channels are asked for before any answer is waited for.
  uint at = FIXED_WORDS * i;
  uvec3 before = uvec3(atomicAdd(sums.at[at], low_word.x), atomicAdd(sums.at[at + 2u], low_word.y),
                       atomicAdd(sums.at[at + 4u], low_word.z));
  for (uint c = 0u; c < 3u; ++c) {
    uint carried = high_word[c] + (before[c] + low_word[c] < before[c] ? 1u : 0u);
    if (carried != 0u) atomicAdd(sums.at[at + 2u * c + 1u], carried);
  }
}
#endif

// Of any sign: what is above zero to element `i`, and what is below to `i + step`.
void add_signed(Uints sums, uint i, uint step, vec3 value) {
  add_power(sums, i, max(value, vec3(0)));
  add_power(sums, i + step, max(-value, vec3(0)));
}

vec3 power_at(Uints sums, uint i) {
  vec3 value;
  for (uint c = 0u; c < 3u; ++c) {
    uint low = sums.at[FIXED_WORDS * i + 2u * c], high = sums.at[FIXED_WORDS * i + 2u * c + 1u];
    value[c] = (float(high) * exp2(32.0) + float(low)) * POWER_UNIT;
  }
  return value;
}

#endif
