#include "engine/vk/pipeline.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "engine/base/error.h"
#include "engine/vk/arena.h"

namespace quadgraph::vk {
namespace {

UniqueShaderModule shader_module(Context& context, Spirv code, const std::string& name) {
  VkShaderModuleCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  info.codeSize = code.size_bytes();
  info.pCode = code.data();
  VkShaderModule module = VK_NULL_HANDLE;
  check(vkCreateShaderModule(context.device(), &info, nullptr, &module), "vkCreateShaderModule '" + name + "'");
  return {context.device(), module};
}

UniquePipelineLayout push_layout(Context& context, std::uint32_t push_size, VkShaderStageFlags stages,
                                 const std::string& name) {
  if (push_size > context.limits().maxPushConstantsSize) {
    throw VulkanError(name + " needs " + std::to_string(push_size) + " bytes of push constants, " +
                      context.info().name + " allows " + std::to_string(context.limits().maxPushConstantsSize));
  }
  const VkPushConstantRange range{stages, 0, push_size};
  const VkDescriptorSetLayout texels = context.arenas().layout();
  VkPipelineLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  info.setLayoutCount = 1;
  info.pSetLayouts = &texels;
  info.pushConstantRangeCount = push_size > 0 ? 1 : 0;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  check(vkCreatePipelineLayout(context.device(), &info, nullptr, &layout), "vkCreatePipelineLayout '" + name + "'");
  return {context.device(), layout};
}

VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits bit, const UniqueShaderModule& module,
                                      const VkSpecializationInfo& constants) {
  VkPipelineShaderStageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage = bit;
  info.module = module.get();
  info.pName = "main";
  info.pSpecializationInfo = &constants;
  return info;
}

// Specialization constants by their number: how shaders load arrays (shaders/shared/load.glsl), and a variant of their
// own.
struct Constants {
  static constexpr std::uint32_t count = 4 + arena_count;
  std::array<std::uint32_t, count> values;
  std::array<VkSpecializationMapEntry, count> entries;
  VkSpecializationInfo info{count, entries.data(), sizeof(values), values.data()};

  explicit Constants(Context& context, std::uint32_t variant = 0, std::uint32_t part = 0,
                     std::uint32_t workgroup_size = 0) {
    values[0] = context.arenas().complete();
    values[1] = variant;
    for (std::uint32_t i = 0; i < arena_count; ++i) {
      values[2 + i] = static_cast<std::uint32_t>(context.arenas()[i].address());
    }
    values[2 + arena_count] = part;
    values[3 + arena_count] = workgroup_size;
    for (std::uint32_t i = 0; i < count; ++i) {
      entries[i] = {i, static_cast<std::uint32_t>(i * sizeof(std::uint32_t)), sizeof(std::uint32_t)};
    }
  }
  Constants(const Constants&) = delete;
  Constants& operator=(const Constants&) = delete;
};

// shaders/shared/part.glsl.
constexpr std::uint32_t part_whole = 0, part_sums = 1, part_conclusion = 2;

// On two to dozens of cores: enough to share out, few enough that starting and reducing them costs nothing.
constexpr std::uint32_t most_strided = 64, strided_size = 8;

// The fixed-function state of every graphics pass, kept alive while the pipeline is created.
struct FixedState {
  VkPipelineVertexInputStateCreateInfo vertex_input{};
  VkPipelineInputAssemblyStateCreateInfo assembly{};
  VkPipelineViewportStateCreateInfo viewport{};
  VkPipelineRasterizationStateCreateInfo raster{};
  VkPipelineMultisampleStateCreateInfo multisample{};
  VkPipelineDepthStencilStateCreateInfo depth{};
  std::vector<VkPipelineColorBlendAttachmentState> attachments;
  VkPipelineColorBlendStateCreateInfo blend{};
  std::vector<VkDynamicState> dynamic_states = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{};
  VkPipelineRenderingCreateInfo rendering{};

  explicit FixedState(const GraphicsOptions& options) {
    vertex_input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    raster.polygonMode = VK_POLYGON_MODE_FILL;
    raster.cullMode = options.cull;
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    raster.lineWidth = 1.0f;
    multisample.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    multisample.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    set_outputs(options);
    dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
    dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size());
    dynamic.pDynamicStates = dynamic_states.data();
  }
  FixedState(const FixedState&) = delete;
  FixedState& operator=(const FixedState&) = delete;

