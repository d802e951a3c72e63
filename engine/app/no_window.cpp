#include "engine/app/show_window.h"
#include "engine/base/error.h"

namespace quadgraph {

int show_window(const AppOptions&) {
  throw InputError(
      "this build has no window, as it has no Vulkan (tools/setup --vulkan builds it with): use --headless -o "
      "PICTURE.png to render without a window");
}

}  // namespace quadgraph
