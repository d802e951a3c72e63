// Whole .qgraph files in memory for tests: chains of boxes with transfers, written as docs/qgraph-format.md says.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "engine/graph/qgraph_layout.h"
#include "tests/cpp/test_levels.h"

namespace quadgraph {

class GraphWriter {
 public:
  template <typename T>
  void add(const std::string& name, SectionType type, std::vector<std::uint64_t> shape, std::span<const T> values) {
    QgraphSection section{};
    std::copy(name.begin(), name.end(), section.name.begin());
    section.type = type;
    section.rank = static_cast<std::uint32_t>(shape.size());
    std::copy(shape.begin(), shape.end(), section.shape.begin());
    section.size = values.size_bytes();
    section.crc32 = crc(values.data(), values.size_bytes());
    table_.push_back(section);
    const auto* begin = reinterpret_cast<const std::byte*>(values.data());
    data_.emplace_back(begin, begin + values.size_bytes());
  }

  template <typename Vector>
  void add_vectors(const std::string& name, SectionType type, const std::vector<Vector>& values) {
    add<Vector>(name, type, {values.size(), static_cast<std::uint64_t>(Vector::length())}, values);
  }

  std::vector<std::byte> bytes() {
    std::uint64_t end = sizeof(QgraphHeader) + sizeof(QgraphSection) * table_.size();
    for (QgraphSection& section : table_) {
      section.offset = aligned(end);
      end = section.offset + section.size;
    }
    QgraphHeader header{};
    header.magic = qgraph_magic;
    header.version = qgraph_version;
    header.byte_order = qgraph_byte_order;
    header.section_count = static_cast<std::uint32_t>(table_.size());
    header.table_crc32 = crc(table_.data(), sizeof(QgraphSection) * table_.size());
    header.file_size = aligned(end);
    std::vector<std::byte> file(header.file_size);
    std::memcpy(file.data(), &header, sizeof(header));
    std::memcpy(file.data() + sizeof(header), table_.data(), sizeof(QgraphSection) * table_.size());
    for (std::size_t i = 0; i < table_.size(); ++i) {
      std::memcpy(file.data() + table_[i].offset, data_[i].data(), data_[i].size());
    }
    return file;
  }

 private:
  static std::uint64_t aligned(std::uint64_t at) {
    return (at + qgraph_alignment - 1) / qgraph_alignment * qgraph_alignment;
  }
  static std::uint32_t crc(const void* data, std::size_t size) {
    return static_cast<std::uint32_t>(::crc32(0, static_cast<const Bytef*>(data), static_cast<uInt>(size)));
  }

  std::vector<QgraphSection> table_;
  std::vector<std::vector<std::byte>> data_;
};

// Every tet cut into four at its centroid, so that none has two outside faces.
inline OwnedLevel split_at_centroids(const OwnedLevel& level, const std::vector<bool>& which = {}) {
  std::vector<glm::vec3> vertices = level.vertices;
  std::vector<glm::uvec4> tets;
  for (std::size_t i = 0; i < level.tets.size(); ++i) {
    const glm::uvec4& t = level.tets[i];
    if (!which.empty() && !which[i]) {
      tets.push_back(t);
      continue;
    }
    const auto centre = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back((vertices[t[0]] + vertices[t[1]] + vertices[t[2]] + vertices[t[3]]) / 4.0f);
    for (int k = 0; k < 4; ++k) {
      glm::uvec4 part = t;
      part[k] = centre;
      tets.push_back(part);
    }
  }
  return level_from_tets(std::move(vertices), std::move(tets));
}

// Only those with several outside faces, as a bake does: elements stay well-shaped.
inline OwnedLevel split_at_corners(const OwnedLevel& level) {
  std::vector<int> outside(level.tets.size(), 0);
  for (const std::uint32_t t : level.face_tets) ++outside[t];
  std::vector<bool> which;
  for (const int faces : outside) which.push_back(faces > 1);
  return split_at_centroids(level, which);
}

// Inverse squared distance from the `width` nearest sources.
inline void write_nearest(GraphWriter& writer, const std::string& name, std::span<const glm::vec3> targets,
                          std::span<const glm::vec3> sources, std::uint32_t width) {
  std::vector<std::uint32_t> index;
  std::vector<float> weight;
  std::vector<std::uint32_t> order(sources.size());
  std::iota(order.begin(), order.end(), 0u);
  for (const glm::vec3& target : targets) {
    const auto squared = [&](std::uint32_t i) { return glm::dot(sources[i] - target, sources[i] - target); };
    std::partial_sort(order.begin(), order.begin() + width, order.end(),
                      [&](std::uint32_t a, std::uint32_t b) { return squared(a) < squared(b); });
    float sum = 0;
    for (std::uint32_t k = 0; k < width; ++k) sum += 1.0f / (squared(order[k]) + 1e-6f);
    for (std::uint32_t k = 0; k < width; ++k) {
      index.push_back(order[k]);
      weight.push_back(1.0f / (squared(order[k]) + 1e-6f) / sum);
    }
  }
  writer.add<std::uint32_t>(name + "_index", SectionType::u32, {targets.size(), width}, index);
  writer.add<float>(name + "_weight", SectionType::f32, {targets.size(), width}, weight);
}

inline glm::vec4 barycentric_in(const OwnedLevel& level, const glm::uvec4& t, const glm::vec3& p) {
  const auto volume = [&](const std::array<glm::vec3, 4>& v) {
    return glm::dot(v[1] - v[0], glm::cross(v[2] - v[0], v[3] - v[0]));
  };
  const std::array<glm::vec3, 4> corner = {level.vertices[t[0]], level.vertices[t[1]], level.vertices[t[2]],
                                           level.vertices[t[3]]};
  glm::vec4 result;
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<glm::vec3, 4> moved = corner;
    moved[k] = p;
    result[static_cast<int>(k)] = volume(moved) / volume(corner);
  }
  return result;
}

