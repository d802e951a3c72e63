#include "engine/vk/commands.h"

#include <array>
#include <cassert>
#include <exception>

#include "engine/vk/pipeline.h"

namespace quadgraph::vk {
namespace {

constexpr VkPipelineStageFlags2 all_stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr VkAccessFlags2 all_access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
constexpr std::uint64_t slice_ns = 5'000'000;  // of waiting for software

VkRenderingAttachmentInfo attachment(const ImageMemory& image, VkImageLayout layout, const VkClearValue& clear) {
  VkRenderingAttachmentInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
  info.imageView = image.views[0].get();
  info.imageLayout = layout;
  info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  info.clearValue = clear;
  return info;
}

}  // namespace

RecordingParts::RecordingParts(Context& context, std::uint32_t wanted) : query_count(wanted) {
  VkCommandPoolCreateInfo pool_info{};
  pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool_info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool_info.queueFamilyIndex = context.queue_family();
  VkCommandPool made_pool = VK_NULL_HANDLE;
  check(vkCreateCommandPool(context.device(), &pool_info, nullptr, &made_pool), "vkCreateCommandPool");
  pool = UniqueCommandPool(context.device(), made_pool);

  VkCommandBufferAllocateInfo buffer_info{};
  buffer_info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  buffer_info.commandPool = made_pool;
  buffer_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  buffer_info.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(context.device(), &buffer_info, &commands), "vkAllocateCommandBuffers");

  if (query_count > 0) {
    VkQueryPoolCreateInfo query_info{};
    query_info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    query_info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    query_info.queryCount = query_count;
    VkQueryPool made_queries = VK_NULL_HANDLE;
    check(vkCreateQueryPool(context.device(), &query_info, nullptr, &made_queries), "vkCreateQueryPool");
    queries = UniqueQueryPool(context.device(), made_queries);
  }

  VkFenceCreateInfo fence_info{};
  fence_info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  VkFence made_fence = VK_NULL_HANDLE;
  check(vkCreateFence(context.device(), &fence_info, nullptr, &made_fence), "vkCreateFence");
  fence = UniqueFence(context.device(), made_fence);
}

Recording::Recording(Context& context, std::uint32_t max_passes)
    : context_(context), max_passes_(max_passes), host_timed_(context.info().cpu) {
  const std::uint32_t queries = host_timed_ ? 0 : 2 * max_passes;
  parts_ = context.take_parts(queries);
  if (queries > 0) vkResetQueryPool(context.device(), parts_->queries.get(), 0, queries);
  begin();
}

Recording::~Recording() {
  if (vkResetCommandPool(context_.device(), parts_->pool.get(), 0) != VK_SUCCESS) return;
  context_.give_back(std::move(parts_));
}

void Recording::begin() {
  VkCommandBufferBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(parts_->commands, &info), "vkBeginCommandBuffer");
}

void Recording::show_to(VkPipelineStageFlags2 stages, VkAccessFlags2 access) {
  VkMemoryBarrier2 memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
  memory.srcStageMask = all_stages;
  memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  memory.dstStageMask = stages;
  memory.dstAccessMask = access;
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(parts_->commands, &info);
}

void Recording::barrier() {
  show_to(all_stages, all_access);
  unfinished_ = true;
  stamped_ = false;
}

void Recording::transition(const ImageMemory& image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  barrier.srcStageMask = all_stages;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstStageMask = all_stages;
  barrier.dstAccessMask = all_access;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image.get();
  barrier.subresourceRange = {image.aspect(), 0, 1, 0, image.options.layers};
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(parts_->commands, &info);
  unfinished_ = true;
  stamped_ = false;
}

void Recording::copy(const device::Memory& source, const device::Memory& target, std::uint64_t bytes,
                     std::uint64_t target_offset, std::uint64_t source_offset) {
  const VkBufferCopy region{source_offset, target_offset, bytes};
  vkCmdCopyBuffer(parts_->commands, handle_of(source), handle_of(target), 1, &region);
  barrier();
}

void Recording::copy(const device::ImageMemory& source, const device::Memory& target, std::uint32_t width,
                     std::uint32_t height) {
  const auto& image = static_cast<const ImageMemory&>(source);
  VkBufferImageCopy region{};
  region.imageSubresource = {image.aspect(), 0, 0, image.options.layers};
  region.imageExtent = {width, height, 1};
  vkCmdCopyImageToBuffer(parts_->commands, image.image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, handle_of(target),
                         1, &region);
  barrier();
}

