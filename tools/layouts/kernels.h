// The kernels of tools/layouts/shaders, as tools/layouts/CMakeLists.txt lists them.
#pragma once

#include <string>

#include "engine/base/solve_options.h"
#include "engine/vk/pipeline.h"

namespace quadgraph::layouts {

vk::Spirv kernel_code(const std::string& name, Model model);

}  // namespace quadgraph::layouts