  void set_outputs(const GraphicsOptions& options) {
    const bool has_depth = options.depth_format != VK_FORMAT_UNDEFINED;
    depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    depth.depthTestEnable = has_depth;
    depth.depthWriteEnable = has_depth;
    depth.depthCompareOp = VK_COMPARE_OP_LESS;
    VkPipelineColorBlendAttachmentState opaque{};
    opaque.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    attachments.assign(options.colour_formats.size(), opaque);
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = static_cast<std::uint32_t>(attachments.size());
    blend.pAttachments = attachments.data();
    rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
    rendering.colorAttachmentCount = static_cast<std::uint32_t>(options.colour_formats.size());
    rendering.pColorAttachmentFormats = options.colour_formats.data();
    rendering.depthAttachmentFormat = options.depth_format;
  }
};

}  // namespace

bool few_workgroups(Context& context) {
  return context.arenas()[0].used();
}

std::uint32_t strided_workgroups(Context& context, std::uint64_t elements) {
  const bool few = few_workgroups(context);
  const std::uint64_t size = few ? strided_size : ComputePass::default_workgroup_size;
  const std::uint64_t groups = (elements + size - 1) / size;
  return static_cast<std::uint32_t>(few ? std::min<std::uint64_t>(groups, most_strided) : groups);
}

ComputePass::ComputePass(Context& context, Spirv code, std::uint32_t push_size, const std::string& name,
                         std::uint32_t workgroup_size, std::uint32_t variant, Work work)
    : context_(context),
      code_(code),
      push_size_(push_size),
      workgroup_size_(work != Work::each && few_workgroups(context) ? strided_size : workgroup_size),
      variant_(variant),
      work_(work),
      name_(name),
      layout_(push_layout(context, push_size, VK_SHADER_STAGE_COMPUTE_BIT, name)) {
  const VkPhysicalDeviceLimits& limits = context.limits();
  const std::uint32_t largest = std::min(limits.maxComputeWorkGroupInvocations, limits.maxComputeWorkGroupSize[0]);
  if (workgroup_size > largest) {
    throw VulkanError(name + " needs workgroups of " + std::to_string(workgroup_size) + " invocations, " +
                      context.info().name + " allows " + std::to_string(largest));
  }
  pipeline();
}

std::uint64_t ComputePass::workgroups(std::uint64_t elements) const {
  if (work_ != Work::each) return strided_workgroups(context_, elements);
  return (elements + workgroup_size_ - 1) / workgroup_size_;
}

VkPipeline ComputePass::pipeline() const {
  UniquePipeline& made = pipelines_[context_.arenas().complete()];
  if (made.get() != VK_NULL_HANDLE) return made.get();
  const UniqueShaderModule module = shader_module(context_, code_, name_);
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  const std::uint32_t part = work_ == Work::conclusion                             ? part_conclusion
                             : work_ == Work::reducing && few_workgroups(context_) ? part_sums
                                                                                   : part_whole;
  const Constants constants(context_, variant_, part, workgroup_size_);
  info.stage = stage(VK_SHADER_STAGE_COMPUTE_BIT, module, constants.info);
  info.layout = layout_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(context_.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines '" + name_ + "'");
  made = UniquePipeline(context_.device(), pipeline);
  context_.set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), name_);
  return pipeline;
}

GraphicsPass::GraphicsPass(Context& context, const GraphicsOptions& options, const std::string& name)
    : context_(context),
      options_(options),
      name_(name),
      layout_(
          push_layout(context, options.push_size, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, name)) {
  pipeline();
}

VkPipeline GraphicsPass::pipeline() const {
  UniquePipeline& made = pipelines_[context_.arenas().complete()];
  if (made.get() != VK_NULL_HANDLE) return made.get();
  const UniqueShaderModule vertex = shader_module(context_, options_.vertex, name_ + ".vert");
  const Constants constants(context_, options_.variant);
  std::vector<VkPipelineShaderStageCreateInfo> stages = {stage(VK_SHADER_STAGE_VERTEX_BIT, vertex, constants.info)};
  UniqueShaderModule fragment;
  if (!options_.fragment.empty()) {
    fragment = shader_module(context_, options_.fragment, name_ + ".frag");
    stages.push_back(stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, constants.info));
  }
  const FixedState state(options_);
  VkGraphicsPipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
  info.pNext = &state.rendering;
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &state.vertex_input;
  info.pInputAssemblyState = &state.assembly;
  info.pViewportState = &state.viewport;
  info.pRasterizationState = &state.raster;
  info.pMultisampleState = &state.multisample;
  info.pDepthStencilState = &state.depth;
  info.pColorBlendState = &state.blend;
  info.pDynamicState = &state.dynamic;
  info.layout = layout_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateGraphicsPipelines(context_.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateGraphicsPipelines '" + name_ + "'");
  made = UniquePipeline(context_.device(), pipeline);
  context_.set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), name_);
  return pipeline;
}

}  // namespace quadgraph::vk
