// libFuzzer on the reader of scenes. What it accepts must also be usable: any frame of it, written and read again.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "engine/scene/scene_file.h"

namespace {

constexpr std::size_t longest_message = 480;

// What is said of a scene that is refused is neither empty nor long.
void check_message(const quadgraph::InputError& error) {
  const std::string text = error.what();
  if (text.empty() || text.size() >= longest_message) std::abort();
}

void use(const quadgraph::SceneFile& file) {
  for (double frame : {0.0, 0.5, file.frames() - 1.0}) {
    try {
      quadgraph::SceneFile(file.at(frame)).at(0);
    } catch (const quadgraph::InputError& error) {  // values between two keys may be wrong together
      if (frame == 0) std::abort();
      check_message(error);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    use(quadgraph::SceneFile::parse(std::string(reinterpret_cast<const char*>(data), size)));
  } catch (const quadgraph::InputError& error) {
    check_message(error);
  }
  return 0;
}
