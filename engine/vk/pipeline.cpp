#include "engine/vk/pipeline.h"

#include <algorithm>
#include <chrono>
#include <future>
#include <vector>

#include "engine/base/error.h"
#include "engine/vk/memory.h"

namespace quadgraph::vk {
namespace {

UniqueShaderModule shader_module(Context& context, device::Spirv code, const std::string& name) {
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
    throw DeviceError(name + " needs " + std::to_string(push_size) + " bytes of push constants, " +
                      context.info().name + " allows " + std::to_string(context.limits().maxPushConstantsSize));
  }
  const VkPushConstantRange range{stages, 0, push_size};
  VkPipelineLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
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

// Specialization constant 1, the variant of a shader that has it.
struct Constants {
  std::uint32_t variant;
  VkSpecializationMapEntry entry{1, 0, sizeof(std::uint32_t)};
  VkSpecializationInfo info{1, &entry, sizeof(std::uint32_t), &variant};

  explicit Constants(std::uint32_t value) : variant(value) {}
  Constants(const Constants&) = delete;
  Constants& operator=(const Constants&) = delete;
};

// The fixed-function state of every graphics pass, kept alive while the pipeline is created.
struct FixedState {
  VkPipelineVertexInputStateCreateInfo vertex_input{};
  VkPipelineInputAssemblyStateCreateInfo assembly{};
  VkPipelineViewportStateCreateInfo viewport{};
  VkPipelineRasterizationStateCreateInfo raster{};
  VkPipelineMultisampleStateCreateInfo multisample{};
  VkPipelineDepthStencilStateCreateInfo depth{};
  std::vector<VkPipelineColorBlendAttachmentState> attachments;
  std::vector<VkFormat> formats;
  VkPipelineColorBlendStateCreateInfo blend{};
  std::vector<VkDynamicState> dynamic_states = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{};
  VkPipelineRenderingCreateInfo rendering{};

  explicit FixedState(const device::GraphicsOptions& options) {
    vertex_input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    raster.polygonMode = VK_POLYGON_MODE_FILL;
    raster.cullMode = options.cull == device::Cull::back    ? VK_CULL_MODE_BACK_BIT
                      : options.cull == device::Cull::front ? VK_CULL_MODE_FRONT_BIT
                                                            : VK_CULL_MODE_NONE;
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

  void set_outputs(const device::GraphicsOptions& options) {
    depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    depth.depthTestEnable = VK_TRUE;
    depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = options.depth == device::Depth::rises ? VK_COMPARE_OP_LESS : VK_COMPARE_OP_GREATER;
    VkPipelineColorBlendAttachmentState opaque{};
    opaque.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    attachments.assign(options.colours, opaque);
    formats.assign(options.colours, vulkan_format(options.colour));
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = options.colours;
    blend.pAttachments = attachments.data();
    rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
    rendering.colorAttachmentCount = options.colours;
    rendering.pColorAttachmentFormats = formats.data();
    rendering.depthAttachmentFormat = VK_FORMAT_D32_SFLOAT;
  }
};

}  // namespace

Pipeline::Pipeline(Context& context, const device::Shader& shader, const device::ComputeOptions& options,
                   const std::string& name)
    : stages(VK_SHADER_STAGE_COMPUTE_BIT),
      push_size(shader.push_size),
      layout(push_layout(context, push_size, stages, name)) {
  const UniqueShaderModule module = shader_module(context, options.sp3 ? shader.sp3 : shader.code, name);
  const Constants constants(options.variant);
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage = stage(VK_SHADER_STAGE_COMPUTE_BIT, module, constants.info);
  info.layout = layout.get();
  make(context, name, "vkCreateComputePipelines", [&](VkPipeline* made) {
    return vkCreateComputePipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr, made);
  });
}

Pipeline::Pipeline(Context& context, const device::GraphicsOptions& options, const std::string& name)
    : stages(VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT),
      push_size(options.vertex->push_size),
      farthest(options.farthest()),
      layout(push_layout(context, push_size, stages, name)) {
  const UniqueShaderModule vertex = shader_module(context, options.vertex->code, name + ".vert");
  const Constants constants(options.variant);
  std::vector<VkPipelineShaderStageCreateInfo> all = {stage(VK_SHADER_STAGE_VERTEX_BIT, vertex, constants.info)};
  UniqueShaderModule fragment;
  if (options.fragment != nullptr) {
    fragment = shader_module(context, options.fragment->code, name + ".frag");
    all.push_back(stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, constants.info));
  }
  const FixedState state(options);
  VkGraphicsPipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
  info.pNext = &state.rendering;
  info.stageCount = static_cast<std::uint32_t>(all.size());
  info.pStages = all.data();
  info.pVertexInputState = &state.vertex_input;
  info.pInputAssemblyState = &state.assembly;
  info.pViewportState = &state.viewport;
  info.pRasterizationState = &state.raster;
  info.pMultisampleState = &state.multisample;
  info.pDepthStencilState = &state.depth;
  info.pColorBlendState = &state.blend;
  info.pDynamicState = &state.dynamic;
  info.layout = layout.get();
  make(context, name, "vkCreateGraphicsPipelines", [&](VkPipeline* made) {
    return vkCreateGraphicsPipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr, made);
  });
}

// In a thread of its own, as drivers compile for up to seconds, in which the device goes on being heeded.
void Pipeline::make(Context& context, const std::string& name, const char* call,
                    const std::function<VkResult(VkPipeline*)>& compile) {
  VkPipeline made = VK_NULL_HANDLE;
  std::future<VkResult> result = std::async(std::launch::async, [&] { return compile(&made); });
  context.heed_until([&] { return result.wait_for(std::chrono::milliseconds(5)) == std::future_status::ready; });
  check(result.get(), std::string(call) + " '" + name + "'");
  pipeline = UniquePipeline(context.device(), made);
  context.set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(made), name);
}

std::unique_ptr<device::Pipeline> Context::compile(const device::Shader& shader, const device::ComputeOptions& options,
                                                   const std::string& name) {
  return std::make_unique<Pipeline>(*this, shader, options, name);
}

std::unique_ptr<device::Pipeline> Context::compile(const device::GraphicsOptions& options, const std::string& name) {
  return std::make_unique<Pipeline>(*this, options, name);
}

}  // namespace quadgraph::vk
