#include "engine/cpu/pending_sums.h"

#include <bit>

namespace quadgraph::cpu {
namespace {

void add_to_memory(const PendingSum& sum) {
  static_assert(std::endian::native == std::endian::little);   // two words are one number of 64 bits
  auto* words = reinterpret_cast<std::uint64_t*>(sum.target);  // buffers are aligned, and so are sums
  for (std::size_t c = 0; c < channels_of_sum; ++c) {
    if (sum.value[c] != 0) __atomic_fetch_add(words + c, sum.value[c], __ATOMIC_RELAXED);
  }
}

}  // namespace

PendingSums& PendingSums::of_thread() {
  thread_local PendingSums sums;
  return sums;
}

void PendingSums::replace(PendingSum& place, std::uint32_t* target) {
  if (place.target == nullptr) {
    used_.push_back(&place);
  } else {
    add_to_memory(place);
  }
  place = {target, {}};
}

void PendingSums::write() {
  for (PendingSum* sum : used_) {
    add_to_memory(*sum);
    *sum = {};
  }
  used_.clear();
}

}  // namespace quadgraph::cpu
