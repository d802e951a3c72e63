// What the passes of a frame took.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace quadgraph {

// One kind of pass in a frame.
struct PassStats {
  std::string name;
  double time_ms = 0;       // device time, all dispatches together
  std::uint64_t bytes = 0;  // bytes the algorithm reads and writes, all dispatches together
  std::uint32_t count = 0;  // dispatches that did work
};

// Adds to the entry of the same name.
inline void add(std::vector<PassStats>& passes, const PassStats& more) {
  auto same = std::find_if(passes.begin(), passes.end(), [&](const auto& p) { return p.name == more.name; });
  if (same == passes.end()) same = passes.insert(passes.end(), {.name = more.name});
  same->time_ms += more.time_ms;
  same->bytes += more.bytes;
  same->count += more.count;
}

}  // namespace quadgraph
