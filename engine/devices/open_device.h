// The choice between devices.
#pragma once

#include <memory>
#include <string>

#include "engine/device/device.h"

namespace quadgraph {

// What the options name, or where they name none QUADGRAPH_DEVICE of the environment; empty: neither does.
std::string wanted_device(const device::DeviceOptions& options);

// Throws DeviceError naming what was found where there is no such device.
std::shared_ptr<device::Device> open_device(const device::DeviceOptions& options = {});

}  // namespace quadgraph
