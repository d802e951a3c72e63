// One way to keep the operator on the device, and its words.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/layouts/matrix.h"
#include "tools/layouts/shaders/layout_shared.h"

namespace quadgraph::layouts {

// The names are those of tools/layouts/shaders/layout_shared.h.
struct Layout {
  int rows = ROWS_SLICED;
  std::uint32_t slice = 32;  // rows
  std::uint32_t window = 0;  // rows within which rows are sorted by length; 0: not sorted
  int entries = ENTRIES_RGB;
  int columns = 32;  // bits
  int coefficients = COEFFICIENTS_EVEN;
  bool at_vertices = false;  // COEFFICIENTS_EDGE: those of the material at the vertices, not the means over their tets
  int vectors = VECTORS_PACKED;

  auto operator<=>(const Layout&) const = default;

  std::uint32_t entries_per_unit() const;
  bool geometric() const;  // entries are made of geometry and coefficients

  std::span<const Coefficients> coefficients_of(const Matrix& matrix) const {
    return at_vertices ? matrix.at_vertices : matrix.tet_means;
  }
};

struct Packed {
  std::vector<std::uint32_t> offset, column, weight, row_sum, diagonal, order, coefficients;
  gpu::LayoutConstants constants{};
  std::uint32_t width = 0;  // ELL: units of a row
  std::uint64_t slots = 0;  // entries stored, padding included

  // Read by one product, vectors left out.
  std::uint64_t product_bytes() const;
  std::uint64_t diagonal_bytes() const { return diagonal.size() * sizeof(std::uint32_t); }
};

// Why `matrix` cannot be kept so; empty if it can.
std::string refused(const Matrix& matrix, const Layout& layout);

Packed pack(const Matrix& matrix, const Layout& layout);

// The operator that the words stand for, its sums of rows in double precision: what a kernel without rounding of its
// own would multiply with.
Rows represented(const Matrix& matrix, const Layout& layout);

// Fields as words, and back.
std::vector<std::uint32_t> pack_fields(std::span<const Field> fields, Model model, int vectors);
std::vector<Field> unpack_fields(std::span<const std::uint32_t> words, std::size_t count, Model model, int vectors);

std::uint64_t field_bytes(Model model, int vectors);

}  // namespace quadgraph::layouts
