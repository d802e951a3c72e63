#include "engine/file/section_table.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

std::uint64_t align_up(std::uint64_t offset) {
  return (offset + qgraph_alignment - 1) / qgraph_alignment * qgraph_alignment;
}

std::uint32_t crc32_of(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint64_t type_size(SectionType type) {
  switch (type) {
    case SectionType::u8:
      return 1;
    case SectionType::u32:
    case SectionType::f32:
      return 4;
  }
  return 0;
}

template <std::size_t N, typename T>
bool all_zero(const std::array<T, N>& values) {
  return std::all_of(values.begin(), values.end(), [](T v) { return v == 0; });
}

// Empty if the field breaks its rule.
std::string section_name(const QgraphSection& section) {
  const auto end = std::find(section.name.begin(), section.name.end(), '\0');
  const bool padded = std::all_of(end, section.name.end(), [](char c) { return c == '\0'; });
  const bool printable = std::all_of(section.name.begin(), end, [](char c) { return c > ' ' && c <= '~'; });
  if (end == section.name.end() || !padded || !printable) return {};
  return {section.name.begin(), end};
}

// Bytes of the shape; 0 if a rule is broken or the product exceeds `limit`.
std::uint64_t shape_bytes(const QgraphSection& section, std::uint64_t limit) {
  std::uint64_t bytes = type_size(section.type);
  for (std::uint32_t d = 0; d < section.shape.size(); ++d) {
    const std::uint64_t extent = section.shape[d];
    if (d >= section.rank) {
      if (extent != 0) return 0;
    } else {
      if (extent == 0 || extent > limit / std::max<std::uint64_t>(bytes, 1)) return 0;
      bytes *= extent;
    }
  }
  return bytes;
}

}  // namespace

void fail_format(const std::string& file, std::string_view section, const std::string& rule) {
  throw FormatError(file + ": " + std::string(section) + ": " + rule);
}

SectionTable::SectionTable(std::span<const std::byte> bytes, const std::string& file) : bytes_(bytes), file_(file) {
  read_header();
}

QgraphHeader checked_header(std::span<const std::byte> first_bytes, std::uint64_t file_size, const std::string& file) {
  if (first_bytes.size() < sizeof(QgraphHeader)) {
    fail_format(file, "header", std::to_string(first_bytes.size()) + " bytes, a .qgraph file has at least 64");
  }
  QgraphHeader header;
  std::memcpy(&header, first_bytes.data(), sizeof header);
  if (header.magic != qgraph_magic) fail_format(file, "header", "magic: this is not a .qgraph file");
  if (header.version != qgraph_version) {
    fail_format(file, "header", "version " + std::to_string(header.version) + ", this engine reads version 1");
  }
  if (header.byte_order != qgraph_byte_order) fail_format(file, "header", "byte_order: not little-endian");
  if (header.file_size != file_size) {
    fail_format(file, "header",
                "file_size " + std::to_string(header.file_size) + ", the file has " + std::to_string(file_size) +
                    " bytes (truncated or extended)");
  }
  if (!all_zero(header.reserved)) fail_format(file, "header", "reserved bytes are not zero");
  const std::uint64_t count = header.section_count;
  if (count == 0 || count > qgraph_max_sections || count * sizeof(QgraphSection) > file_size - sizeof(QgraphHeader)) {
    fail_format(file, "header", "section_count " + std::to_string(count) + ", allowed is 1 to 4096 within the file");
  }
  return header;
}

void SectionTable::read_header() {
  const QgraphHeader header = checked_header(bytes_, bytes_.size(), file_);
  const auto table = bytes_.subspan(sizeof header, std::size_t{header.section_count} * sizeof(QgraphSection));
  if (crc32_of(table) != header.table_crc32) fail_format(file_, "section table", "checksum mismatch");
  read_entries(header.section_count);
}

