#include "engine/file/shapes.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <new>
#include <string>

#include "engine/base/error.h"
#include "engine/base/regular_file.h"
#include "engine/file/file_cache.h"
#include "engine/file/section_table.h"

namespace quadgraph {
namespace {

struct AlignedDelete {
  void operator()(std::byte* p) const { ::operator delete[](p, std::align_val_t{qgraph_alignment}); }
};

struct Bytes {
  std::unique_ptr<std::byte[], AlignedDelete> data;
  std::size_t size = 0;
};

Bytes read_file(const std::filesystem::path& path) {
  Bytes bytes;
  bytes.size = bytes_of_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(path.string() + ": cannot be read (" + std::strerror(errno) + ")");
  bytes.data.reset(static_cast<std::byte*>(::operator new[](bytes.size + 1, std::align_val_t{qgraph_alignment})));
  if (!stream.read(reinterpret_cast<char*>(bytes.data.get()), static_cast<std::streamsize>(bytes.size))) {
    throw InputError(path.string() + ": cannot be read to its end");
  }
  return bytes;
}

ShapesOfMesh read_mesh(const SectionTable& table, const std::string& name, std::uint32_t count) {
  const std::span<const float> values = table.rows<float>(name, 3);
  const std::size_t all = values.size() / 3;
  if (all % count != 0) {
    fail_format(table.file(), name,
                "found " + std::to_string(all) + " displacements, as many for each of " + std::to_string(count) +
                    " shapes are wanted");
  }
  ShapesOfMesh shapes(count, std::vector<glm::vec3>(all / count));
  for (std::size_t i = 0; i < all; ++i) {
    const glm::vec3 d(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    if (!std::isfinite(d.x) || !std::isfinite(d.y) || !std::isfinite(d.z)) {
      fail_format(table.file(), name, "displacement " + std::to_string(i) + " is not finite");
    }
    shapes[i / (all / count)][i % (all / count)] = d;
  }
  return shapes;
}

std::shared_ptr<const Shapes> read_shapes(const std::filesystem::path& path) {
  const Bytes bytes = read_file(path);
  const SectionTable table({bytes.data.get(), bytes.size}, path.string());
  const auto counts = table.rows<std::uint32_t>("shapes", 1);
  if (counts.size() != 1 || counts[0] == 0 || counts[0] > 65536) {
    fail_format(table.file(), "shapes", "one number from 1 to 65536 is wanted");
  }
  auto shapes = std::make_shared<Shapes>();
  shapes->file = path;
  shapes->display = read_mesh(table, "display", counts[0]);
  for (std::uint32_t i = 0; table.has("level" + std::to_string(i)); ++i) {
    shapes->levels.push_back(read_mesh(table, "level" + std::to_string(i), counts[0]));
  }
  return shapes;
}

}  // namespace

std::shared_ptr<const Shapes> load_shapes(const std::filesystem::path& path) {
  static FileCache<Shapes> known(1);
  return known.load(path, read_shapes);
}

}  // namespace quadgraph
