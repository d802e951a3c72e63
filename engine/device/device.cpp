#include "engine/device/device.h"

#include <algorithm>
#include <utility>

#include "engine/device/live_objects.h"

namespace quadgraph::device {

void Device::set_check(std::function<void()> check, std::chrono::milliseconds pause) {
  check_ = std::move(check);
  pause_ = pause;
}

const Memory& Device::staging(std::uint64_t bytes) {
  if (staging_ && staging_bytes_ >= bytes) return *staging_;
  drop_staging();
  staging_ = allocate(bytes, Place::host, "staging");
  staging_bytes_ = bytes;
  count("staging", staging_->allocated);
  return *staging_;
}

void Device::drop_staging() noexcept {
  if (staging_) uncount("staging", staging_->allocated);
  staging_.reset();
}

void Device::update(const Memory& target, std::span<const std::byte> data) {
  if (!updates_) updates_ = record(0);
  updates_->update(target, data);
}

void Device::drop_transfers() noexcept {
  updates_.reset();
  drop_staging();
}

void Device::heed() {
  if (!interruptible_ || given_up_ || !check_) return;
  if (postponed_) {
    given_up_ = true;
    std::rethrow_exception(std::exchange(postponed_, nullptr));
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - checked_ < pause_) return;
  checked_ = now;
  given_up_ = true;
  check_();
  given_up_ = false;
}

void Device::heed_until(const std::function<bool()>& ended) {
  std::exception_ptr thrown;
  while (!ended()) {
    try {
      heed();
    } catch (...) {
      thrown = std::current_exception();
      given_up_ = false;  // so that the check goes on being called
    }
  }
  if (thrown) postponed_ = thrown;
}

Interruptible::Interruptible(Device& device) : device_(device), outer_(device.interruptible_) {
  if (!outer_) {
    device_.given_up_ = false;
    device_.postponed_ = nullptr;
  }
  device_.interruptible_ = true;
}

void Device::count(const std::string& purpose, std::uint64_t bytes) {
  allocated_bytes_ += bytes;
  allocated_by_purpose_[purpose] += bytes;
  ++allocation_count_;
  count_made(books_, "allocation");
  count_made(books_, "allocated byte", bytes);
  peak_allocated_bytes_ = std::max(peak_allocated_bytes_, allocated_bytes_);
}

void Device::uncount(const std::string& purpose, std::uint64_t bytes) noexcept {
  allocated_bytes_ -= bytes;
  count_gone(books_, "allocation");
  count_gone(books_, "allocated byte", bytes);
  const auto found = allocated_by_purpose_.find(purpose);
  found->second -= bytes;
  if (found->second == 0) allocated_by_purpose_.erase(found);
}

}  // namespace quadgraph::device