void Recording::update(const device::Memory& target, std::span<const std::byte> data) {
  vkCmdUpdateBuffer(parts_->commands, handle_of(target), 0, data.size(), data.data());
  barrier();
}

void Recording::fill(const device::Memory& target, std::uint64_t, std::uint32_t value) {
  vkCmdFillBuffer(parts_->commands, handle_of(target), 0, VK_WHOLE_SIZE, value);
  barrier();
}

void Recording::bind(VkPipelineBindPoint point, const device::Pipeline& pass, const void* push) {
  const auto& pipeline = static_cast<const Pipeline&>(pass);
  vkCmdBindPipeline(parts_->commands, point, pipeline.pipeline.get());
  vkCmdPushConstants(parts_->commands, pipeline.layout.get(), pipeline.stages, 0, pipeline.push_size, push);
}

void Recording::dispatch(const device::Pipeline& pass, const void* push, std::uint32_t groups) {
  bind(VK_PIPELINE_BIND_POINT_COMPUTE, pass, push);
  vkCmdDispatch(parts_->commands, groups, 1, 1);
  barrier();
}

void Recording::dispatch_indirect(const device::Pipeline& pass, const void* push, const device::Memory& arguments,
                                  std::uint64_t offset) {
  bind(VK_PIPELINE_BIND_POINT_COMPUTE, pass, push);
  vkCmdDispatchIndirect(parts_->commands, handle_of(arguments), offset);
  barrier();
}

