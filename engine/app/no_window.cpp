#include "engine/app/show_window.h"
#include "engine/base/error.h"

namespace quadgraph {

int show_window(const AppOptions&) {
  throw InputError(
      "a window needs Vulkan, and this build has none (tools/setup --vulkan adds it): use --headless -o PICTURE.png to "
      "render without a window");
}

}  // namespace quadgraph
