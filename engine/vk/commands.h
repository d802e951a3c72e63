// Recording and submitting one command buffer, and timing what is recorded.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/device/device.h"
#include "engine/vk/context.h"
#include "engine/vk/memory.h"

namespace quadgraph::vk {

// What a recording is made of. They are used again: drivers take long to make a pool.
struct RecordingParts {
  RecordingParts(Context& context, std::uint32_t queries);

  UniqueCommandPool pool;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  UniqueQueryPool queries;
  std::uint32_t query_count = 0;
  UniqueFence fence;
};

class Recording : public device::Recording {
 public:
  Recording(Context& context, std::uint32_t max_passes);
  ~Recording() override;

  void copy(const device::Memory& source, const device::Memory& target, std::uint64_t bytes,
            std::uint64_t target_offset, std::uint64_t source_offset) override;
  void copy(const device::ImageMemory& source, const device::Memory& target, std::uint32_t width,
            std::uint32_t height) override;
  void fill(const device::Memory& target, std::uint64_t bytes, std::uint32_t value) override;
  void update(const device::Memory& target, std::span<const std::byte> data) override;
  void dispatch(const device::Pipeline& pass, const void* push, std::uint32_t groups) override;
  void dispatch_indirect(const device::Pipeline& pass, const void* push, const device::Memory& arguments,
                         std::uint64_t offset) override;
  void draw(const device::DrawImages& target, const device::Viewport& viewport, const device::Pipeline& pass,
            const void* push, const device::Memory* indices, std::uint32_t vertices) override;
  void begin_pass(const std::string& name) override;
  void end_pass() override;
  std::vector<device::PassTime> submit_and_wait(const std::function<void()>& meanwhile) override;

  VkCommandBuffer handle() const { return parts_->commands; }

 private:
  // All writes before are seen by these stages of what follows.
  void show_to(VkPipelineStageFlags2 stages, VkAccessFlags2 access);

  // By all of what follows: the one barrier the engine needs between passes.
  void barrier();

  // Moves every layer of an image from `from` (UNDEFINED discards its contents) to `to`, with a full barrier.
  void transition(const ImageMemory& image, VkImageLayout from, VkImageLayout to);

  void begin_rendering(const device::DrawImages& target, float farthest_depth);
  void set_viewport(const device::DrawImages& target, const device::Viewport& viewport);
  void bind(VkPipelineBindPoint point, const device::Pipeline& pass, const void* push);
  void begin();
  VkCommandBufferSubmitInfo finished();
  void stamp();
  void end_and_run(const std::function<void()>& meanwhile);
  void ask_for(VkFence fence) const;
  bool ended(VkFence fence, std::uint64_t patience_ns) const;
  void flush();
  std::vector<device::PassTime> read_times();

  Context& context_;
  std::unique_ptr<RecordingParts> parts_;
  std::uint32_t max_passes_ = 0;
  bool host_timed_ = false;
  bool unfinished_ = false;  // something has been recorded since the last flush
  bool stamped_ = false;     // nothing has since the last stamp
  std::uint32_t queries_ = 0;
  std::chrono::steady_clock::time_point pass_start_;
  std::vector<device::PassTime> passes_;
  struct Stamps {
    std::uint32_t begin, end;  // queries
  };
  std::vector<Stamps> stamps_;  // by pass
};

}  // namespace quadgraph::vk
