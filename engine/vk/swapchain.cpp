#include "engine/vk/swapchain.h"

#include <algorithm>

#include "engine/base/error.h"

namespace quadgraph::vk {
namespace {

constexpr VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;

UniqueFence signalled_fence(Context& context) {
  VkFenceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  info.flags = VK_FENCE_CREATE_SIGNALED_BIT;
  VkFence fence = VK_NULL_HANDLE;
  check(vkCreateFence(context.device(), &info, nullptr, &fence), "vkCreateFence");
  return {context.device(), fence};
}

VkSurfaceCapabilitiesKHR capabilities_of(Context& context) {
  VkSurfaceCapabilitiesKHR capabilities{};
  check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(context.physical_device(), context.surface(), &capabilities),
        "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  return capabilities;
}

// A surface that has no size of its own takes any within its bounds.
VkExtent2D extent_of(const VkSurfaceCapabilitiesKHR& capabilities, std::uint32_t width, std::uint32_t height) {
  if (capabilities.currentExtent.width != UINT32_MAX) return capabilities.currentExtent;
  return {std::clamp(width, capabilities.minImageExtent.width, capabilities.maxImageExtent.width),
          std::clamp(height, capabilities.minImageExtent.height, capabilities.maxImageExtent.height)};
}

VkSwapchainCreateInfoKHR create_info(const VkSurfaceCapabilitiesKHR& capabilities) {
  VkSwapchainCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR;
  info.minImageCount = std::max(capabilities.minImageCount, 2u);
  if (capabilities.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, capabilities.maxImageCount);
  info.imageArrayLayers = 1;
  info.imageUsage = usage;
  info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
  info.preTransform = capabilities.currentTransform;
  const bool opaque = (capabilities.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0;
  info.compositeAlpha = opaque ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  info.clipped = VK_TRUE;
  return info;
}

// Whether frames can go on, on new images.
bool outdated(VkResult result, std::string_view call) {
  if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) return true;
  check(result, call);
  return false;
}

}  // namespace

Swapchain::Swapchain(Context& context, std::uint32_t width, std::uint32_t height)
    : context_(context), wanted_width_(width), wanted_height_(height), fence_(signalled_fence(context)) {
  if ((capabilities_of(context_).supportedUsageFlags & usage) != usage) {
    throw DeviceError(context.info().name + " cannot copy pixels into this window");
  }
  choose_format();
  create_commands();
}

Swapchain::~Swapchain() {
  vkDeviceWaitIdle(context_.device());
}

void Swapchain::choose_format() {
  std::uint32_t count = 0;
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(context_.physical_device(), context_.surface(), &count, nullptr),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(context_.physical_device(), context_.surface(), &count, formats.data()),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  for (const VkFormat wanted : {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_UNORM}) {
    const auto found = std::find_if(formats.begin(), formats.end(), [&](const auto& f) { return f.format == wanted; });
    if (found == formats.end()) continue;
    format_ = *found;
    return;
  }
  throw DeviceError("this window has no format of 8 bits per channel, R8G8B8A8 or B8G8R8A8");
}

void Swapchain::create_commands() {
  VkCommandPoolCreateInfo pool_info{};
  pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool_info.queueFamilyIndex = context_.queue_family();
  VkCommandPool pool = VK_NULL_HANDLE;
  check(vkCreateCommandPool(context_.device(), &pool_info, nullptr, &pool), "vkCreateCommandPool");
  pool_ = UniqueCommandPool(context_.device(), pool);
  VkCommandBufferAllocateInfo buffer_info{};
  buffer_info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  buffer_info.commandPool = pool;
  buffer_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  buffer_info.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(context_.device(), &buffer_info, &commands_), "vkAllocateCommandBuffers");
}

UniqueSemaphore Swapchain::semaphore() {
  VkSemaphoreCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
  VkSemaphore semaphore = VK_NULL_HANDLE;
  check(vkCreateSemaphore(context_.device(), &info, nullptr, &semaphore), "vkCreateSemaphore");
  return {context_.device(), semaphore};
}

void Swapchain::resize(std::uint32_t width, std::uint32_t height) {
  if (width == wanted_width_ && height == wanted_height_) return;
  wanted_width_ = width;
  wanted_height_ = height;
  stale_ = true;
  create();
}

