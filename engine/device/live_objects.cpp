#include "engine/device/live_objects.h"

#include <mutex>

namespace quadgraph::device {
namespace {

constexpr const char* device_kind = "device";

struct Books {
  std::mutex mutex;
  std::uint64_t devices = 0;
  std::map<const void*, std::uint64_t> number_of_device;
  std::map<std::uint64_t, LiveObjects> live;  // by device_books
};

// Never destroyed: a script may end with an engine open.
Books& books() {
  static Books& kept = *new Books;
  return kept;
}

}  // namespace

std::uint64_t devices_opened() {
  const std::lock_guard lock(books().mutex);
  return books().devices;
}

LiveObjects live_objects(std::uint64_t first) {
  const std::lock_guard lock(books().mutex);
  LiveObjects sum;
  for (auto device_books = books().live.lower_bound(first); device_books != books().live.end(); ++device_books) {
    for (const auto& [kind, number] : device_books->second) sum[kind] += number;
  }
  return sum;
}

void count_opened(const void* device) {
  {
    const std::lock_guard lock(books().mutex);
    books().number_of_device[device] = books().devices++;
  }
  count_made(device, device_kind);
}

void count_closed(const void* device) noexcept {
  count_gone(device, device_kind);
}

void count_made(const void* device, const char* kind, std::uint64_t number) {
  const std::lock_guard lock(books().mutex);
  books().live[books().number_of_device.at(device)][kind] += number;
}

void count_gone(const void* device, const char* kind, std::uint64_t number) noexcept {
  const std::lock_guard lock(books().mutex);
  const auto number_of = books().number_of_device.find(device);
  if (number_of == books().number_of_device.end()) return;
  const auto device_books = books().live.find(number_of->second);
  if (device_books == books().live.end()) return;
  const auto left = device_books->second.find(kind);
  if (left == device_books->second.end()) return;
  left->second -= number;
  if (left->second > 0) return;
  device_books->second.erase(left);
  if (device_books->second.empty()) books().live.erase(device_books);
}

}  // namespace quadgraph::device
