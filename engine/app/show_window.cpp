#include "engine/app/show_window.h"

#include <cstdlib>

#include "engine/app/report.h"
#include "engine/app/viewer.h"
#include "engine/base/error.h"
#include "engine/devices/open_device.h"
#include "engine/scene/stage.h"
#include "engine/vk/loader.h"

namespace quadgraph {
namespace {

// What a window needs, whatever computes its pictures.
template <typename Step>
auto needed(Step step) {
  try {
    return step();
  } catch (const DeviceError& error) {
    throw InputError(std::string("a window needs Vulkan: ") + error.what() +
                     ": use --headless -o PICTURE.png to render without a window");
  }
}

// The Vulkan device that shows frames in a window; pictures may be made by another.
std::shared_ptr<vk::Context> presenter_of(const Window& window, device::DeviceOptions options) {
  options.surface = std::make_shared<vk::SurfaceSource>(window.surface());
  options.device = wanted_device(options);
  const bool named = !options.device.empty() && options.device != device::processor;
  if (named) return std::make_shared<vk::Context>(options);
  options.device.clear();
  return needed([&] { return std::make_shared<vk::Context>(options); });
}

// What makes the pictures. A driver on the processor takes seconds for a pass, and has one queue for each device:
// frames that are shown meanwhile go another way.
std::shared_ptr<device::Device> device_beside(const std::shared_ptr<vk::Context>& presenter,
                                              const device::DeviceOptions& options) {
  const std::string wanted = wanted_device(options);
  const bool on_processor = wanted.empty() ? presenter->info().cpu : wanted == device::processor;
  if (on_processor) return open_device({.device = device::processor});
  if (presenter->info().cpu) return open_device(options);
  return presenter;
}

}  // namespace

int show_window(const AppOptions& options) {
  needed(vk::require_loader);
  const std::filesystem::path name = options.scene.body.filename();
  Window window(name.string(), 1280, 800);
  const auto presenter = presenter_of(window, options.device);
  const auto device = device_beside(presenter, options.device);
  Stage stage(device);
  std::optional<Preview> preview;
  if (!options.preview.empty()) preview.emplace(options.preview, options.scene);
  stage.show(preview ? Preview::before(options.scene) : options.scene);
  {
    const std::filesystem::path stem = options.output.empty() ? name.stem() : options.output;
    Viewer(window, *presenter, stage, {stem, options.copy_body, options.file}, preview).run();
  }
  refuse_messages(*presenter);
  refuse_messages(*device);
  return EXIT_SUCCESS;
}

}  // namespace quadgraph
