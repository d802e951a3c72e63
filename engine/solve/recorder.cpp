#include "engine/solve/recorder.h"

#include <algorithm>

namespace quadgraph {
namespace {

// Timed dispatches per command buffer, more than a frame has. Beyond it, what is recorded is submitted.
constexpr std::uint32_t max_timed = 4096;

}  // namespace

device::Commands& Recorder::commands() {
  if (!commands_) commands_ = std::make_unique<device::Commands>(device_, max_timed);
  return *commands_;
}

PassStats& Recorder::stats(const std::string& name) {
  const auto found = std::find_if(passes_.begin(), passes_.end(), [&](const PassStats& p) { return p.name == name; });
  if (found != passes_.end()) return *found;
  passes_.push_back({.name = name});
  return passes_.back();
}

void Recorder::begin(const std::string& name, std::uint64_t bytes, bool counts) {
  if (timed_ == max_timed) submit();
  PassStats& pass = stats(name);
  pass.bytes += bytes;
  pass.count += counts ? 1 : 0;
  commands().begin_pass(name);
  ++timed_;
}

void Recorder::copy(const device::Buffer& source, const device::Buffer& target, std::uint64_t bytes,
                    std::uint64_t target_offset) {
  commands().copy(source, target, bytes, target_offset);
}

void Recorder::fill(const device::Buffer& target, std::uint32_t value) {
  commands().fill(target, value);
}

void Recorder::submit(const std::function<void()>& meanwhile) {
  if (!commands_) return meanwhile ? meanwhile() : void();
  const std::unique_ptr<device::Commands> running = std::move(commands_);
  timed_ = 0;
  for (const device::PassTime& time : running->submit_and_wait(meanwhile)) stats(time.name).time_ms += time.time_ms;
}

void Recorder::abandon() {
  commands_.reset();
  timed_ = 0;
  clear();
}

void Recorder::did(const std::string& name, std::uint32_t count, std::uint64_t bytes_each) {
  PassStats& pass = stats(name);
  pass.count += count;
  pass.bytes += count * bytes_each;
}

}  // namespace quadgraph
