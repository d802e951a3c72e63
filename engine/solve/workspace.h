// What all passes of a solve share.
#pragma once

#include "engine/solve/passes.h"
#include "engine/solve/recorder.h"
#include "engine/vk/memory.h"

namespace quadgraph {

struct Workspace {
  Recorder recorder;
  Passes passes;
  vk::Buffer reduction;  // Reduction of pairs, for the largest dispatch
  vk::Buffer scale;      // Scale

  // `max_elements`: invocations of the largest dispatch that reduces.
  Workspace(vk::Context& context, std::uint64_t max_elements);
};

}  // namespace quadgraph
