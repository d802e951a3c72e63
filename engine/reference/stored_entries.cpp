#include "engine/reference/stored_entries.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "shaders/solver/packing.h"

namespace quadgraph {
namespace {

// See format_of.
constexpr double largest_entry = 1000, largest_conduction = 4000, most_vertices = 0.01, mean_conduction = 25;

// The word of a plain entry that holds its column, and those of its blocks.
std::size_t plain_column(bool sp3) {
  return sp3 ? 0 : 3;
}
std::size_t plain_blocks(bool sp3) {
  return sp3 ? 1 : 0;
}

void store_plain(std::uint32_t* words, const glm::dvec3& block) {
  for (int c = 0; c < 3; ++c) words[c] = glm::floatBitsToUint(static_cast<float>(block[c]));
}

glm::dvec3 plain_block(const std::uint32_t* words) {
  return {glm::uintBitsToFloat(words[0]), glm::uintBitsToFloat(words[1]), glm::uintBitsToFloat(words[2])};
}

// What the elements around a vertex add up to.
struct VertexShape {
  double volume = 0;      // mm^3
  double largest = 0;     // entry of an element, mm
  double conduction = 0;  // sum over the edges of elements of size times length squared, mm^3
};

std::vector<VertexShape> vertex_shapes(const Level& level, const Listener& listener) {
  constexpr std::array<std::array<int, 2>, 6> edges = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  std::vector<VertexShape> shapes(level.vertices.size());
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    heed(listener, t);
    const glm::uvec4& tet = level.tets[t];
    std::array<glm::dvec3, 4> p;
    for (int k = 0; k < 4; ++k) p[static_cast<std::size_t>(k)] = glm::dvec3(level.vertices[tet[k]]);
    const glm::dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0], e3 = p[3] - p[0];
    const glm::dvec3 n1 = glm::cross(e2, e3), n2 = glm::cross(e3, e1), n3 = glm::cross(e1, e2);
    const std::array<glm::dvec3, 4> normal = {-(n1 + n2 + n3), n1, n2, n3};
    const double six_volume = std::abs(glm::dot(e1, n1));
    for (const auto& [a, b] : edges) {
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      const double entry = std::abs(glm::dot(normal[i], normal[j])) / (6 * six_volume);
      const double conduction = entry * glm::dot(p[i] - p[j], p[i] - p[j]);
      for (const int k : {a, b}) {
        VertexShape& shape = shapes[tet[k]];
        shape.largest = std::max(shape.largest, entry);
        shape.conduction += conduction;
      }
    }
    for (int k = 0; k < 4; ++k) shapes[tet[k]].volume += six_volume / 24;
  }
  return shapes;
}

}  // namespace

EntryFormat format_of(const Level& level, Method method, const Listener& listener) {
  if (method != Method::fem || level.vertices.size() > gpu::PACKED_COLUMNS) return EntryFormat::plain;
  std::size_t bad = 0;
  double conduction = 0, volume = 0;
  for (const VertexShape& shape : vertex_shapes(level, listener)) {
    if (!(shape.largest <= largest_entry * std::cbrt(shape.volume))) return EntryFormat::plain;
    if (!(shape.conduction <= largest_conduction * shape.volume)) ++bad;
    conduction += shape.conduction;
    volume += shape.volume;
  }
  if (!(conduction <= mean_conduction * volume)) return EntryFormat::plain;
  return static_cast<double>(bad) > most_vertices * static_cast<double>(level.vertices.size()) ? EntryFormat::plain
                                                                                               : EntryFormat::packed;
}

std::vector<std::uint32_t> stored_columns(std::span<const std::uint32_t> columns, Model model, EntryFormat format) {
  const bool split = format == EntryFormat::packed && model != Model::sp3;
  const std::size_t place = format == EntryFormat::plain ? plain_column(model == Model::sp3) : 0;
  const std::uint32_t words = stored_words(model, format);
  std::vector<std::uint32_t> stored(words * columns.size(), 0);
  for (std::size_t e = 0; e < columns.size(); ++e) {
    stored[words * e + place] = split ? columns[e] & 0xfffffu : columns[e];
    if (split) stored[words * e + 1] = columns[e] >> 20u;
  }
  return stored;
}

void store_weight(std::span<std::uint32_t> words, std::size_t e, const Block& weight, Model model, EntryFormat format) {
  std::uint32_t* w = &words[stored_words(model, format) * e];
  const bool sp3 = model == Model::sp3;
  if (format == EntryFormat::plain) {
    store_plain(w + plain_blocks(sp3), weight.a11);
    if (sp3) store_plain(w + 4, weight.a12);
    if (sp3) store_plain(w + 7, weight.a22);
  } else if (sp3) {
    const glm::dvec3 rest12 = weight.a12 - double{gpu::SP3_SHARE12} * weight.a11;
    const glm::dvec3 rest22 = weight.a22 - double{gpu::SP3_SHARE22} * weight.a11;
    const gpu::Sp3Block block{glm::vec3(weight.a11), glm::vec3(rest12), glm::vec3(rest22)};
    const glm::uvec4 packed = gpu::pack_sp3(w[0] & 0x3fffffu, block);
    for (int k = 0; k < 4; ++k) w[k] = packed[k];
  } else {
    const gpu::PackedBlock block = gpu::pack(glm::vec3(weight.a11), gpu::DIFFUSION_BITS);
    const glm::uvec3 n = glm::uvec3(block.number) & 0xfffu;
    w[0] = (w[0] & 0xfffffu) | n.x << 20u;
    w[1] = (w[1] & 3u) | block.exponent << 2u | n.y << 8u | n.z << 20u;
  }
}

StoredEntry stored_entry(std::span<const std::uint32_t> words, std::size_t e, Model model, EntryFormat format) {
  const std::uint32_t* w = &words[stored_words(model, format) * e];
  if (format == EntryFormat::plain) {
    if (model != Model::sp3) return {w[plain_column(false)], {plain_block(w + plain_blocks(false)), {}, {}}};
    return {w[0], {plain_block(w + 1), plain_block(w + 4), plain_block(w + 7)}};
  }
  if (model != Model::sp3) {
    const glm::ivec3 number(gpu::number_at(w[0], 20, 12), gpu::number_at(w[1], 8, 12), gpu::number_at(w[1], 20, 12));
    return {(w[0] & 0xfffffu) | (w[1] & 3u) << 20u, {glm::dvec3(gpu::unpack(number, (w[1] >> 2u) & 63u)), {}, {}}};
  }
  const gpu::Sp3Block block = gpu::unpack_sp3({w[0], w[1], w[2], w[3]});
  const glm::dvec3 a11(block.a11);
  return {w[0] & 0x3fffffu,
          {a11, double{gpu::SP3_SHARE12} * a11 + glm::dvec3(block.rest12),
           double{gpu::SP3_SHARE22} * a11 + glm::dvec3(block.rest22)}};
}

Rows as_packed(Rows rows, Model model) {
  std::vector<std::uint32_t> words(stored_words(model, EntryFormat::packed));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
      Block& weight = rows.weight[k];
      rows.diagonal[i] += weight;
      store_weight(words, 0, weight, model, EntryFormat::packed);
      weight = stored_entry(words, 0, model, EntryFormat::packed).weight;
      rows.diagonal[i] = rows.diagonal[i] - weight;
    }
  }
  return rows;
}

}  // namespace quadgraph