void Recording::begin_rendering(const device::DrawImages& target, float farthest_depth) {
  std::vector<VkRenderingAttachmentInfo> colours;
  for (const device::ImageMemory* memory : target.colours) {
    const auto& image = static_cast<const ImageMemory&>(*memory);
    transition(image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    colours.push_back(attachment(image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, {}));
  }
  const auto& farthest_image = static_cast<const ImageMemory&>(*target.depth);
  transition(farthest_image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
  VkClearValue farthest{};
  farthest.depthStencil.depth = farthest_depth;
  const auto depth = attachment(farthest_image, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, farthest);
  VkRenderingInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
  info.renderArea.extent = {target.width, target.height};
  info.layerCount = 1;
  info.colorAttachmentCount = static_cast<std::uint32_t>(colours.size());
  info.pColorAttachments = colours.data();
  info.pDepthAttachment = &depth;
  vkCmdBeginRendering(parts_->commands, &info);
}

// A negative height turns y up (VK_KHR_maintenance1).
void Recording::set_viewport(const device::DrawImages& target, const device::Viewport& viewport) {
  const VkViewport turned{viewport.x, viewport.y + viewport.height, viewport.width, -viewport.height, 0.0f, 1.0f};
  const VkRect2D scissor{{0, 0}, {target.width, target.height}};
  vkCmdSetViewport(parts_->commands, 0, 1, &turned);
  vkCmdSetScissor(parts_->commands, 0, 1, &scissor);
}

void Recording::draw(const device::DrawImages& target, const device::Viewport& viewport, const device::Pipeline& pass,
                     const void* push, const device::Memory* indices, std::uint32_t vertices) {
  begin_rendering(target, static_cast<const Pipeline&>(pass).farthest);
  set_viewport(target, viewport);
  bind(VK_PIPELINE_BIND_POINT_GRAPHICS, pass, push);
  if (indices == nullptr) {
    vkCmdDraw(parts_->commands, vertices, 1, 0, 0);
  } else {
    vkCmdBindIndexBuffer(parts_->commands, handle_of(*indices), 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(parts_->commands, vertices, 1, 0, 0, 0);
  }
  vkCmdEndRendering(parts_->commands);
  for (const device::ImageMemory* image : target.colours) {
    transition(static_cast<const ImageMemory&>(*image), VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
               VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  }
  transition(static_cast<const ImageMemory&>(*target.depth), VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
             VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
}

void Recording::begin_pass(const std::string& name) {
  assert(passes_.size() < max_passes_);
  passes_.push_back({name, 0});
  if (host_timed_) {
    flush();
    pass_start_ = std::chrono::steady_clock::now();
  } else {
    if (!stamped_) stamp();
    stamps_.push_back({queries_ - 1, 0});
  }
}

// A stamp waits for all before it and costs a device some microseconds: a pass begins with that by which the one before
// has ended.
void Recording::stamp() {
  vkCmdWriteTimestamp2(parts_->commands, all_stages, parts_->queries.get(), queries_++);
  stamped_ = true;
}

void Recording::end_pass() {
  if (host_timed_) {
    flush();
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - pass_start_;
    passes_.back().time_ms = elapsed.count();
  } else {
    if (!stamped_) stamp();
    stamps_.back().end = queries_ - 1;
  }
}

// Runs what was recorded, if anything was, and records anew.
void Recording::flush() {
  if (!unfinished_) return;
  unfinished_ = false;
  end_and_run(nullptr);
  check(vkResetCommandPool(context_.device(), parts_->pool.get(), 0), "vkResetCommandPool");
  begin();
}

VkCommandBufferSubmitInfo Recording::finished() {
  check(vkEndCommandBuffer(parts_->commands), "vkEndCommandBuffer");
  VkCommandBufferSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
  info.commandBuffer = parts_->commands;
  return info;
}

// A thread that sleeps wakes some .1 ms late, which a frame would wait for at each of its submissions: for a while the
// device is asked instead.
void Recording::ask_for(VkFence fence) const {
  constexpr std::chrono::milliseconds a_while(2);
  const auto end = std::chrono::steady_clock::now() + a_while;
  while (vkGetFenceStatus(context_.device(), fence) == VK_NOT_READY && std::chrono::steady_clock::now() < end) {
  }
}

// Whether what the fence stands for has ended, after waiting for it at most so many nanoseconds.
bool Recording::ended(VkFence fence, std::uint64_t patience_ns) const {
  const VkResult result = vkWaitForFences(context_.device(), 1, &fence, VK_TRUE, patience_ns);
  if (result == VK_TIMEOUT) return false;
  check(result, "vkWaitForFences");
  return true;
}

// Updates that wait come first.
void Recording::end_and_run(const std::function<void()>& meanwhile) {
  show_to(VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
  const std::unique_ptr<device::Recording> updates = context_.take_updates();
  std::array<VkCommandBufferSubmitInfo, 2> infos{};
  std::uint32_t count = 0;
  if (updates) infos[count++] = static_cast<Recording&>(*updates).finished();
  infos[count++] = finished();
  VkSubmitInfo2 submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
  submit.commandBufferInfoCount = count;
  submit.pCommandBufferInfos = infos.data();
  const VkFence fence = parts_->fence.get();
  check(vkQueueSubmit2(context_.queue(), 1, &submit, fence), "vkQueueSubmit2");
  std::exception_ptr thrown;
  try {
    if (meanwhile) meanwhile();
    if (!host_timed_) ask_for(fence);
    // Software takes seconds for a pass, and compiles it before. A GPU, which also presents, is not looked at
    // meanwhile.
    context_.heed_until([&] { return ended(fence, host_timed_ ? slice_ns : UINT64_MAX); });
  } catch (...) {
    thrown = std::current_exception();
    ended(fence, UINT64_MAX);
  }
  check(vkResetFences(context_.device(), 1, &fence), "vkResetFences");
  if (thrown) std::rethrow_exception(thrown);
  context_.heed();
}

std::vector<device::PassTime> Recording::submit_and_wait(const std::function<void()>& meanwhile) {
  end_and_run(meanwhile);
  return read_times();
}

std::vector<device::PassTime> Recording::read_times() {
  if (passes_.empty() || host_timed_) return passes_;
  std::vector<std::uint64_t> ticks(queries_);
  check(vkGetQueryPoolResults(context_.device(), parts_->queries.get(), 0, static_cast<std::uint32_t>(ticks.size()),
                              ticks.size() * sizeof(std::uint64_t), ticks.data(), sizeof(std::uint64_t),
                              VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
  for (std::size_t i = 0; i < passes_.size(); ++i) {
    const double elapsed = static_cast<double>(ticks[stamps_[i].end] - ticks[stamps_[i].begin]);
    passes_[i].time_ms = elapsed * context_.limits().timestampPeriod * 1e-6;
  }
  return passes_;
}

std::unique_ptr<device::Recording> Context::record(std::uint32_t max_passes) {
  return std::make_unique<Recording>(*this, max_passes);
}

}  // namespace quadgraph::vk
