// What the engine computes and draws with: a Vulkan device (engine/vk) or the processor (engine/cpu). Everything else
// in this room borrows a Device and must die before it.
#pragma once

#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/device/shader.h"

namespace quadgraph::vk {
struct SurfaceSource;
}

namespace quadgraph::device {

// DeviceOptions::device of the processor.
inline constexpr const char* processor = "cpu";

struct DeviceOptions {
  // Load VK_LAYER_KHRONOS_validation and keep its messages; DeviceError if the layer is not installed.
  bool validation = false;
  // "cpu": the processor. Else part of the name of a Vulkan device, case-insensitive. Empty: what QUADGRAPH_DEVICE
  // of the environment names, else a discrete GPU, else an integrated one, else the processor.
  std::string device = "";
  // The surface of the window to present to (engine/vk/context.h); null: no window, and nothing that windows need is
  // asked of the device.
  std::shared_ptr<const vk::SurfaceSource> surface = nullptr;
  // Called between pieces of work that may be given up (Interruptible), a pause after the last call at the earliest, on
  // the thread that waits for them; gives the work up by throwing.
  std::function<void()> check = nullptr;
  std::chrono::milliseconds pause{50};
};

enum class Place {
  device,  // fastest for the device
  host,    // mapped, coherent, cached if possible: uploads and read-backs
};

struct DeviceInfo {
  std::string name;
  std::string driver;  // name and version
  bool cpu = false;    // computes on the processor
};

enum class Format { rgba32_float, r32_uint, depth32_float };

constexpr std::uint32_t texel_bytes(Format format) {
  return format == Format::rgba32_float ? 16 : 4;
}

struct ImageOptions {
  Format format = Format::rgba32_float;
  std::uint32_t width = 1;   // pixels
  std::uint32_t height = 1;  // pixels
  std::uint32_t layers = 1;
};

struct ComputeOptions {
  bool sp3 = false;                    // the code for SP3
  std::uint32_t variant = 0;           // specialization constant 1 of a shader that has it
  std::uint32_t workgroup_size = 256;  // local_size_x; WORKGROUP_SIZE in shaders/shared/shared.h
};

enum class Cull { none, back, front };

// From what is nearest to what is farthest: from 0 to 1, or from 1 to 0, where floating point is finest at the far end.
enum class Depth { rises, falls };

struct GraphicsOptions {
  const Shader* vertex;       // its push constants are visible to both stages
  const Shader* fragment;     // null: depth only
  std::uint32_t colours = 0;  // images that it writes; no blending
  Format colour = Format::rgba32_float;
  Cull cull = Cull::back;     // front faces are counter-clockwise in the window with y up
  std::uint32_t variant = 0;  // specialization constant 1 of the shaders that have it
  Depth depth = Depth::rises;

  float farthest() const { return depth == Depth::rises ? 1.0f : 0.0f; }
};

// Device time of one named pass.
struct PassTime {
  std::string name;
  double time_ms = 0;
};

// A rectangle of the target, pixels; it may begin outside, so that a tile shows a part of a larger picture.
struct Viewport {
  float x = 0, y = 0, width = 0, height = 0;
};

// What devices make, for the classes of this room alone.
struct Memory {
  virtual ~Memory() = default;
  std::uint64_t address = 0;  // of the first byte, as shaders have it
  void* mapped = nullptr;     // null where the host does not see it
  std::uint64_t allocated = 0;
};
struct ImageMemory {
  virtual ~ImageMemory() = default;
  std::uint64_t address = 0;  // of the first texel, where shaders can read the image as a buffer: rows tightly packed
  std::uint64_t allocated = 0;
};
struct Pipeline {
  virtual ~Pipeline() = default;
};

struct DrawImages {
  std::vector<ImageMemory*> colours;
  ImageMemory* depth = nullptr;
  std::uint32_t width = 0, height = 0;  // of the upper left part that is cleared and drawn into, pixels
};

// What Commands (commands.h) says in words of the device; each is seen by all that follows.
class Recording {
 public:
  virtual ~Recording() = default;
  virtual void copy(const Memory& source, const Memory& target, std::uint64_t bytes, std::uint64_t target_offset,
                    std::uint64_t source_offset) = 0;
  virtual void copy(const ImageMemory& source, const Memory& target, std::uint32_t width, std::uint32_t height) = 0;
  virtual void fill(const Memory& target, std::uint64_t bytes, std::uint32_t value) = 0;
  virtual void update(const Memory& target, std::span<const std::byte> data) = 0;
  virtual void dispatch(const Pipeline& pass, const void* push, std::uint32_t groups) = 0;
  virtual void dispatch_indirect(const Pipeline& pass, const void* push, const Memory& arguments,
                                 std::uint64_t offset) = 0;
  virtual void draw(const DrawImages& target, const Viewport& viewport, const Pipeline& pass, const void* push,
                    const Memory* indices, std::uint32_t vertices) = 0;
  virtual void begin_pass(const std::string& name) = 0;
  virtual void end_pass() = 0;
  virtual std::vector<PassTime> submit_and_wait(const std::function<void()>& meanwhile) = 0;
};

class Device {
 public:
  Device() = default;
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }
  std::uint64_t max_buffer_bytes() const { return max_buffer_bytes_; }
  std::uint32_t max_image_side() const { return max_image_side_; }  // pixels
  std::uint32_t max_workgroups() const { return max_workgroups_; }  // of a dispatch
  bool one_by_one() const { return one_by_one_; }  // a thread runs invocations one after the other, not side by side
  const std::vector<std::string>& validation_messages() const { return messages_; }  // so far

