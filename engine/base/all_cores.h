// A loop whose turns do not depend on each other, on all cores.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace quadgraph {

// Calls `turn` with 0 to `count` - 1, from several threads at once; it must not throw.
template <typename Turn>
void on_all_cores(std::size_t count, const Turn& turn) {
  const std::size_t workers = std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::jthread> threads;
  for (std::size_t w = 0; w < workers; ++w) {
    threads.emplace_back([&, w] {
      const std::size_t first = count * w / workers, last = count * (w + 1) / workers;
      for (std::size_t i = first; i < last; ++i) turn(i);
    });
  }
}

}  // namespace quadgraph
