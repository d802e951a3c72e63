// What all passes of a solve share.
#pragma once

#include "engine/device/memory.h"
#include "engine/solve/passes.h"
#include "engine/solve/recorder.h"

namespace quadgraph {

struct Workspace {
  Recorder recorder;
  Passes passes;
  device::Buffer reduction;  // Reduction of three sums, for the largest dispatch
  device::Buffer scale;      // Scale

  // `max_elements`: invocations of the largest dispatch that reduces.
  Workspace(device::Device& device, std::uint64_t max_elements);

  // Drops what is recorded; what a dispatch that was given up half-way has left in the reduction counts no more.
  void start_over();
};

}  // namespace quadgraph
