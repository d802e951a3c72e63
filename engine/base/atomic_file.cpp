#include "engine/base/atomic_file.h"

#include <unistd.h>

#include <exception>
#include <string>

#include "engine/base/error.h"

namespace quadgraph {

void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write) {
  std::filesystem::path temporary = path;
  temporary += ".part" + std::to_string(getpid());
  try {
    write(temporary);
    std::filesystem::rename(temporary, path);
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw InputError(path.string() + ": cannot be written: " + error.what());
  }
}

}  // namespace quadgraph
