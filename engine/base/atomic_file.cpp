#include "engine/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <random>
#include <string>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr int most_trials = 100;  // of names that others hold

// An empty file of a name that nobody can foresee, beside `path`; it is nobody else's and no link.
std::filesystem::path new_file(const std::filesystem::path& path) {
  std::random_device random;
  for (int trial = 0; trial < most_trials; ++trial) {
    const std::string name = "." + path.filename().string().substr(0, 200) + "." + std::to_string(random()) + ".part";
    const std::filesystem::path temporary = path.parent_path() / name;
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0) {
      ::close(file);
      return temporary;
    }
    if (errno != EEXIST) break;
  }
  throw InputError(path.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace

void check_replaceable(const std::filesystem::path& path) {
  std::error_code error;
  const auto kind = std::filesystem::symlink_status(path, error).type();
  if (kind == std::filesystem::file_type::regular || kind == std::filesystem::file_type::not_found) return;
  if (kind == std::filesystem::file_type::none) {
    throw InputError(path.string() + ": cannot be written (" + error.message() + "); give another name");
  }
  const char* what = kind == std::filesystem::file_type::symlink     ? "a link"
                     : kind == std::filesystem::file_type::directory ? "a folder"
                                                                     : "no regular file";
  throw InputError(path.string() + ": is " + what + ", allowed is a regular file or a new name");
}

void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write) {
  check_replaceable(path);
  const std::filesystem::path temporary = new_file(path);
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
