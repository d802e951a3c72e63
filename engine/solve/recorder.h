// Records the dispatches of a solve and adds up what each kind of pass cost.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/pass_stats.h"
#include "engine/device/commands.h"
#include "engine/solve/passes.h"

namespace quadgraph {

class Recorder {
 public:
  explicit Recorder(device::Device& device) : device_(device) {}

  device::Device& device() { return device_; }

  // Forgets the passes counted so far.
  void clear() { passes_.clear(); }
  const std::vector<PassStats>& passes() const { return passes_; }

  // One timed dispatch; `bytes` is what the algorithm reads and writes in it.
  template <typename Push>
  void dispatch(LazyPass& pass, const Push& push, std::uint64_t elements, const std::string& name,
                std::uint64_t bytes) {
    const device::ComputePass& pipeline = pass.get(device_);
    begin(name, bytes, true);
    commands_->dispatch(pipeline, push, elements);
    commands_->end_pass();
  }

  // One timed dispatch with workgroup counts from the device. Bytes and count are added by `did`, once known.
  template <typename Push>
  void dispatch_indirect(LazyPass& pass, const Push& push, const device::Buffer& arguments, std::uint64_t offset,
                         const std::string& name) {
    const device::ComputePass& pipeline = pass.get(device_);
    begin(name, 0, false);
    commands_->dispatch_indirect(pipeline, push, arguments, offset);
    commands_->end_pass();
  }

  void copy(const device::Buffer& source, const device::Buffer& target, std::uint64_t bytes,
            std::uint64_t target_offset = 0);
  void fill(const device::Buffer& target, std::uint32_t value);

  // Runs what is recorded and waits; `meanwhile` as Commands::submit_and_wait.
  void submit(const std::function<void()>& meanwhile = nullptr);

  // Drops what is recorded, and the passes counted so far.
  void abandon();

  // Counts `count` indirect dispatches that did work.
  void did(const std::string& name, std::uint32_t count, std::uint64_t bytes_each);

 private:
  device::Commands& commands();
  void begin(const std::string& name, std::uint64_t bytes, bool counts);
  PassStats& stats(const std::string& name);

  device::Device& device_;
  std::unique_ptr<device::Commands> commands_;
  std::uint32_t timed_ = 0;
  std::vector<PassStats> passes_;  // in order of first use
};

}  // namespace quadgraph
