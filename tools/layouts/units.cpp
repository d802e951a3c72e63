#include "tools/layouts/units.h"

#include <algorithm>
#include <numeric>

namespace quadgraph::layouts {
namespace {

using Words = std::vector<std::uint32_t>;

Words stored_order(const Rows& rows, std::uint32_t window) {
  Words order(rows.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto longer = [&](std::uint32_t a, std::uint32_t b) {
    return rows.offset[a + 1] - rows.offset[a] > rows.offset[b + 1] - rows.offset[b];
  };
  for (std::size_t first = 0; window > 0 && first < order.size(); first += window) {
    const auto last = std::min(first + window, order.size());
    std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(first),
                     order.begin() + static_cast<std::ptrdiff_t>(last), longer);
  }
  return order;
}

// Rows of slots first ... first + slice, interleaved; slots beyond the last are padding, left out if there is only one
// slice.
void append_slice(const Rows& rows, std::size_t first, std::size_t slice, Units& units) {
  const auto last = std::min(first + slice, units.order.size());
  std::uint32_t width = 0;
  for (std::size_t s = first; s < last; ++s) {
    const std::uint32_t i = units.order[s];
    width = std::max(width, (rows.offset[i + 1] - rows.offset[i] + units.per - 1) / units.per);
  }
  units.width = std::max(units.width, width);
  for (std::uint32_t k = 0; k < width; ++k) {
    for (std::size_t s = first; s < first + slice; ++s) {
      const std::uint32_t i = units.order[std::min(s, last - 1)];
      units.row.push_back(i);
      for (std::uint32_t e = rows.offset[i] + k * units.per; e < rows.offset[i] + (k + 1) * units.per; ++e) {
        units.entry.push_back(s < last && e < rows.offset[i + 1] ? e : no_entry);
      }
    }
  }
}

Bases split(Words columns) {
  if (columns.empty()) return {};
  std::sort(columns.begin(), columns.end());
  std::size_t gap = 0;
  for (std::size_t k = 1; k < columns.size(); ++k) {
    if (gap == 0 || columns[k] - columns[k - 1] > columns[gap] - columns[gap - 1]) gap = k;
  }
  if (gap == 0) return {columns[0], columns[0] + 1, true};
  const Bases bases{columns[0], columns[gap], true};
  return {bases.low, bases.high, columns[gap - 1] - bases.low < 0x8000u && columns.back() - bases.high < 0x8000u};
}

}  // namespace

Units units_of(const Rows& rows, const Layout& layout) {
  Units units;
  units.per = layout.entries_per_unit();
  units.order = stored_order(rows, layout.window);
  // CSR has slices of one row, ELL is one slice.
  std::size_t slice = layout.slice;
  if (layout.rows == ROWS_CSR || layout.rows == ROWS_CSR_SUBGROUP) slice = 1;
  if (layout.rows == ROWS_ELL) slice = rows.size();
  units.start.push_back(0);
  for (std::size_t first = 0; first < rows.size(); first += slice) {
    append_slice(rows, first, slice, units);
    units.start.push_back(static_cast<std::uint32_t>(units.row.size()));
  }
  return units;
}

std::vector<Bases> bases_of(const Rows& rows, const Units& units) {
  std::vector<Bases> bases;
  for (std::size_t s = 0; s + 1 < units.start.size(); ++s) {
    Words columns;
    for (std::size_t p = std::size_t{units.start[s]} * units.per; p < std::size_t{units.start[s + 1]} * units.per;
         ++p) {
      columns.push_back(units.column(rows, p));
    }
    bases.push_back(split(std::move(columns)));
  }
  return bases;
}

}  // namespace quadgraph::layouts
