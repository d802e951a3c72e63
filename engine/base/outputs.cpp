#include "engine/base/outputs.h"

#include <sys/stat.h>

#include <optional>
#include <utility>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"

namespace quadgraph {
namespace {

using FileNumber = std::pair<dev_t, ino_t>;

// The same for two names of one file, hard links among them; empty for a new name.
std::optional<FileNumber> number_of(const std::filesystem::path& path) {
  struct stat found{};
  if (::stat(path.c_str(), &found) != 0) return std::nullopt;
  return FileNumber{found.st_dev, found.st_ino};
}

}  // namespace

void check_not_read(const std::filesystem::path& output, std::span<const std::string> inputs) {
  check_replaceable(output);
  if (const auto folder = output.parent_path(); !folder.empty() && !std::filesystem::is_directory(folder)) {
    throw InputError(output.string() + ": the folder " + folder.string() +
                     " does not exist; make it, or give another name");
  }
  const auto written = number_of(output);
  if (!written) return;
  for (const std::string& input : inputs) {
    if (number_of(input) != written) continue;
    throw InputError(output.string() + ": is read (" + input + ") and would be replaced; give the output another name");
  }
}

}  // namespace quadgraph
