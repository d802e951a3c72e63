// What has been read of files, so that it is read once.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <system_error>

#include "engine/base/error.h"

namespace quadgraph {

// The last `kept` are kept while nobody else holds them: frame after frame asks for them again.
template <typename T>
class FileCache {
 public:
  explicit FileCache(std::size_t kept) : kept_(kept) {}

  // `read(path)`, or what it gave before if the file is still the same. Throws InputError if it is not there, and what
  // `read` throws.
  template <typename Read>
  std::shared_ptr<const T> load(const std::filesystem::path& path, const Read& read) {
    std::error_code missing;
    const auto written = std::filesystem::last_write_time(path, missing);
    if (missing) throw InputError(path.string() + ": cannot be read (" + missing.message() + ")");
    const std::lock_guard lock(mutex_);
    Known& entry = known_[std::filesystem::absolute(path)];
    if (entry.written == written) {
      if (auto content = entry.content.lock()) return content;
    }
    std::shared_ptr<const T> content = read(path);
    entry = {written, content};
    last_.push_back(content);
    if (last_.size() > kept_) last_.pop_front();
    return content;
  }

 private:
  struct Known {
    std::filesystem::file_time_type written;
    std::weak_ptr<const T> content;
  };

  std::size_t kept_;
  std::mutex mutex_;
  std::map<std::filesystem::path, Known> known_;
  std::deque<std::shared_ptr<const T>> last_;
};

}  // namespace quadgraph
