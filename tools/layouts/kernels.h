// The kernels of tools/layouts/shaders, as tools/layouts/CMakeLists.txt lists them.
#pragma once

#include <string>

#include "engine/base/solve_options.h"
#include "engine/device/pipeline.h"

namespace quadgraph::layouts {

device::Spirv kernel_code(const std::string& name, Model model);

}  // namespace quadgraph::layouts
