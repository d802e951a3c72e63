// Compute and graphics pipelines, without descriptors.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "engine/device/device.h"
#include "engine/vk/context.h"
#include "engine/vk/handle.h"

namespace quadgraph::vk {

struct Pipeline : device::Pipeline {
  Pipeline(Context& context, const device::Shader& shader, const device::ComputeOptions& options,
           const std::string& name);

  // Triangle lists without vertex buffers, dynamic viewport and scissor, what is nearest is seen.
  Pipeline(Context& context, const device::GraphicsOptions& options, const std::string& name);

  VkShaderStageFlags stages;  // that see the push constants
  std::uint32_t push_size;    // bytes
  float farthest = 1;         // depth to which a draw clears
  UniquePipelineLayout layout;
  UniquePipeline pipeline;

 private:
  void make(Context& context, const std::string& name, const char* call,
            const std::function<VkResult(VkPipeline*)>& compile);
};

}  // namespace quadgraph::vk
