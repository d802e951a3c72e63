#include "tools/layouts/kernels.h"

#include <map>

#include "layouts/kernels.h"

namespace quadgraph::layouts {

device::Spirv kernel_code(const std::string& name, Model model) {
  struct Code {
    device::Spirv diffusion, sp3;
  };
#define LAYOUT_KERNEL(name) {#name, {layout_##name##_1, layout_##name##_2}},
  static const std::map<std::string, Code> codes = {
#include "layouts/kernels.inc"
  };
#undef LAYOUT_KERNEL
  const Code& code = codes.at(name);
  return model == Model::sp3 ? code.sp3 : code.diffusion;
}

}  // namespace quadgraph::layouts
