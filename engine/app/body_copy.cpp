#include "engine/app/body_copy.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"

namespace quadgraph {
namespace {

bool same_bytes(const std::filesystem::path& one, const std::filesystem::path& other) {
  if (!std::filesystem::is_regular_file(other)) return false;
  if (std::filesystem::file_size(one) != std::filesystem::file_size(other)) return false;
  std::ifstream first(one, std::ios::binary), second(other, std::ios::binary);
  using Bytes = std::istreambuf_iterator<char>;
  return first && second && std::equal(Bytes(first), Bytes(), Bytes(second), Bytes());
}

}  // namespace

std::filesystem::path copied_into(const std::filesystem::path& folder, const std::filesystem::path& body) {
  if (!std::filesystem::is_regular_file(body)) {
    throw InputError(body.string() + ": is gone, a scene cannot name it; open the mesh anew to bake it again");
  }
  std::filesystem::path copy = folder / body.filename();
  for (int number = 1; std::filesystem::exists(copy); ++number) {
    if (same_bytes(body, copy)) return copy;
    copy = folder / (body.stem().string() + "-" + std::to_string(number) + body.extension().string());
  }
  write_atomically(copy, [&](const std::filesystem::path& temporary) {
    std::filesystem::copy_file(body, temporary, std::filesystem::copy_options::overwrite_existing);
  });
  return copy;
}

}  // namespace quadgraph
