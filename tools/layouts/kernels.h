// The kernels of shaders/layouts, as tools/layouts/CMakeLists.txt lists them.
#pragma once

#include <string>

#include "engine/graph/solution.h"
#include "engine/vk/pipeline.h"

namespace quadgraph::layouts {

vk::Spirv kernel_code(const std::string& name, Model model);

}  // namespace quadgraph::layouts
