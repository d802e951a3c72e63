#include "engine/vk/commands.h"

#include <algorithm>
#include <cassert>

#include "engine/base/error.h"
#include "engine/vk/arena.h"

namespace quadgraph::vk {
namespace {

constexpr VkPipelineStageFlags2 all_stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr VkAccessFlags2 all_access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;

}  // namespace

Commands::Commands(Context& context, std::uint32_t max_passes)
    : context_(context), max_passes_(max_passes), host_timed_(context.info().type == VK_PHYSICAL_DEVICE_TYPE_CPU) {
  VkCommandPoolCreateInfo pool_info{};
  pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool_info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool_info.queueFamilyIndex = context.queue_family();
  VkCommandPool pool = VK_NULL_HANDLE;
  check(vkCreateCommandPool(context.device(), &pool_info, nullptr, &pool), "vkCreateCommandPool");
  pool_ = UniqueCommandPool(context.device(), pool);

  VkCommandBufferAllocateInfo buffer_info{};
  buffer_info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  buffer_info.commandPool = pool;
  buffer_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  buffer_info.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(context.device(), &buffer_info, &commands_), "vkAllocateCommandBuffers");

  if (max_passes > 0 && !host_timed_) {
    VkQueryPoolCreateInfo query_info{};
    query_info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    query_info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    query_info.queryCount = 2 * max_passes;
    VkQueryPool queries = VK_NULL_HANDLE;
    check(vkCreateQueryPool(context.device(), &query_info, nullptr, &queries), "vkCreateQueryPool");
    queries_ = UniqueQueryPool(context.device(), queries);
    vkResetQueryPool(context.device(), queries, 0, 2 * max_passes);
  }

  begin();
}

void Commands::begin() {
  VkCommandBufferBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands_, &info), "vkBeginCommandBuffer");
}

void Commands::barrier() {
  VkMemoryBarrier2 memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
  memory.srcStageMask = all_stages;
  memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  memory.dstStageMask = all_stages;
  memory.dstAccessMask = all_access;
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands_, &info);
  unfinished_ = true;
}

void Commands::transition(const Image& image, VkImageLayout from, VkImageLayout to) {
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
  barrier.image = image.handle();
  barrier.subresourceRange = {image.aspect(), 0, 1, 0, image.options().layers};
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands_, &info);
  unfinished_ = true;
}

void Commands::copy(const Buffer& source, const Buffer& target, std::uint64_t bytes, std::uint64_t target_offset) {
  const VkBufferCopy region{0, target_offset, bytes};
  vkCmdCopyBuffer(commands_, source.handle(), target.handle(), 1, &region);
  barrier();
}

void Commands::copy(const Image& source, const Buffer& target, std::uint32_t width, std::uint32_t height) {
  const ImageOptions& options = source.options();
  VkBufferImageCopy region{};
  region.imageSubresource = {source.aspect(), 0, 0, options.layers};
  region.imageExtent = {width > 0 ? width : options.width, height > 0 ? height : options.height, 1};
  vkCmdCopyImageToBuffer(commands_, source.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.handle(), 1, &region);
  barrier();
}

void Commands::update(const Buffer& target, std::span<const std::byte> data) {
  vkCmdUpdateBuffer(commands_, target.handle(), 0, data.size(), data.data());
  barrier();
}

void Commands::fill(const Buffer& target, std::uint32_t value) {
  vkCmdFillBuffer(commands_, target.handle(), 0, VK_WHOLE_SIZE, value);
  barrier();
}

void Commands::bind(const ComputePass& pass, const void* push, std::uint32_t size) {
  assert(size == pass.push_size());
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pass.pipeline());
  vkCmdPushConstants(commands_, pass.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, size, push);
  const VkDescriptorSet texels = context_.arenas().set();
  vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pass.layout(), 0, 1, &texels, 0, nullptr);
}

void Commands::dispatch_bytes(const ComputePass& pass, const void* push, std::uint32_t size, std::uint64_t elements) {
  if (elements == 0) return;
  const std::uint64_t groups = pass.workgroups(elements);
  if (groups > context_.limits().maxComputeWorkGroupCount[0]) {
    throw VulkanError(pass.name() + " needs " + std::to_string(groups) + " workgroups, " + context_.info().name +
                      " allows " + std::to_string(context_.limits().maxComputeWorkGroupCount[0]));
  }
  bind(pass, push, size);
  vkCmdDispatch(commands_, static_cast<std::uint32_t>(groups), 1, 1);
  barrier();
}

void Commands::dispatch_indirect_bytes(const ComputePass& pass, const void* push, std::uint32_t size,
                                       const Buffer& arguments, std::uint64_t offset) {
  bind(pass, push, size);
  vkCmdDispatchIndirect(commands_, arguments.handle(), offset);
  barrier();
}

void Commands::begin_pass(const std::string& name) {
  assert(passes_.size() < max_passes_);
  const auto query = static_cast<std::uint32_t>(2 * passes_.size());
  passes_.push_back({name, 0});
  if (host_timed_) {
    flush();
    pass_start_ = std::chrono::steady_clock::now();
  } else {
    vkCmdWriteTimestamp2(commands_, all_stages, queries_.get(), query);
  }
}

void Commands::end_pass() {
  if (host_timed_) {
    flush();
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - pass_start_;
    passes_.back().time_ms = elapsed.count();
  } else {
    const auto query = static_cast<std::uint32_t>(2 * passes_.size() - 1);
    vkCmdWriteTimestamp2(commands_, all_stages, queries_.get(), query);
  }
}

// Runs what was recorded, if anything was, and records anew.
void Commands::flush() {
  if (!unfinished_) return;
  unfinished_ = false;
  end_and_run();
  check(vkResetCommandPool(context_.device(), pool_.get(), 0), "vkResetCommandPool");
  begin();
}

void Commands::end_and_run() {
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  VkFenceCreateInfo fence_info{};
  fence_info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  VkFence fence = VK_NULL_HANDLE;
  check(vkCreateFence(context_.device(), &fence_info, nullptr, &fence), "vkCreateFence");
  const UniqueFence owned_fence(context_.device(), fence);

  VkCommandBufferSubmitInfo command_info{};
  command_info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
  command_info.commandBuffer = commands_;
  VkSubmitInfo2 submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &command_info;
  check(vkQueueSubmit2(context_.queue(), 1, &submit, fence), "vkQueueSubmit2");
  check(vkWaitForFences(context_.device(), 1, &fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
}

std::vector<PassTime> Commands::submit_and_wait() {
  end_and_run();
  return read_times();
}

std::vector<PassTime> Commands::read_times() {
  if (passes_.empty() || host_timed_) return passes_;
  std::vector<std::uint64_t> ticks(2 * passes_.size());
  check(vkGetQueryPoolResults(context_.device(), queries_.get(), 0, static_cast<std::uint32_t>(ticks.size()),
                              ticks.size() * sizeof(std::uint64_t), ticks.data(), sizeof(std::uint64_t),
                              VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
  for (std::size_t i = 0; i < passes_.size(); ++i) {
    const double elapsed = static_cast<double>(ticks[2 * i + 1] - ticks[2 * i]);
    passes_[i].time_ms = elapsed * context_.limits().timestampPeriod * 1e-6;
  }
  return passes_;
}

}  // namespace quadgraph::vk
