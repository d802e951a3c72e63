// Makes the checksums of a damaged .qgraph right again where its table can still be followed, so that tests and the
// fuzzer reach the rules behind them.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstring>
#include <span>

#include "engine/graph/qgraph_layout.h"

namespace quadgraph {

inline std::uint32_t crc32_bytes(const std::byte* data, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(data), size));
}

inline void fix_checksums(std::span<std::byte> file) {
  if (file.size() < sizeof(QgraphHeader)) return;
  QgraphHeader header;
  std::memcpy(&header, file.data(), sizeof header);
  const std::uint64_t table_end = sizeof header + std::uint64_t{header.section_count} * sizeof(QgraphSection);
  if (header.section_count > qgraph_max_sections || table_end > file.size()) return;
  for (std::uint64_t at = sizeof header; at < table_end; at += sizeof(QgraphSection)) {
    QgraphSection section;
    std::memcpy(&section, file.data() + at, sizeof section);
    if (section.offset <= file.size() && section.size <= file.size() - section.offset) {
      section.crc32 = crc32_bytes(file.data() + section.offset, section.size);
      std::memcpy(file.data() + at, &section, sizeof section);
    }
  }
  header.file_size = file.size();
  header.table_crc32 = crc32_bytes(file.data() + sizeof header, table_end - sizeof header);
  std::memcpy(file.data(), &header, sizeof header);
}

}  // namespace quadgraph
