#include "engine/file/graph.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <future>
#include <new>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/base/regular_file.h"
#include "engine/file/body_names.h"
#include "engine/file/front.h"
#include "engine/file/section_table.h"
#include "engine/file/validate.h"

namespace quadgraph {
namespace {

constexpr std::align_val_t block_alignment{qgraph_alignment};

template <typename Vector>
std::span<const Vector> vectors(const SectionTable& table, const std::string& name) {
  using Scalar = typename Vector::value_type;
  const auto flat = table.rows<Scalar>(name, static_cast<std::uint64_t>(Vector::length()));
  return {reinterpret_cast<const Vector*>(flat.data()), flat.size() / static_cast<std::size_t>(Vector::length())};
}

Transfer read_transfer(const SectionTable& table, const std::string& prefix, std::uint32_t width) {
  return {table.rows<std::uint32_t>(prefix + "_index", width), table.rows<float>(prefix + "_weight", width), width};
}

Level read_level(const SectionTable& table, std::uint32_t index, bool coarsest) {
  const std::string prefix = "level" + std::to_string(index) + "/";
  Level level;
  level.vertices = vectors<glm::vec3>(table, prefix + "vertices");
  level.tets = vectors<glm::uvec4>(table, prefix + "tets");
  level.faces = vectors<glm::uvec3>(table, prefix + "faces");
  level.face_tets = table.rows<std::uint32_t>(prefix + "face_tets", 1);
  level.links = vectors<glm::uvec4>(table, prefix + "links");
  level.nodes = vectors<glm::vec3>(table, prefix + "nodes");
  if (table.has(prefix + "face_kinds")) level.face_kinds = table.rows<std::uint32_t>(prefix + "face_kinds", 1);
  if (table.has(prefix + "tet_bodies")) level.tet_bodies = table.rows<std::uint8_t>(prefix + "tet_bodies", 1);
  if (table.has(prefix + "grid_links")) {
    level.grid_links = table.rows<std::uint32_t>(prefix + "grid_links", grid_link_count);
  }
  if (table.has(prefix + "seen")) {
    const auto rays = table.rows<std::uint32_t>(prefix + "seen_rays", 1);
    if (rays.size() != 1) fail_format(table.file(), prefix + "seen_rays", "one number expected");
    level.seen_rays = rays[0];
    level.seen = table.rows<std::uint32_t>(prefix + "seen", 1);
  }
  if (!coarsest) {
    level.inner = read_transfer(table, prefix + "inner", 8);
    level.surface = read_transfer(table, prefix + "surface", 4);
    level.barycentric = read_transfer(table, prefix + "barycentric", 4);
  }
  return level;
}

void read_texture(const SectionTable& table, DisplayMesh& mesh) {
  mesh.texture_places = vectors<glm::vec3>(table, "display/texture_places");
  const std::uint64_t width = table.columns("display/normal_texture");
  if (width == 0 || width % 3 != 0) fail_format(table.file(), "display/normal_texture", "rows of RGB expected");
  mesh.normal_texture = table.rows<std::uint8_t>("display/normal_texture", width);
  mesh.texture_columns = static_cast<std::uint32_t>(width / 3);
  mesh.texture_rows = static_cast<std::uint32_t>(mesh.normal_texture.size() / width);
}

// Without levels it is tied to nothing.
DisplayMesh read_display(const SectionTable& table, bool tied) {
  DisplayMesh mesh{vectors<glm::vec3>(table, "display/vertices"),
                   vectors<glm::vec3>(table, "display/normals"),
                   vectors<glm::uvec3>(table, "display/triangles"),
                   {},
                   {}};
  if (table.has("display/texture_places")) read_texture(table, mesh);
  if (!tied) return mesh;
  mesh.face = table.rows<std::uint32_t>("display/face", 1);
  mesh.barycentric = vectors<glm::vec3>(table, "display/barycentric");
  return mesh;
}

// Names of all sections of a file with `levels` levels, in file order; those of `table` where they are optional.
std::vector<std::string> section_names(const SectionTable& table, std::uint32_t levels) {
  std::vector<std::string> names = {"metadata"};
  for (std::uint32_t i = 0; i < levels; ++i) {
    const std::string prefix = "level" + std::to_string(i) + "/";
    for (const char* field : {"vertices", "tets", "faces", "face_tets", "links", "nodes"}) {
      names.push_back(prefix + field);
    }
    if (table.has(prefix + "face_kinds")) names.push_back(prefix + "face_kinds");
    if (table.has(prefix + "tet_bodies")) names.push_back(prefix + "tet_bodies");
    if (table.has(prefix + "grid_links")) names.push_back(prefix + "grid_links");
    if (table.has(prefix + "seen_rays") || table.has(prefix + "seen")) {
      names.push_back(prefix + "seen_rays");
      names.push_back(prefix + "seen");
    }
    if (i + 1 == levels) continue;
    for (const char* field : {"inner", "surface", "barycentric"}) {
      names.push_back(prefix + field + "_index");
      names.push_back(prefix + field + "_weight");
    }
  }
  for (const char* field : {"vertices", "normals", "triangles", "face", "barycentric"}) {
    names.push_back(std::string("display/") + field);
  }
  if (levels == 0) names.resize(names.size() - 2);
  for (const char* field : {"texture_places", "normal_texture"}) {
    if (table.has("display/texture_places")) names.push_back(std::string("display/") + field);
  }
  return names;
}

std::uint32_t count_levels(const SectionTable& table) {
  std::uint32_t count = 0;
  while (count <= qgraph_max_levels && table.has("level" + std::to_string(count) + "/vertices")) ++count;
  if (count > qgraph_max_levels) {
    fail_format(table.file(), "levels", "found " + std::to_string(count) + ", allowed are 0 to 16");
  }
  const std::vector<std::string> expected = section_names(table, count);
  for (std::size_t i = 0; i < std::max(expected.size(), table.names().size()); ++i) {
    const std::string wanted = i < expected.size() ? "'" + expected[i] + "'" : "no more sections";
    const std::string found = i < table.names().size() ? "'" + table.names()[i] + "'" : "the end of the table";
    if (wanted != found) {
      fail_format(table.file(), "section " + std::to_string(i), "found " + found + ", expected " + wanted);
    }
  }
  return count;
}

nlohmann::ordered_json metadata_of(const SectionTable& table, const std::string& text) {
  try {
    return parse_json(text);
  } catch (const InputError& error) {
    fail_format(table.file(), "metadata", error.what());
  }
}

void check_metadata(const SectionTable& table, const std::string& text, std::size_t levels) {
  const auto json = metadata_of(table, text);
  if (!json.is_object()) fail_format(table.file(), "metadata", "not a JSON object in UTF-8");
  for (const char* key : {"generator", "source", "unit_mm", "mesher", "repairs", "levels", "tools"}) {
    if (!json.contains(key)) fail_format(table.file(), "metadata", "key '" + std::string(key) + "' is missing");
  }
  if (!json["levels"].is_array() || json["levels"].size() != levels) {
    fail_format(table.file(), "metadata", "'levels' must list " + std::to_string(levels) + " levels");
  }
}

std::string errno_text() {
  return std::strerror(errno);
}

}  // namespace

void QuadGraph::AlignedDelete::operator()(std::byte* p) const {
  ::operator delete[](p, block_alignment);
}

QuadGraph QuadGraph::parse(std::span<const std::byte> bytes, const std::string& name) {
  QuadGraph graph;
  const std::span<std::byte> own = graph.allocate(bytes.size());
  std::copy(bytes.begin(), bytes.end(), own.begin());
  graph.read(own, name);
  return graph;
}

void QuadGraph::check(std::span<const std::byte> bytes, const std::string& name) {
  QuadGraph().read(bytes, name);
}

QuadGraph QuadGraph::load(const std::filesystem::path& path) {
  const std::uintmax_t size = bytes_of_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(path.string() + ": cannot be opened (" + errno_text() + ")");
  std::array<char, sizeof(QgraphHeader)> first{};
  stream.read(first.data(), first.size());
  checked_header(std::as_bytes(std::span(first.data(), static_cast<std::size_t>(stream.gcount()))), size,
                 path.string());
  stream.seekg(0);
  QuadGraph graph;
  const std::span<std::byte> own = graph.allocate(size);
  stream.read(reinterpret_cast<char*>(own.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size) throw InputError(path.string() + ": short read");
  graph.read(own, path.string());
  return graph;
}

std::span<std::byte> QuadGraph::allocate(std::size_t size) {
  bytes_.reset(static_cast<std::byte*>(::operator new[](size, block_alignment)));
  return {bytes_.get(), size};
}

void QuadGraph::read(std::span<const std::byte> bytes, const std::string& name) {
  byte_size_ = bytes.size();
  const SectionTable table(bytes, name);
  const std::uint32_t count = count_levels(table);
  metadata_ = table.text("metadata");
  check_metadata(table, metadata_, count);
  front_ = front_from(metadata_, name);
  bodies_ = body_names(metadata_, name);
  hosts_ = body_hosts(metadata_, bodies_, name);
  outermost_ = outermost_bodies(hosts_);
  for (std::uint32_t i = 0; i < count; ++i) levels_.push_back(read_level(table, i, i + 1 == count));
  display_ = read_display(table, count > 0);
  validate(name);
}

void QuadGraph::validate(const std::string& name) {
  const auto count = static_cast<std::uint32_t>(levels_.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    validate_indices(levels_[i], name, i);
    levels_[i].surface_vertex_count = count_surface_vertices(levels_[i]);
  }
  validate_display(display_, levels_.empty() ? nullptr : &levels_[0], name);
  validate_bodies(levels_, bodies_.size(), name);
  // Beside the rest where a thread is to be had; else in get().
  std::future<void> places = std::async([&] { validate_places(levels_, display_, name); });
  for (std::uint32_t i = 0; i < count; ++i) {
    validate_level(levels_[i], i + 1 < count ? &levels_[i + 1] : nullptr, name, i);
    validate_grid(levels_[i], name, i);
  }
  validate_grid_everywhere(levels_, name);
  validate_bodies_apart(levels_, display_, hosts_, name);
  validate_seen_once(levels_, name);
  places.get();
}

}  // namespace quadgraph