void SectionTable::read_entries(std::uint32_t count) {
  std::uint64_t end = sizeof(QgraphHeader) + std::uint64_t{count} * sizeof(QgraphSection);
  for (std::uint32_t i = 0; i < count; ++i) {
    QgraphSection section;
    std::memcpy(&section, bytes_.data() + sizeof(QgraphHeader) + i * sizeof(QgraphSection), sizeof section);
    const std::string name = section_name(section);
    const std::string where = "section " + std::to_string(i);
    if (name.empty()) fail_format(file_, where, "name is not zero-padded printable ASCII");
    check_entry(section, name, align_up(end));
    check_padding(end, section.offset);
    if (!sections_.emplace(name, section).second) fail_format(file_, name, "the name occurs twice");
    names_.push_back(name);
    end = section.offset + section.size;
  }
  if (align_up(end) != bytes_.size()) {
    fail_format(file_, "end",
                "the last section ends at " + std::to_string(end) + ", the file at " + std::to_string(bytes_.size()) +
                    ": trailing or missing bytes");
  }
  check_padding(end, bytes_.size());
}

void SectionTable::check_entry(const QgraphSection& section, const std::string& name,
                               std::uint64_t expected_offset) const {
  if (type_size(section.type) == 0) fail_format(file_, name, "type: allowed are 1 (u8), 2 (u32), 3 (f32)");
  if (section.rank != 1 && section.rank != 2) fail_format(file_, name, "rank: allowed are 1 and 2");
  const std::uint64_t bytes = shape_bytes(section, bytes_.size());
  if (bytes == 0) fail_format(file_, name, "shape does not fit its rank or the file");
  if (section.size != bytes) {
    fail_format(file_, name, "size " + std::to_string(section.size) + ", the shape gives " + std::to_string(bytes));
  }
  if (section.offset != expected_offset) {
    fail_format(file_, name,
                "offset " + std::to_string(section.offset) + ", expected " + std::to_string(expected_offset));
  }
  if (section.offset > bytes_.size() || section.size > bytes_.size() - section.offset) {
    fail_format(file_, name, "reaches beyond the end of the file");
  }
  if (!all_zero(section.reserved)) fail_format(file_, name, "reserved bytes are not zero");
  if (crc32_of(bytes_.subspan(section.offset, section.size)) != section.crc32) {
    fail_format(file_, name, "checksum mismatch");
  }
}

void SectionTable::check_padding(std::uint64_t begin, std::uint64_t end) const {
  const auto gap = bytes_.subspan(begin, end - begin);
  if (!std::all_of(gap.begin(), gap.end(), [](std::byte b) { return b == std::byte{0}; })) {
    fail_format(file_, "padding", "bytes between sections are not zero");
  }
}

const QgraphSection& SectionTable::find(const std::string& name, SectionType type, std::uint64_t columns) const {
  const auto found = sections_.find(name);
  if (found == sections_.end()) fail_format(file_, name, "the section is missing");
  const QgraphSection& section = found->second;
  const std::uint32_t rank = columns == 1 ? 1 : 2;
  if (section.type != type || section.rank != rank || (rank == 2 && section.shape[1] != columns)) {
    fail_format(file_, name,
                "wrong type or shape: expected rows of " + std::to_string(columns) +
                    (type == SectionType::f32   ? " f32"
                     : type == SectionType::u32 ? " u32"
                                                : " u8"));
  }
  return section;
}

template <typename T>
std::span<const T> SectionTable::rows(const std::string& name, std::uint64_t columns) const {
  const SectionType type = std::is_same_v<T, float>           ? SectionType::f32
                           : std::is_same_v<T, std::uint32_t> ? SectionType::u32
                                                              : SectionType::u8;
  const QgraphSection& section = find(name, type, columns);
  return {reinterpret_cast<const T*>(bytes_.data() + section.offset), section.size / sizeof(T)};
}

template std::span<const float> SectionTable::rows(const std::string&, std::uint64_t) const;
template std::span<const std::uint32_t> SectionTable::rows(const std::string&, std::uint64_t) const;
template std::span<const std::uint8_t> SectionTable::rows(const std::string&, std::uint64_t) const;

std::uint64_t SectionTable::columns(const std::string& name) const {
  const auto found = sections_.find(name);
  return found == sections_.end() || found->second.rank != 2 ? 0 : found->second.shape[1];
}

std::string_view SectionTable::text(const std::string& name) const {
  const QgraphSection& section = find(name, SectionType::u8, 1);
  return {reinterpret_cast<const char*>(bytes_.data() + section.offset), section.size};
}

}  // namespace quadgraph
