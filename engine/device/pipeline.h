// Compute and graphics passes: shaders as a device runs them. They reach all data through addresses in their push
// constants.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "engine/device/device.h"

namespace quadgraph::device {

// Workgroups of a dispatch over that many elements.
constexpr std::uint64_t workgroups(std::uint64_t elements,
                                   std::uint32_t workgroup_size = ComputeOptions{}.workgroup_size) {
  return (elements + workgroup_size - 1) / workgroup_size;
}

class ComputePass {
 public:
  ComputePass(Device& device, const Shader& shader, const ComputeOptions& options = {})
      : push_size_(shader.push_size),
        workgroup_size_(options.workgroup_size),
        name_(std::string(shader.name) + (options.sp3 ? " sp3" : "")),
        pipeline_(device.compile(shader, options, name_)) {}

  const Pipeline& pipeline() const { return *pipeline_; }
  std::uint32_t push_size() const { return push_size_; }
  std::uint32_t workgroup_size() const { return workgroup_size_; }
  const std::string& name() const { return name_; }

 private:
  std::uint32_t push_size_, workgroup_size_;
  std::string name_;
  std::unique_ptr<Pipeline> pipeline_;
};

// Triangle lists without vertex buffers (shaders pull from addresses), what is nearest is seen.
class GraphicsPass {
 public:
  GraphicsPass(Device& device, const GraphicsOptions& options, const std::string& name)
      : push_size_(options.vertex->push_size), pipeline_(device.compile(options, name)) {}

  const Pipeline& pipeline() const { return *pipeline_; }
  std::uint32_t push_size() const { return push_size_; }

 private:
  std::uint32_t push_size_;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace quadgraph::device
