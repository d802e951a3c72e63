// Byte layout of a .qgraph file, version 1: docs/qgraph-format.md in C++. The Python side is
// python/quadgraph/file/qgraph_file.py; tests/python/file/test_layout.py compares the two.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace quadgraph {

inline constexpr std::array<unsigned char, 8> qgraph_magic = {0x89, 'Q', 'G', 'R', 'A', 'P', 'H', '\n'};
inline constexpr std::uint32_t qgraph_version = 1;
inline constexpr std::uint32_t qgraph_byte_order = 0x01020304;
inline constexpr std::uint64_t qgraph_alignment = 64;
inline constexpr std::uint32_t qgraph_max_sections = 4096;
inline constexpr std::uint32_t qgraph_max_levels = 16;

enum class SectionType : std::uint32_t { u8 = 1, u32 = 2, f32 = 3 };

struct QgraphHeader {
  std::array<unsigned char, 8> magic;
  std::uint32_t version;
  std::uint32_t byte_order;
  std::uint32_t section_count;
  std::uint32_t table_crc32;
  std::uint64_t file_size;
  std::array<unsigned char, 32> reserved;
};
static_assert(sizeof(QgraphHeader) == 64);

struct QgraphSection {
  std::array<char, 64> name;
  SectionType type;
  std::uint32_t rank;
  std::array<std::uint64_t, 3> shape;
  std::uint64_t offset;
  std::uint64_t size;
  std::uint32_t crc32;
  std::array<unsigned char, 12> reserved;
};
static_assert(sizeof(QgraphSection) == 128);

}  // namespace quadgraph