// In place of the images before, if there were any.
void Swapchain::create() {
  check(vkDeviceWaitIdle(context_.device()), "vkDeviceWaitIdle");
  const VkSurfaceCapabilitiesKHR capabilities = capabilities_of(context_);
  const VkExtent2D extent = extent_of(capabilities, wanted_width_, wanted_height_);
  width_ = height_ = 0;
  if (wanted_width_ == 0 || wanted_height_ == 0 || extent.width == 0 || extent.height == 0) return;
  VkSwapchainCreateInfoKHR info = create_info(capabilities);
  info.surface = context_.surface();
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = extent;
  info.oldSwapchain = swapchain_.get();
  VkSwapchainKHR swapchain = VK_NULL_HANDLE;
  check(vkCreateSwapchainKHR(context_.device(), &info, nullptr, &swapchain), "vkCreateSwapchainKHR");
  views_.clear();
  swapchain_ = UniqueSwapchain(context_.device(), swapchain);
  create_images();
  width_ = extent.width;
  height_ = extent.height;
  stale_ = false;
  ++generation_;
}

void Swapchain::create_images() {
  std::uint32_t count = 0;
  check(vkGetSwapchainImagesKHR(context_.device(), swapchain_.get(), &count, nullptr), "vkGetSwapchainImagesKHR");
  images_.resize(count);
  check(vkGetSwapchainImagesKHR(context_.device(), swapchain_.get(), &count, images_.data()),
        "vkGetSwapchainImagesKHR");
  drawn_.clear();
  for (VkImage image : images_) {
    VkImageViewCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    info.image = image;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = format_.format;
    info.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(context_.device(), &info, nullptr, &view), "vkCreateImageView of the swapchain");
    views_.emplace_back(context_.device(), view);
    drawn_.push_back(semaphore());
  }
  acquired_ = semaphore();
}

void Swapchain::wait() {
  const VkFence fence = fence_.get();
  check(vkWaitForFences(context_.device(), 1, &fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
}

std::optional<SwapchainFrame> Swapchain::begin() {
  wait();
  if (stale_) create();
  if (width_ == 0) return std::nullopt;
  std::uint32_t number = 0;
  const VkResult result =
      vkAcquireNextImageKHR(context_.device(), swapchain_.get(), UINT64_MAX, acquired_.get(), VK_NULL_HANDLE, &number);
  stale_ = outdated(result, "vkAcquireNextImageKHR");
  // A suboptimal image has been acquired and must be presented.
  if (result == VK_ERROR_OUT_OF_DATE_KHR) return std::nullopt;
  check(vkResetCommandPool(context_.device(), pool_.get(), 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands_, &info), "vkBeginCommandBuffer");
  transition(commands_, images_[number], VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  return SwapchainFrame{commands_, images_[number], views_[number].get(), number};
}

void Swapchain::submit(const SwapchainFrame& frame) {
  check(vkEndCommandBuffer(frame.commands), "vkEndCommandBuffer");
  VkSemaphoreSubmitInfo acquired{}, drawn{};
  acquired.sType = drawn.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO;
  acquired.semaphore = acquired_.get();
  drawn.semaphore = drawn_[frame.number].get();
  acquired.stageMask = drawn.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkCommandBufferSubmitInfo commands{};
  commands.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
  commands.commandBuffer = frame.commands;
  VkSubmitInfo2 info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
  info.waitSemaphoreInfoCount = 1;
  info.pWaitSemaphoreInfos = &acquired;
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &commands;
  info.signalSemaphoreInfoCount = 1;
  info.pSignalSemaphoreInfos = &drawn;
  const VkFence fence = fence_.get();
  check(vkResetFences(context_.device(), 1, &fence), "vkResetFences");
  check(vkQueueSubmit2(context_.queue(), 1, &info, fence), "vkQueueSubmit2");
}

void Swapchain::present(const SwapchainFrame& frame) {
  submit(frame);
  const VkSemaphore drawn = drawn_[frame.number].get();
  const VkSwapchainKHR swapchain = swapchain_.get();
  VkPresentInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR;
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &drawn;
  info.swapchainCount = 1;
  info.pSwapchains = &swapchain;
  info.pImageIndices = &frame.number;
  if (outdated(vkQueuePresentKHR(context_.queue(), &info), "vkQueuePresentKHR")) stale_ = true;
}

void transition(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

void copy_pixels(const SwapchainFrame& frame, const device::Buffer& pixels, std::uint32_t x, std::uint32_t y,
                 std::uint32_t width, std::uint32_t height) {
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageOffset = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), 0};
  region.imageExtent = {width, height, 1};
  vkCmdCopyBufferToImage(frame.commands, handle_of(pixels.memory()), frame.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                         1, &region);
}

}  // namespace quadgraph::vk
