#include "engine/base/regular_file.h"

#include <fstream>
#include <sstream>
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

std::string text_of_regular_file(const std::filesystem::path& path, std::uintmax_t allowed, const std::string& what) {
  if (bytes_of_regular_file(path) > allowed) {
    throw InputError(path.string() + ": larger than the " + std::to_string(allowed) + " bytes that are allowed of " +
                     what);
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw InputError(path.string() + ": cannot be read");
  return text.str();
}

}  // namespace quadgraph
