// The outer shell of a .qgraph file: header, section table, padding and checksums, but not what the sections mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/file/qgraph_layout.h"

namespace quadgraph {

// Throws FormatError("<file>: <section>: <rule>").
[[noreturn]] void fail_format(const std::string& file, std::string_view section, const std::string& rule);

// The header of a file of `file_size` bytes from its first bytes, every rule checked. Throws FormatError naming `file`.
QgraphHeader checked_header(std::span<const std::byte> first_bytes, std::uint64_t file_size, const std::string& file);

class SectionTable {
 public:
  // Checks header, table, offsets, padding and every CRC-32 of `bytes` before anything is allocated that depends on a
  // claimed size. `bytes` must be 64-byte aligned and outlive the table. Throws FormatError naming `file`.
  SectionTable(std::span<const std::byte> bytes, const std::string& file);

  const std::string& file() const { return file_; }
  bool has(const std::string& name) const { return sections_.count(name) > 0; }
  const std::vector<std::string>& names() const { return names_; }  // in file order

  // The section as rows of `columns` values of T (u8, u32 or f32; columns 1: rank 1). Throws FormatError if it is
  // missing or of another type or shape.
  template <typename T>
  std::span<const T> rows(const std::string& name, std::uint64_t columns) const;

  // Columns of a section of rank 2; 0 where it is missing or of rank 1.
  std::uint64_t columns(const std::string& name) const;

  std::string_view text(const std::string& name) const;

 private:
  const QgraphSection& find(const std::string& name, SectionType type, std::uint64_t columns) const;
  void read_header();
  void read_entries(std::uint32_t count);
  void check_entry(const QgraphSection& section, const std::string& name, std::uint64_t expected_offset) const;
  void check_padding(std::uint64_t begin, std::uint64_t end) const;

  std::span<const std::byte> bytes_;
  std::string file_;
  std::vector<std::string> names_;
  std::map<std::string, QgraphSection> sections_;
};

}  // namespace quadgraph
