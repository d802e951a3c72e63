#include "engine/render/display/draw.h"

#include <cassert>

#include "engine/vk/arena.h"

namespace quadgraph {
namespace {

VkRenderingAttachmentInfo attachment(const vk::Image& image, VkImageLayout layout, const VkClearValue& clear) {
  VkRenderingAttachmentInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
  info.imageView = image.layer_view(0);
  info.imageLayout = layout;
  info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  info.clearValue = clear;
  return info;
}

VkExtent2D extent_of(const DrawTarget& target) {
  const vk::ImageOptions& options = target.depth->options();
  return {target.width > 0 ? target.width : options.width, target.height > 0 ? target.height : options.height};
}

void begin_rendering(vk::Commands& commands, const DrawTarget& target) {
  std::vector<VkRenderingAttachmentInfo> colours;
  for (const vk::Image* image : target.colours) {
    commands.transition(*image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    colours.push_back(attachment(*image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, {}));
  }
  commands.transition(*target.depth, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
  VkClearValue farthest{};
  farthest.depthStencil.depth = 1.0f;
  const auto depth = attachment(*target.depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, farthest);
  VkRenderingInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
  info.renderArea.extent = extent_of(target);
  info.layerCount = 1;
  info.colorAttachmentCount = static_cast<std::uint32_t>(colours.size());
  info.pColorAttachments = colours.data();
  info.pDepthAttachment = &depth;
  vkCmdBeginRendering(commands.handle(), &info);
}

// A negative height turns y up (VK_KHR_maintenance1).
void set_viewport(vk::Commands& commands, const DrawTarget& target, const Viewport& viewport) {
  const VkViewport turned{viewport.x, viewport.y + viewport.height, viewport.width, -viewport.height, 0.0f, 1.0f};
  const VkRect2D scissor{{0, 0}, extent_of(target)};
  vkCmdSetViewport(commands.handle(), 0, 1, &turned);
  vkCmdSetScissor(commands.handle(), 0, 1, &scissor);
}

}  // namespace

void draw_bytes(vk::Commands& commands, const DrawTarget& target, const Viewport& viewport,
                const vk::GraphicsPass& pass, const void* push, std::uint32_t push_size, const vk::Buffer& indices,
                std::uint32_t index_count) {
  assert(push_size == pass.push_size());
  begin_rendering(commands, target);
  set_viewport(commands, target, viewport);
  VkCommandBuffer handle = commands.handle();
  vkCmdBindPipeline(handle, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.pipeline());
  vkCmdPushConstants(handle, pass.layout(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, push_size,
                     push);
  const VkDescriptorSet texels = commands.context().arenas().set();
  vkCmdBindDescriptorSets(handle, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.layout(), 0, 1, &texels, 0, nullptr);
  vkCmdBindIndexBuffer(handle, indices.handle(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexed(handle, index_count, 1, 0, 0, 0);
  vkCmdEndRendering(handle);
  for (const vk::Image* image : target.colours) {
    commands.transition(*image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  }
  commands.transition(*target.depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
}

}  // namespace quadgraph
