// Recording and submitting one command buffer, and timing what is recorded.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/vk/context.h"
#include "engine/vk/memory.h"
#include "engine/vk/pipeline.h"

namespace quadgraph::vk {

// Device time of one named pass.
struct PassTime {
  std::string name;
  double time_ms = 0;
};

class Commands {
 public:
  // Starts recording. At most `max_passes` calls of begin_pass are timed.
  explicit Commands(Context& context, std::uint32_t max_passes = 0);

  Context& context() { return context_; }
  VkCommandBuffer handle() const { return commands_; }

  // All writes before are visible to all that follows: the one barrier the engine needs between passes.
  void barrier();

  // Moves every layer of an image from `from` (UNDEFINED discards its contents) to `to`, with a full barrier.
  void transition(const Image& image, VkImageLayout from, VkImageLayout to);

  void copy(const Buffer& source, const Buffer& target, std::uint64_t bytes, std::uint64_t target_offset = 0);

  // Layer after layer, rows tightly packed; the image must be in TRANSFER_SRC_OPTIMAL. With a width and a height only
  // its upper left part of that size.
  void copy(const Image& source, const Buffer& target, std::uint32_t width = 0, std::uint32_t height = 0);

  void fill(const Buffer& target, std::uint32_t value);

  // Replaces the first bytes of `target`, at most 65536, a multiple of 4.
  void update(const Buffer& target, std::span<const std::byte> data);

  // One invocation per element, in workgroups of the pass's size; followed by a barrier.
  template <typename Push>
  void dispatch(const ComputePass& pass, const Push& push, std::uint64_t elements) {
    dispatch_bytes(pass, &push, sizeof(Push), elements);
  }

  // Workgroup counts from three u32 at `offset` in `arguments`; followed by a barrier.
  template <typename Push>
  void dispatch_indirect(const ComputePass& pass, const Push& push, const Buffer& arguments, std::uint64_t offset) {
    dispatch_indirect_bytes(pass, &push, sizeof(Push), arguments, offset);
  }

  // Timed by the device's clock, except on a device of type CPU: lavapipe stamps when it closes a frame, not when the
  // pass runs, so there what was recorded is run and waited for, and the host's clock is read.
  void begin_pass(const std::string& name);
  void end_pass();

  // Ends recording, runs it, waits. Call once. Returns the time of every pass, in order of recording.
  std::vector<PassTime> submit_and_wait();

 private:
  void dispatch_bytes(const ComputePass& pass, const void* push, std::uint32_t size, std::uint64_t elements);
  void dispatch_indirect_bytes(const ComputePass& pass, const void* push, std::uint32_t size, const Buffer& arguments,
                               std::uint64_t offset);
  void bind(const ComputePass& pass, const void* push, std::uint32_t size);
  void begin();
  void end_and_run();
  void flush();
  std::vector<PassTime> read_times();

  Context& context_;
  UniqueCommandPool pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  UniqueQueryPool queries_;
  std::uint32_t max_passes_ = 0;
  bool host_timed_ = false;
  bool unfinished_ = false;  // something has been recorded since the last flush
  std::chrono::steady_clock::time_point pass_start_;
  std::vector<PassTime> passes_;
};

}  // namespace quadgraph::vk
