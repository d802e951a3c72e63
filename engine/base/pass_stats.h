// What the passes of a frame took.
#pragma once

#include <cstdint>
#include <string>

namespace quadgraph {

// One kind of pass in a frame.
struct PassStats {
  std::string name;
  double time_ms = 0;       // device time, all dispatches together
  std::uint64_t bytes = 0;  // bytes the algorithm reads and writes, all dispatches together
  std::uint32_t count = 0;  // dispatches that did work
};

}  // namespace quadgraph
