// Compute and graphics pipelines. Shaders reach all data through addresses in their push constants; the one descriptor
// set, alike for all, is the arenas' (arena.h).
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/vk/context.h"
#include "engine/vk/handle.h"

namespace quadgraph::vk {

// A SPIR-V module as the build embeds it ("spirv/NAME.STAGE.h").
using Spirv = std::span<const std::uint32_t>;

// A pipeline by the arenas whose arrays shaders load as texels (Arenas::complete); made when it is wanted.
using LoadingPipelines = std::map<std::uint32_t, UniquePipeline>;

// How the invocations of a pass share its elements.
enum class Work {
  each,        // one element each
  strided,     // shaders/shared/stride.glsl: several each, where few workgroups are fastest
  reducing,    // the same, and what comes of a reduction is for a dispatch of its own there
  conclusion,  // that dispatch, of one workgroup (shaders/shared/part.glsl)
};

// Whether few workgroups with long loops are fastest: on a device of type CPU, unless it was told to have no arenas.
bool few_workgroups(Context& context);

// Of a strided pass over that many elements.
std::uint32_t strided_workgroups(Context& context, std::uint64_t elements);

class ComputePass {
 public:
  // `push_size` in bytes must equal the size of the shader's push-constant block, and `workgroup_size` its
  // local_size_x unless it is strided; `variant` is its specialization constant 1, if it has one.
  ComputePass(Context& context, Spirv code, std::uint32_t push_size, const std::string& name,
              std::uint32_t workgroup_size = default_workgroup_size, std::uint32_t variant = 0, Work work = Work::each);

  static constexpr std::uint32_t default_workgroup_size = 256;  // WORKGROUP_SIZE in shaders/shared/shared.h

  // For what the arenas hold now.
  VkPipeline pipeline() const;
  VkPipelineLayout layout() const { return layout_.get(); }
  std::uint32_t push_size() const { return push_size_; }
  std::uint32_t workgroup_size() const { return workgroup_size_; }
  std::uint64_t workgroups(std::uint64_t elements) const;
  const std::string& name() const { return name_; }

 private:
  Context& context_;
  Spirv code_;
  std::uint32_t push_size_;
  std::uint32_t workgroup_size_;
  std::uint32_t variant_;
  Work work_;
  std::string name_;
  UniquePipelineLayout layout_;
  mutable LoadingPipelines pipelines_;
};

struct GraphicsOptions {
  Spirv vertex;
  Spirv fragment;                                // empty: depth only
  std::uint32_t push_size = 0;                   // bytes, visible to both stages
  std::vector<VkFormat> colour_formats;          // no blending
  VkFormat depth_format = VK_FORMAT_D32_SFLOAT;  // VK_FORMAT_UNDEFINED: no depth test
  VkCullModeFlags cull = VK_CULL_MODE_BACK_BIT;  // front faces are counter-clockwise in the window with y up
  std::uint32_t variant = 0;                     // specialization constant 1 of the shaders that have it
};

// Triangle lists without vertex buffers (shaders pull from addresses), dynamic viewport and scissor, depth test LESS.
class GraphicsPass {
 public:
  GraphicsPass(Context& context, const GraphicsOptions& options, const std::string& name);

  VkPipeline pipeline() const;
  VkPipelineLayout layout() const { return layout_.get(); }
  std::uint32_t push_size() const { return options_.push_size; }

 private:
  Context& context_;
  GraphicsOptions options_;
  std::string name_;
  UniquePipelineLayout layout_;
  mutable LoadingPipelines pipelines_;
};

}  // namespace quadgraph::vk
