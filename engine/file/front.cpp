#include "engine/file/front.h"

#include <fstream>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/file/qgraph_layout.h"
#include "engine/file/section_table.h"

namespace quadgraph {
namespace {

// The metadata is the first section. A pipe, whose end nobody may ever write, is not waited for.
std::string first_section(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return {};
  std::ifstream stream(path, std::ios::binary);
  QgraphHeader header{};
  QgraphSection section{};
  stream.read(reinterpret_cast<char*>(&header), sizeof header);
  stream.read(reinterpret_cast<char*>(&section), sizeof section);
  const std::uintmax_t size = std::filesystem::file_size(path, none);
  if (!stream || none || header.magic != qgraph_magic || section.size > size) return {};
  std::string text(section.size, '\0');
  stream.seekg(static_cast<std::streamoff>(section.offset));
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  return stream ? text : std::string();
}

}  // namespace

float front_from(const std::string& metadata, const std::string& file) {
  const auto json = parse_json(metadata);
  if (!json.is_object() || !json.contains("front")) return 0;
  const auto& front = json["front"];
  if (!front.is_number() || front < -180 || front > 360) {
    fail_format(file, "metadata", "'front' is " + front.dump() + ", allowed are -180 to 360 degrees");
  }
  return front.get<float>();
}

float front_of(const std::filesystem::path& file) {
  try {
    return front_from(first_section(file), file.string());
  } catch (const FormatError&) {
    return 0;
  } catch (const InputError&) {
    return 0;
  }
}

}  // namespace quadgraph
