#include "engine/base/regular_file.h"

#include <string>
#include <system_error>

#include "engine/base/error.h"

namespace quadgraph {

std::uintmax_t bytes_of_regular_file(const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(path.string() + ": cannot be read (" + why + ")");
  };
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  if (error) refuse(error.message());
  if (!regular) refuse("no regular file");
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) refuse(error.message());
  return bytes;
}

}  // namespace quadgraph