  // Bytes of buffers and images now, the most there ever were at a time, and by purpose (memory.h) without those that
  // have none; and how many were ever made.
  std::uint64_t allocated_bytes() const { return allocated_bytes_; }
  std::uint64_t peak_allocated_bytes() const { return peak_allocated_bytes_; }
  const std::map<std::string, std::uint64_t>& allocated_by_purpose() const { return allocated_by_purpose_; }
  std::uint64_t allocation_count() const { return allocation_count_; }

  // Throw DeviceError naming what has no room or is not allowed.
  virtual std::unique_ptr<Memory> allocate(std::uint64_t bytes, Place place, const std::string& name) = 0;
  virtual std::unique_ptr<ImageMemory> allocate(const ImageOptions& options, const std::string& name) = 0;
  virtual std::unique_ptr<Pipeline> compile(const Shader& shader, const ComputeOptions& options,
                                            const std::string& name) = 0;
  virtual std::unique_ptr<Pipeline> compile(const GraphicsOptions& options, const std::string& name) = 0;
  virtual std::unique_ptr<Recording> record(std::uint32_t max_passes) = 0;

  // Host memory for uploads and read-backs, of at least so many bytes, which it keeps: a driver takes milliseconds to
  // make some.
  const Memory& staging(std::uint64_t bytes);

  // Replaces the first bytes of memory that the host does not see, at most 65536, a multiple of 4, before what is
  // submitted next.
  void update(const Memory& target, std::span<const std::byte> data);

  // Updates that have not been submitted yet, which become the caller's; null if there are none.
  std::unique_ptr<Recording> take_updates() noexcept { return std::move(updates_); }

  // Calls DeviceOptions::check where it is due. For recordings, between pieces of work.
  void heed();

  // The same until `ended` says so, which waits a moment for a piece of work that cannot be given up. What the check
  // throws meanwhile the next call of heed() throws.
  void heed_until(const std::function<bool()>& ended);

  // As DeviceOptions.
  void set_check(std::function<void()> check, std::chrono::milliseconds pause);

  // Books of Buffer and Image.
  void count(const std::string& purpose, std::uint64_t bytes);
  void uncount(const std::string& purpose, std::uint64_t bytes) noexcept;

 protected:
  DeviceInfo info_;
  std::uint64_t max_buffer_bytes_ = 0;
  std::uint32_t max_image_side_ = 0;
  std::uint32_t max_workgroups_ = 0;
  bool one_by_one_ = false;
  std::vector<std::string> messages_;
  const void* books_ = this;  // in live_objects.h

  // Staging memory and updates, of the derived device while it still can.
  void drop_transfers() noexcept;

 private:
  friend class Interruptible;
  friend class Uninterrupted;

  void drop_staging() noexcept;

  std::unique_ptr<Recording> updates_;
  std::unique_ptr<Memory> staging_;
  std::uint64_t staging_bytes_ = 0;
  std::function<void()> check_;
  std::chrono::milliseconds pause_{0};
  std::chrono::steady_clock::time_point checked_;  // last
  bool interruptible_ = false, given_up_ = false;
  std::exception_ptr postponed_;  // what the check has thrown amid what cannot be given up
  std::uint64_t allocated_bytes_ = 0;
  std::uint64_t peak_allocated_bytes_ = 0;
  std::uint64_t allocation_count_ = 0;
  std::map<std::string, std::uint64_t> allocated_by_purpose_;
};

// While it lives, the device's check is not called: what is tidied up is not given up.
class Uninterrupted {
 public:
  explicit Uninterrupted(Device& device) : device_(device), outer_(device.interruptible_) {
    device_.interruptible_ = false;
  }
  ~Uninterrupted() { device_.interruptible_ = outer_; }
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;

 private:
  Device& device_;
  bool outer_;
};

// While it lives, the device's work may be given up half-way. Then no buffer that was being written may be relied upon.
class Interruptible {
 public:
  explicit Interruptible(Device& device);
  ~Interruptible() { device_.interruptible_ = outer_; }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  bool given_up() const { return device_.given_up_; }

 private:
  Device& device_;
  bool outer_;
};

}  // namespace quadgraph::device
