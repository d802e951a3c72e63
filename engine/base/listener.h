// What is called between pieces of long work on the host, so that the window hears meanwhile. What it throws ends the
// work.
#pragma once

#include <cstddef>
#include <functional>

namespace quadgraph {

using Listener = std::function<void()>;

// For each of many: calls it before the first and once for some thousands more, a millisecond or so.
inline void heed(const Listener& listener, std::size_t number) {
  constexpr std::size_t piece = 4096;
  if (listener && number % piece == 0) listener();
}

}  // namespace quadgraph
