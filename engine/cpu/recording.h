// Commands of the processor, which are done when they are recorded.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "engine/cpu/objects.h"
#include "engine/cpu/pending_sums.h"
#include "engine/cpu/processor.h"
#include "engine/cpu/raster.h"
#include "engine/device/device.h"

namespace quadgraph::cpu {

class Recording : public device::Recording {
 public:
  explicit Recording(Processor& processor) : processor_(processor) {}

  void copy(const device::Memory& source, const device::Memory& target, std::uint64_t bytes,
            std::uint64_t target_offset, std::uint64_t source_offset) override {
    share_out(bytes, [&](std::uint64_t begin, std::uint64_t end) {
      std::memcpy(bytes_of(target) + target_offset + begin, bytes_of(source) + source_offset + begin, end - begin);
    });
  }

  void copy(const device::ImageMemory& source, const device::Memory& target, std::uint32_t width,
            std::uint32_t height) override {
    const auto& image = static_cast<const ImageMemory&>(source);
    const std::uint64_t row = std::uint64_t{image.texel_bytes()} * width;
    const auto* from = static_cast<const std::byte*>(image.memory.get());
    std::byte* to = bytes_of(target);
    const std::uint32_t rows_at_once = std::max(static_cast<std::uint32_t>(copied_at_once / row), 1u);
    processor_.run(image.options.layers * height, rows_at_once, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end; ++k) {
        const std::uint64_t y = std::uint64_t{k / height} * image.options.height + k % height;
        std::memcpy(to + k * row, from + y * image.options.width * image.texel_bytes(), row);
      }
    });
  }

  void fill(const device::Memory& target, std::uint64_t bytes, std::uint32_t value) override {
    auto* words = reinterpret_cast<std::uint32_t*>(bytes_of(target));
    share_out(bytes, [&](std::uint64_t begin, std::uint64_t end) {
      std::fill(words + begin / 4, words + (end + 3) / 4, value);
    });
  }

  void update(const device::Memory& target, std::span<const std::byte> data) override {
    std::memcpy(bytes_of(target), data.data(), data.size());
  }

  void dispatch(const device::Pipeline& pass, const void* push, std::uint32_t groups) override {
    const auto& pipeline = static_cast<const ComputePipeline&>(pass);
    const std::uint32_t part = std::max(groups / (parts_of_thread * processor_.threads().threads()), 1u);
    processor_.run(
        groups, part,
        [&](std::uint32_t begin, std::uint32_t end) { pipeline.kernel(push, groups, begin, end, pipeline.variant); },
        [] { PendingSums::of_thread().write(); });
  }

  void dispatch_indirect(const device::Pipeline& pass, const void* push, const device::Memory& arguments,
                         std::uint64_t offset) override {
    std::uint32_t groups[3];
    std::memcpy(groups, bytes_of(arguments) + offset, sizeof(groups));
    if (groups[0] > 0 && groups[1] > 0 && groups[2] > 0) dispatch(pass, push, groups[0]);
  }

  void draw(const device::DrawImages& target, const device::Viewport& viewport, const device::Pipeline& pass,
            const void* push, const device::Memory* indices, std::uint32_t vertices) override {
    const auto& pipeline = static_cast<const GraphicsPipeline&>(pass);
    const auto* numbers = indices == nullptr ? nullptr : reinterpret_cast<const std::uint32_t*>(bytes_of(*indices));
    rasterise(processor_, target, viewport, pipeline, push, numbers, vertices);
    processor_.heed();
  }

  std::vector<device::PassTime> submit_and_wait(const std::function<void()>& meanwhile) override {
    if (meanwhile) meanwhile();
    processor_.heed();
    return passes_;
  }

  void begin_pass(const std::string& name) override {
    passes_.push_back({name, 0});
    pass_start_ = std::chrono::steady_clock::now();
  }

  void end_pass() override {
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - pass_start_;
    passes_.back().time_ms = elapsed.count();
  }

 private:
  // Parts that a dispatch is shared out in, for each thread: what one part takes longer, others make up for, and
  // between two the device's check is heeded, within a tenth of a second in walks of a draw of points.
  static constexpr std::uint32_t parts_of_thread = 1024;

  // Bytes of a copy that a thread takes at once.
  static constexpr std::uint64_t copied_at_once = 1 << 20;

  static std::byte* bytes_of(const device::Memory& memory) { return static_cast<std::byte*>(memory.mapped); }

  // Calls part(begin, end) for all of `bytes`.
  template <typename Part>
  void share_out(std::uint64_t bytes, const Part& part) {
    processor_.run(static_cast<std::uint32_t>((bytes + copied_at_once - 1) / copied_at_once), 1,
                   [&](std::uint32_t begin, std::uint32_t end) {
                     part(begin * copied_at_once, std::min(end * copied_at_once, bytes));
                   });
  }

  Processor& processor_;
  std::chrono::steady_clock::time_point pass_start_;
  std::vector<device::PassTime> passes_;
};

}  // namespace quadgraph::cpu
