#include "engine/vk/live_objects.h"

#include <mutex>

namespace quadgraph::vk {
namespace {

constexpr const char* context_kind = "context";

struct Books {
  std::mutex mutex;
  std::uint64_t contexts = 0;
  std::map<VkDevice, std::uint64_t> context_of;
  std::map<std::uint64_t, LiveObjects> live;  // by context
};

// Never destroyed: a script may end with an engine open.
Books& books() {
  static Books& kept = *new Books;
  return kept;
}

}  // namespace

std::uint64_t contexts_made() {
  const std::lock_guard lock(books().mutex);
  return books().contexts;
}

LiveObjects live_objects(std::uint64_t first) {
  const std::lock_guard lock(books().mutex);
  LiveObjects sum;
  for (auto context = books().live.lower_bound(first); context != books().live.end(); ++context) {
    for (const auto& [kind, number] : context->second) sum[kind] += number;
  }
  return sum;
}

void count_opened(VkDevice device) {
  {
    const std::lock_guard lock(books().mutex);
    books().context_of[device] = books().contexts++;
  }
  count_made(device, context_kind);
}

void count_closed(VkDevice device) noexcept {
  count_gone(device, context_kind);
}

void count_made(VkDevice device, const char* kind, std::uint64_t number) {
  const std::lock_guard lock(books().mutex);
  books().live[books().context_of.at(device)][kind] += number;
}

void count_gone(VkDevice device, const char* kind, std::uint64_t number) noexcept {
  const std::lock_guard lock(books().mutex);
  const auto number_of = books().context_of.find(device);
  if (number_of == books().context_of.end()) return;
  const auto context = books().live.find(number_of->second);
  if (context == books().live.end()) return;
  const auto left = context->second.find(kind);
  if (left == context->second.end()) return;
  left->second -= number;
  if (left->second > 0) return;
  context->second.erase(left);
  if (context->second.empty()) books().live.erase(context);
}

}  // namespace quadgraph::vk
