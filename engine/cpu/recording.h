// Commands of the processor, which are done when they are recorded.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "engine/cpu/processor.h"
#include "engine/device/device.h"

namespace quadgraph::cpu {

class Recording : public device::Recording {
 public:
  explicit Recording(Processor& processor) : processor_(processor) {}

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
  std::vector<device::PassTime> submit_and_wait() override;

 private:
  Processor& processor_;
  std::chrono::steady_clock::time_point pass_start_;
  std::vector<device::PassTime> passes_;
};

}  // namespace quadgraph::cpu
