#include "engine/devices/open_device.h"

#include <cstdlib>

#include "engine/base/error.h"
#include "engine/cpu/processor.h"
#include "engine/devices/vulkan.h"

namespace quadgraph {
namespace {

// Null where Vulkan has none; then it is not looked for again in this process.
std::shared_ptr<device::Device> open_gpu(const device::DeviceOptions& options) {
  static bool none = false;
  if (none) return nullptr;
  try {
    auto found = open_vulkan(options);
    if (!found->info().cpu) return found;
  } catch (const DeviceError&) {
  }
  none = true;
  return nullptr;
}

std::shared_ptr<device::Device> choose(const device::DeviceOptions& given) {
  device::DeviceOptions options = given;
  options.device = wanted_device(given);
  if (options.device.empty()) {
    if (auto gpu = open_gpu(options)) return gpu;
    options.device = device::processor;
  }
  if (options.device == device::processor) return std::make_shared<cpu::Processor>();
  return open_vulkan(options);
}

}  // namespace

std::string wanted_device(const device::DeviceOptions& options) {
  const char* usual = std::getenv("QUADGRAPH_DEVICE");
  return options.device.empty() && usual != nullptr ? usual : options.device;
}

std::shared_ptr<device::Device> open_device(const device::DeviceOptions& options) {
  auto device = choose(options);
  device->set_check(options.check, options.pause);
  return device;
}

}  // namespace quadgraph
