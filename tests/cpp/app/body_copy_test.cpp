#include "engine/app/body_copy.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <string>

#include "engine/base/error.h"

using namespace quadgraph;
namespace fs = std::filesystem;

namespace {

// An empty folder, gone at the end.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("quadgraph-copies-" + std::to_string(getpid()));

  Folder() { fs::create_directories(path / "cache"); }
  ~Folder() { fs::remove_all(path); }

  fs::path write(const fs::path& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return path / name;
  }
};

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

TEST_CASE("a body is copied once, and beside another of its name under a number") {
  const Folder folder;
  const fs::path body = folder.write("cache/ball.qgraph", "a body");
  const fs::path first = copied_into(folder.path, body);
  CHECK(first == folder.path / "ball.qgraph");
  CHECK(text_of(first) == "a body");
  CHECK(copied_into(folder.path, body) == first);
  folder.write("cache/ball.qgraph", "b body");  // as long
  const fs::path second = copied_into(folder.path, body);
  CHECK(second == folder.path / "ball-1.qgraph");
  CHECK(text_of(second) == "b body");
  CHECK(text_of(first) == "a body");
  CHECK(copied_into(folder.path, body) == second);
  CHECK(copied_into(folder.path / "cache", body) == body);
}

TEST_CASE("a body that is gone is named") {
  const Folder folder;
  const fs::path gone = folder.path / "cache" / "gone.qgraph";
  CHECK_THROWS_WITH_AS(copied_into(folder.path, gone), doctest::Contains("gone.qgraph: is gone"), InputError);
  CHECK_FALSE(fs::exists(folder.path / "gone.qgraph"));
}
