// Drawing triangles on the processor by the rules of Vulkan: samples at the centres of pixels, the top-left rule, clip
// space with depth 0 to 1, interpolation in perspective, triangles in their order.
#pragma once

#include <cstdint>

#include "engine/cpu/objects.h"
#include "engine/cpu/processor.h"
#include "engine/device/device.h"

namespace quadgraph::cpu {

// Draws as device::Recording::draw asks. The same picture with any number of threads.
void rasterise(Processor& processor, const device::DrawImages& target, const device::Viewport& viewport,
               const GraphicsPipeline& pass, const void* push, const std::uint32_t* indices, std::uint32_t vertices);

}  // namespace quadgraph::cpu
