// Recording what a device shall do, one after the other, and timing it.
#pragma once

#include <cassert>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/device/memory.h"
#include "engine/device/pipeline.h"

namespace quadgraph::device {

struct DrawTarget {
  std::vector<const Image*> colours;
  const Image* depth = nullptr;
  std::uint32_t width = 0, height = 0;  // of the upper left part that is cleared and drawn into, pixels; 0: all
};

// What is recorded is seen by all that follows.
class Commands {
 public:
  // At most `max_passes` calls of begin_pass are timed.
  explicit Commands(Device& device, std::uint32_t max_passes = 0)
      : device_(device), recording_(device.record(max_passes)) {}

  Device& device() { return device_; }

  void copy(const Buffer& source, const Buffer& target, std::uint64_t bytes, std::uint64_t target_offset = 0) {
    recording_->copy(source.memory(), target.memory(), bytes, target_offset, 0);
  }

  // A part of a buffer to staging memory, and back.
  void copy(const Buffer& source, std::uint64_t offset, const Memory& staging, std::uint64_t bytes) {
    recording_->copy(source.memory(), staging, bytes, 0, offset);
  }
  void copy(const Memory& staging, const Buffer& target, std::uint64_t offset, std::uint64_t bytes) {
    recording_->copy(staging, target.memory(), bytes, offset, 0);
  }

  // Layer after layer, rows tightly packed, of an image that was drawn into. With a width and a height only its upper
  // left part of that size.
  void copy(const Image& source, const Buffer& target, std::uint32_t width = 0, std::uint32_t height = 0) {
    const ImageOptions& options = source.options();
    recording_->copy(source.memory(), target.memory(), width > 0 ? width : options.width,
                     height > 0 ? height : options.height);
  }

  void fill(const Buffer& target, std::uint32_t value) { recording_->fill(target.memory(), target.size(), value); }

  // Replaces the first bytes of `target`, at most 65536, a multiple of 4.
  void update(const Buffer& target, std::span<const std::byte> data) { recording_->update(target.memory(), data); }

  // One invocation per element, in workgroups of the pass's size. Throws DeviceError for more workgroups than the
  // device allows.
  template <typename Push>
  void dispatch(const ComputePass& pass, const Push& push, std::uint64_t elements) {
    assert(sizeof(Push) == pass.push_size());
    if (elements > 0) recording_->dispatch(pass.pipeline(), &push, checked_workgroups(pass, elements));
  }

  // Workgroup counts from three u32 at `offset` in `arguments`.
  template <typename Push>
  void dispatch_indirect(const ComputePass& pass, const Push& push, const Buffer& arguments, std::uint64_t offset) {
    assert(sizeof(Push) == pass.push_size());
    recording_->dispatch_indirect(pass.pipeline(), &push, arguments.memory(), offset);
  }

  // Clears the images (colour 0, depth that of what is farthest; contents before are dropped), and draws a triangle
  // list with y up. `indices` holds `vertices` u32; without them vertices are numbered in order.
  template <typename Push>
  void draw(const DrawTarget& target, const Viewport& viewport, const GraphicsPass& pass, const Push& push,
            const Buffer* indices, std::uint32_t vertices) {
    assert(sizeof(Push) == pass.push_size());
    recording_->draw(images_of(target), viewport, pass.pipeline(), &push,
                     indices == nullptr ? nullptr : &indices->memory(), vertices);
  }

  // Timed by the device's clock, or where that stamps something else (lavapipe: the end of a frame) by the host's
  // around what is recorded, which is then run and waited for.
  void begin_pass(const std::string& name) { recording_->begin_pass(name); }
  void end_pass() { recording_->end_pass(); }

  // Ends recording, runs it, waits; `meanwhile` is called once it runs, where it does beside the host. Call once.
  // Returns the time of every pass, in order of recording.
  std::vector<PassTime> submit_and_wait(const std::function<void()>& meanwhile = nullptr) {
    return recording_->submit_and_wait(meanwhile);
  }

 private:
  std::uint32_t checked_workgroups(const ComputePass& pass, std::uint64_t elements) const;
  static DrawImages images_of(const DrawTarget& target);

  Device& device_;
  std::unique_ptr<Recording> recording_;
};

}  // namespace quadgraph::device