inline void write_barycentric(GraphWriter& writer, const std::string& name, const OwnedLevel& fine,
                              const OwnedLevel& coarse) {
  std::vector<glm::uvec4> index;
  std::vector<glm::vec4> weight;
  for (const glm::vec3& p : fine.vertices) {
    float best = -1e30f;
    glm::uvec4 tet(0);
    glm::vec4 clamped(0);
    for (const glm::uvec4& t : coarse.tets) {
      const glm::vec4 w = barycentric_in(coarse, t, p);
      const float inside = std::min({w[0], w[1], w[2], w[3]});
      if (inside <= best) continue;
      best = inside;
      tet = t;
      clamped = glm::max(w, glm::vec4(0));
    }
    index.push_back(tet);
    weight.push_back(clamped / (clamped[0] + clamped[1] + clamped[2] + clamped[3]));
  }
  writer.add_vectors(name + "_index", SectionType::u32, index);
  writer.add_vectors(name + "_weight", SectionType::f32, weight);
}

inline void write_level(GraphWriter& writer, const std::string& prefix, const OwnedLevel& level,
                        const OwnedLevel* coarse) {
  writer.add_vectors(prefix + "vertices", SectionType::f32, level.vertices);
  writer.add_vectors(prefix + "tets", SectionType::u32, level.tets);
  writer.add_vectors(prefix + "faces", SectionType::u32, level.faces);
  writer.add<std::uint32_t>(prefix + "face_tets", SectionType::u32, {level.face_tets.size()}, level.face_tets);
  writer.add_vectors(prefix + "links", SectionType::u32, level.links);
  writer.add_vectors(prefix + "nodes", SectionType::f32, level.nodes);
  if (!level.face_kinds.empty()) {
    writer.add<std::uint32_t>(prefix + "face_kinds", SectionType::u32, {level.face_kinds.size()}, level.face_kinds);
  }
  if (!level.seen.empty()) {
    writer.add<std::uint32_t>(prefix + "seen_rays", SectionType::u32, {1}, std::span(&level.seen_rays, 1));
    writer.add<std::uint32_t>(prefix + "seen", SectionType::u32, {level.seen.size()}, level.seen);
  }
  if (coarse == nullptr) return;
  const std::span<const glm::vec3> fine_nodes = level.nodes, coarse_nodes = coarse->nodes;
  write_nearest(writer, prefix + "inner", fine_nodes.first(level.tets.size()), coarse_nodes.first(coarse->tets.size()),
                8);
  write_nearest(writer, prefix + "surface", fine_nodes.subspan(level.tets.size()),
                coarse_nodes.subspan(coarse->tets.size()), 4);
  write_barycentric(writer, prefix + "barycentric", level, *coarse);
}

// A file of these levels, finest first. The display mesh is one triangle.
inline std::vector<std::byte> graph_of(const std::vector<OwnedLevel>& levels) {
  std::string metadata = R"({"generator":"","source":{},"unit_mm":1,"mesher":{},"repairs":[],"tools":{},"levels":[)";
  for (std::size_t i = 0; i < levels.size(); ++i) metadata += i > 0 ? ",{}" : "{}";
  metadata += "]}";
  GraphWriter writer;
  writer.add<char>("metadata", SectionType::u8, {metadata.size()}, std::span<const char>(metadata));
  for (std::size_t i = 0; i < levels.size(); ++i) {
    write_level(writer, "level" + std::to_string(i) + "/", levels[i], i + 1 < levels.size() ? &levels[i + 1] : nullptr);
  }
  const glm::uvec3& f = levels[0].faces[0];
  const std::vector<glm::vec3> corners = {levels[0].vertices[f.x], levels[0].vertices[f.y], levels[0].vertices[f.z]};
  const glm::vec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  writer.add_vectors("display/vertices", SectionType::f32, corners);
  writer.add_vectors("display/normals", SectionType::f32, std::vector<glm::vec3>(3, normal));
  writer.add_vectors("display/triangles", SectionType::u32, std::vector<glm::uvec3>{{0, 1, 2}});
  writer.add<std::uint32_t>("display/face", SectionType::u32, {3}, std::vector<std::uint32_t>(3, 0));
  writer.add_vectors("display/barycentric", SectionType::f32, std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  return writer.bytes();
}

inline std::vector<std::byte> graph_of(const OwnedLevel& level) {
  return graph_of(std::vector<OwnedLevel>{level});
}

// Cubes of `size` mm with `cells` cells along each edge, finest first.
inline std::vector<std::byte> box_graph(const std::vector<std::uint32_t>& cells, float size) {
  std::vector<OwnedLevel> levels;
  for (const std::uint32_t n : cells) levels.push_back(split_at_centroids(box_level(n, size, 0.15f)));
  return graph_of(levels);
}

}  // namespace quadgraph
