#include "engine/app/interface.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/vk/commands.h"

namespace quadgraph {
namespace {

// Where Debian (fonts-dejavu-core) and others keep it; without it letters are those that Dear ImGui brings along.
constexpr const char* fonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                 "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                                 "/usr/share/fonts/TTF/DejaVuSans.ttf"};
constexpr float letter_height = 14;  // pixels of an ordinary display

void check_result(VkResult result) {
  vk::check(result, "Dear ImGui");
}

void set_colours() {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.WindowBorderSize = 0;
  style.GrabMinSize = 6;  // values are read beside it
  style.FrameRounding = style.GrabRounding = style.PopupRounding = 3;
  style.ItemSpacing = {8, 5};
  style.WindowPadding = {12, 10};
  const auto colour = [&](ImGuiCol which, float r, float g, float b, float a = 1) {
    style.Colors[which] = {r, g, b, a};
  };
  colour(ImGuiCol_WindowBg, 0.105f, 0.11f, 0.12f);
  colour(ImGuiCol_PopupBg, 0.13f, 0.135f, 0.15f, 0.98f);
  colour(ImGuiCol_FrameBg, 0.18f, 0.19f, 0.21f);
  colour(ImGuiCol_FrameBgHovered, 0.25f, 0.26f, 0.29f);
  colour(ImGuiCol_FrameBgActive, 0.29f, 0.30f, 0.34f);
  colour(ImGuiCol_Header, 0.17f, 0.18f, 0.20f);
  colour(ImGuiCol_HeaderHovered, 0.24f, 0.25f, 0.28f);
  colour(ImGuiCol_HeaderActive, 0.28f, 0.29f, 0.33f);
  colour(ImGuiCol_Button, 0.22f, 0.23f, 0.26f);
  colour(ImGuiCol_ButtonHovered, 0.31f, 0.32f, 0.36f);
  colour(ImGuiCol_ButtonActive, 0.80f, 0.52f, 0.24f);
  colour(ImGuiCol_SliderGrab, 0.80f, 0.52f, 0.24f, 0.75f);
  colour(ImGuiCol_SliderGrabActive, 0.95f, 0.65f, 0.32f);
  colour(ImGuiCol_CheckMark, 0.95f, 0.65f, 0.32f);
  colour(ImGuiCol_PlotHistogram, 0.80f, 0.52f, 0.24f);
  colour(ImGuiCol_NavHighlight, 0.95f, 0.65f, 0.32f);
  colour(ImGuiCol_Text, 0.90f, 0.90f, 0.89f);
  colour(ImGuiCol_TextDisabled, 0.58f, 0.59f, 0.60f);
}

}  // namespace

Interface::Interface(Window& window, vk::Context& context, const vk::Swapchain& swapchain)
    : window_(window), context_(context), swapchain_(swapchain) {
  create_pool();
  create_pass(swapchain.format());
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  set_colours();
  load_fonts(window.scale());
  start_backend();
}

Interface::~Interface() {
  vkDeviceWaitIdle(context_.device());
  ImGui_ImplVulkan_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

// Letters have their final size in pixels, whatever window coordinates are.
void Interface::load_fonts(float scale) {
  const float ratio = window_.pixels_per_unit();
  ImGuiIO& io = ImGui::GetIO();
  const char* found = nullptr;
  for (const char* name : fonts) {
    if (found == nullptr && std::filesystem::exists(name)) found = name;
  }
  static constexpr ImWchar letters[] = {0x20, 0xff, 0x370, 0x3ff, 0x2010, 0x2027, 0x2070, 0x209f, 0x2190, 0x2193, 0};
  if (found != nullptr) {
    io.Fonts->AddFontFromFileTTF(found, letter_height * scale, nullptr, letters);
  } else {
    ImFontConfig config;
    config.SizePixels = 13 * scale;
    io.Fonts->AddFontDefault(&config);
  }
  io.FontGlobalScale = 1 / ratio;
  unit_ = scale / ratio;
  ImGui::GetStyle().ScaleAllSizes(unit_);
}

void Interface::create_pool() {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1};
  VkDescriptorPoolCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  info.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  info.maxSets = 1;
  info.poolSizeCount = 1;
  info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  vk::check(vkCreateDescriptorPool(context_.device(), &info, nullptr, &pool), "vkCreateDescriptorPool");
  pool_ = vk::UniqueDescriptorPool(context_.device(), pool);
}

void Interface::create_pass(VkFormat format) {
  VkAttachmentDescription attachment{};
  attachment.format = format;
  attachment.samples = VK_SAMPLE_COUNT_1_BIT;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  attachment.initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  attachment.finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &colour;
  VkRenderPassCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
  info.attachmentCount = 1;
  info.pAttachments = &attachment;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  VkRenderPass pass = VK_NULL_HANDLE;
  vk::check(vkCreateRenderPass(context_.device(), &info, nullptr, &pass), "vkCreateRenderPass");
  pass_ = vk::UniqueRenderPass(context_.device(), pass);
}

void Interface::start_backend() {
  ImGui_ImplGlfw_InitForVulkan(window_.handle(), false);
  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = context_.instance();
  info.PhysicalDevice = context_.physical_device();
  info.Device = context_.device();
  info.QueueFamily = context_.queue_family();
  info.Queue = context_.queue();
  info.DescriptorPool = pool_.get();
  // Only the number of its vertex buffers, and one frame runs at a time.
  info.MinImageCount = info.ImageCount = 2;
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  info.CheckVkResultFn = check_result;
  ImGui_ImplVulkan_Init(&info, pass_.get());
  vk::Recording commands(context_, 0);
  ImGui_ImplVulkan_CreateFontsTexture(commands.handle());
  commands.submit_and_wait(nullptr);
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void Interface::begin(const std::vector<Event>& events) {
  GLFWwindow* window = window_.handle();
  const float ratio = window_.pixels_per_unit();
  for (const Event& event : events) {
    if (const auto* key = std::get_if<KeyEvent>(&event)) {
      ImGui_ImplGlfw_KeyCallback(window, key->key, key->scancode, key->action, key->mods);
    } else if (const auto* text = std::get_if<TextEvent>(&event)) {
      ImGui_ImplGlfw_CharCallback(window, text->character);
    } else if (const auto* button = std::get_if<ButtonEvent>(&event); button != nullptr && button->button < buttons) {
      down_[static_cast<std::size_t>(button->button)] = button->action == GLFW_PRESS;
    } else if (const auto* motion = std::get_if<MotionEvent>(&event)) {
      pointer_ = glm::vec2(motion->x, motion->y) / ratio;
    } else if (const auto* scroll = std::get_if<ScrollEvent>(&event)) {
      ImGui_ImplGlfw_ScrollCallback(window, scroll->x, scroll->y);
    }
  }
  ImGui_ImplVulkan_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  point();
  ImGui::NewFrame();
}

// The pointer as it was when what the frame sees happened, where the backend has it as it is now.
void Interface::point() const {
  ImGuiIO& io = ImGui::GetIO();
  std::copy(down_.begin(), down_.end(), io.MouseDown);
  if (window_.events_wait()) io.MousePos = {pointer_.x, pointer_.y};
}

bool Interface::has_pointer() const {
  return ImGui::GetIO().WantCaptureMouse;
}

bool Interface::has_keys() const {
  return ImGui::GetIO().NavActive;
}

bool Interface::has_text() const {
  const ImGuiContext& context = *ImGui::GetCurrentContext();
  const bool typing =
      context.ActiveId != 0 && context.ActiveId == context.InputTextState.ID;  // WantTextInput is a frame late
  return typing || ImGui::GetIO().WantTextInput;
}

bool Interface::moves() const {
  const ImGuiContext& context = *ImGui::GetCurrentContext();
  return context.ActiveId != 0 || context.NavWindowingTargetAnim != nullptr || context.DimBgRatio > 0;
}

void Interface::follow_swapchain() {
  if (generation_ == swapchain_.generation()) return;
  generation_ = swapchain_.generation();
  framebuffers_.clear();
  for (std::uint32_t i = 0; i < swapchain_.image_count(); ++i) {
    const VkImageView view = swapchain_.view(i);
    VkFramebufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
    info.renderPass = pass_.get();
    info.attachmentCount = 1;
    info.pAttachments = &view;
    info.width = swapchain_.width();
    info.height = swapchain_.height();
    info.layers = 1;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    vk::check(vkCreateFramebuffer(context_.device(), &info, nullptr, &framebuffer), "vkCreateFramebuffer");
    framebuffers_.emplace_back(context_.device(), framebuffer);
  }
}

void Interface::draw(const vk::SwapchainFrame& frame) {
  follow_swapchain();
  VkRenderPassBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
  info.renderPass = pass_.get();
  info.framebuffer = framebuffers_[frame.number].get();
  info.renderArea.extent = {swapchain_.width(), swapchain_.height()};
  vkCmdBeginRenderPass(frame.commands, &info, VK_SUBPASS_CONTENTS_INLINE);
  ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), frame.commands);
  vkCmdEndRenderPass(frame.commands);
}

}  // namespace quadgraph
