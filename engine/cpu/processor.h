// The processor as a device: shaders compiled as C++ (engine/cpu/kernel.h), run at once as they are recorded.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "engine/cpu/thread_pool.h"
#include "engine/cpu/triangles.h"
#include "engine/device/device.h"

namespace quadgraph::cpu {

struct ProcessorOptions {
  unsigned threads = 0;  // 0: one for each core that this process may use, or QUADGRAPH_THREADS of the environment
};

class Processor : public device::Device {
 public:
  // Throws DeviceError where the processor has none of the levels of instructions that shaders were compiled for.
  explicit Processor(const ProcessorOptions& options = {});
  ~Processor() override;

  ThreadPool& threads() { return threads_; }

  // ThreadPool::run, but the caller heeds the device's check between its parts; what that throws leaves out the rest.
  void run(std::uint32_t count, std::uint32_t part, const std::function<void(std::uint32_t, std::uint32_t)>& work,
           const std::function<void()>& last = {});

  DrawMemory& draw_memory() { return draw_memory_; }

  std::unique_ptr<device::Memory> allocate(std::uint64_t bytes, device::Place place, const std::string& name) override;
  std::unique_ptr<device::ImageMemory> allocate(const device::ImageOptions& options, const std::string& name) override;
  std::unique_ptr<device::Pipeline> compile(const device::Shader& shader, const device::ComputeOptions& options,
                                            const std::string& name) override;
  std::unique_ptr<device::Pipeline> compile(const device::GraphicsOptions& options, const std::string& name) override;
  std::unique_ptr<device::Recording> record(std::uint32_t max_passes) override;

 private:
  void check_room(std::uint64_t size) const;

  std::size_t level_;  // of instructions: index of device::CpuCode
  ThreadPool threads_;
  DrawMemory draw_memory_;
};

}  // namespace quadgraph::cpu
