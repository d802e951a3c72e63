// The bytes of a .qgraph file, opened up for damage: tests and the fuzz target change them, then seal them again.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "engine/graph/qgraph_layout.h"

namespace quadgraph {

template <typename T>
T read_at(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

template <typename T>
void write_at(std::span<std::byte> bytes, std::size_t offset, const T& value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

inline std::uint32_t checksum(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// Where entry `i` of the section table starts.
inline std::size_t entry_offset(std::size_t i) {
  return sizeof(QgraphHeader) + i * sizeof(QgraphSection);
}

// Entries of the section table that lie in the file, whatever the header claims.
inline std::size_t entries_present(std::span<const std::byte> bytes) {
  if (bytes.size() < sizeof(QgraphHeader)) return 0;
  const std::size_t claimed = read_at<QgraphHeader>(bytes, 0).section_count;
  return std::min(claimed, (bytes.size() - sizeof(QgraphHeader)) / sizeof(QgraphSection));
}

// Recomputes every checksum that can be, and the file size: only the rules behind them can refuse the file then.
inline void seal(std::span<std::byte> bytes) {
  if (bytes.size() < sizeof(QgraphHeader)) return;
  const std::size_t count = entries_present(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    auto section = read_at<QgraphSection>(bytes, entry_offset(i));
    if (section.offset > bytes.size() || section.size > bytes.size() - section.offset) continue;
    section.crc32 = checksum(bytes.subspan(section.offset, section.size));
    write_at(bytes, entry_offset(i), section);
  }
  auto header = read_at<QgraphHeader>(bytes, 0);
  header.file_size = bytes.size();
  header.table_crc32 = checksum(bytes.subspan(sizeof(QgraphHeader), count * sizeof(QgraphSection)));
  write_at(bytes, 0, header);
}

}  // namespace quadgraph
