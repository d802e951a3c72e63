// In which order a layout stores the rows of an operator and their entries, and its 16-bit columns.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/layouts/layout.h"

namespace quadgraph::layouts {

inline constexpr std::uint32_t no_entry = UINT32_MAX;

// Units in order of storage. A unit is one entry, or two of one row.
struct Units {
  std::uint32_t per = 1;             // entries of a unit
  std::uint32_t width = 0;           // units of the longest row
  std::vector<std::uint32_t> order;  // row of every slot
  std::vector<std::uint32_t> row;    // of every unit
  std::vector<std::uint32_t> entry;  // `per` for every unit; no_entry: padding
  std::vector<std::uint32_t> start;  // slices + 1, CSR: rows + 1

  // Column of entry[place]; padding names its own row.
  std::uint32_t column(const Rows& rows, std::size_t place) const {
    return entry[place] == no_entry ? row[place / per] : rows.column[entry[place]];
  }
};

Units units_of(const Rows& rows, const Layout& layout);

// The columns of a slice as two ranges of at most 32768, split at the widest gap.
struct Bases {
  std::uint32_t low = 0, high = 0;
  bool fits = true;

  std::uint32_t code(std::uint32_t column) const { return column < high ? column - low : 0x8000u + column - high; }
};

// The columns' ranges of every slice.
std::vector<Bases> bases_of(const Rows& rows, const Units& units);

}  // namespace quadgraph::layouts
