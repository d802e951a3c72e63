// Timing of a group of dispatches as one pass.
#pragma once

#include <utility>
#include <vector>

#include "engine/base/pass_stats.h"
#include "engine/device/commands.h"

namespace quadgraph {

// Records with `record(commands)`, runs it, waits, and adds what it took to `passes`. `bytes`: read and written.
template <typename Record>
void run_pass(device::Device& device, const char* name, std::uint64_t bytes, std::vector<PassStats>& passes,
              const Record& record) {
  device::Commands commands(device, 1);
  commands.begin_pass(name);
  record(commands);
  commands.end_pass();
  passes.push_back({name, commands.submit_and_wait()[0].time_ms, bytes, 1});
}

// `buffer` with room for that many bytes, which may be more than it is asked for.
inline void make_room(device::Device& device, device::Buffer& buffer, std::uint64_t bytes, device::Place place,
                      const char* name) {
  if (!buffer.exists() || buffer.size() < bytes) {
    buffer = {};  // two need not fit beside each other
    buffer = {device, bytes, place, name};
  }
}

}  // namespace quadgraph
