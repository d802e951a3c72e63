#include "tools/layouts/layout.h"

#include <algorithm>
#include <bit>

#include "tools/layouts/factors.h"
#include "tools/layouts/units.h"

namespace quadgraph::layouts {
namespace {

using Words = std::vector<std::uint32_t>;

std::uint32_t word(double value) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

void append(Words& words, const glm::dvec3& v) {
  for (int c = 0; c < 3; ++c) words.push_back(word(v[c]));
}

void append(Words& words, const Block& block, Model model) {
  append(words, block.a11);
  if (model == Model::diffusion) return;
  append(words, block.a12);
  append(words, block.a22);
}

// What is stored of one entry; zero for padding.
struct Element {
  std::uint32_t column = 0;  // or its 16-bit code
  Block weight;
  Geometry geometry;
  Terms terms;
};

// Appends the words of one unit after another.
class Encoder {
 public:
  Encoder(Model model, const Layout& layout, const Factors& factors, Packed& packed)
      : model_(model), layout_(layout), factors_(factors), packed_(packed) {}

  void unit(std::span<const Element> e) {
    switch (layout_.entries) {
      case ENTRIES_RGB:
        packed_.column.push_back(columns(e));
        for (const Element& one : e) append(packed_.weight, one.weight, model_);
        return;
      case ENTRIES_RGB_WORDS:
        put(e[0].column);
        return append(packed_.weight, e[0].weight, model_);
      case ENTRIES_HALF:
        return half_pair(e);
      case ENTRIES_GEOMETRY:
        put(e[0].column);
        return append(packed_.weight, {e[0].geometry.g, e[0].geometry.m, e[0].geometry.b});
      case ENTRIES_MIXED:
        put(columns(e));
        for (const Element& one : e) put(word(one.geometry.g));
        for (const Element& one : e) put(half_masses(one));
        return;
      case ENTRIES_GEOMETRY_HALF:
        put(e[0].column | halves(0, factors_.g * e[0].geometry.g));
        return put(half_masses(e[0]));
      default:
        return stiffness_half(e[0]);
    }
  }

 private:
  void put(std::uint32_t value) { packed_.weight.push_back(value); }

  std::uint32_t columns(std::span<const Element> e) const {
    return e.size() == 1 ? e[0].column : e[0].column | e[1].column << 16;
  }

  std::uint32_t half_masses(const Element& e) const {
    return halves(factors_.m * e.geometry.m, factors_.b * e.geometry.b);
  }

  void half_pair(std::span<const Element> e) {
    if (layout_.columns == 16) {
      put(columns(e));
    } else {
      for (const Element& one : e) put(one.column);
    }
    std::vector<double> values;
    const auto add = [&](const glm::dvec3& v) {
      for (int c = 0; c < 3; ++c) values.push_back(factors_.weight[c] * v[c]);
    };
    for (const Element& one : e) {
      add(one.weight.a11);
      if (model_ == Model::diffusion) continue;
      add(one.weight.a12);
      add(one.weight.a22);
    }
    for (std::size_t k = 0; k < values.size(); k += 2) put(halves(values[k], values[k + 1]));
  }

  void stiffness_half(const Element& e) {
    append(packed_.weight, e.terms.stiffness);
    const glm::dvec3 a = factors_.absorption * e.terms.absorption, r = factors_.relaxation * e.terms.relaxation;
    put(halves(a.x, a.y));
    put(halves(a.z, r.x));
    put(halves(r.y, r.z));
    put(halves(factors_.b * e.geometry.b, 0) | e.column << 16);
  }

  Model model_;
  const Layout& layout_;
  const Factors& factors_;
  Packed& packed_;
};

void pack_offsets(const Layout& layout, const Units& units, std::span<const Bases> bases, Packed& packed) {
  if (layout.rows == ROWS_ELL) return;
  if (layout.columns == 32) {
    packed.offset = units.start;
    return;
  }
  for (std::size_t s = 0; s < bases.size(); ++s) {
    packed.offset.insert(packed.offset.end(), {units.start[s], bases[s].low, bases[s].high});
  }
  packed.offset.push_back(units.start.back());
}

void pack_units(const Matrix& matrix, const Layout& layout, const Units& units, std::span<const Bases> bases,
                Packed& packed) {
  const Factors factors = factors_of(matrix, layout);
  Encoder encoder(matrix.model, layout, factors, packed);
  std::vector<Element> unit(units.per);
  std::size_t slice = 0;
  for (std::size_t u = 0; u < units.row.size(); ++u) {
    while (u >= units.start[slice + 1]) ++slice;
    for (std::uint32_t k = 0; k < units.per; ++k) {
      const std::size_t place = u * units.per + k;
      const std::uint32_t e = units.entry[place], column = units.column(matrix.rows, place);
      unit[k] = e == no_entry ? Element{} : Element{0, matrix.rows.weight[e], matrix.geometry[e], matrix.terms[e]};
      unit[k].column = layout.columns == 16 ? bases[slice].code(column) : column;
    }
    encoder.unit(unit);
  }
  packed.width = units.width;
  packed.slots = units.entry.size();
}

// Sums of the rows and their diagonals: of geometry where a product makes blocks of it, else blocks.
void pack_rows(const Matrix& matrix, const Layout& layout, Packed& packed) {
  const bool edges = layout.coefficients == COEFFICIENTS_EDGE;
  const Rows averaged = edges ? edge_averaged(matrix, layout.coefficients_of(matrix)) : Rows{};
  const Rows& rows = edges ? averaged : matrix.rows;
  for (std::uint32_t i = 0; i < matrix.count(); ++i) {
    if (layout.geometric() && !edges) {
      Geometry sum = matrix.own[i];
      for (std::uint32_t e = rows.offset[i]; e < rows.offset[i + 1]; ++e) {
        sum.m += matrix.geometry[e].m;
        sum.b += matrix.geometry[e].b;
      }
      packed.row_sum.insert(packed.row_sum.end(), {word(sum.m), word(sum.b)});
      append(packed.diagonal, {matrix.own[i].g, matrix.own[i].m, matrix.own[i].b});
    } else {
      append(packed.row_sum, row_sum(rows, i), matrix.model);
      append(packed.diagonal, rows.diagonal[i], matrix.model);
    }
  }
}

void pack_coefficients(const Matrix& matrix, const Layout& layout, Packed& packed) {
  for (const Coefficients& c : layout.coefficients_of(matrix)) {
    append(packed.coefficients, c.kappa);
    append(packed.coefficients, c.sigma_a);
    if (matrix.model == Model::sp3) append(packed.coefficients, c.relaxation);
  }
}

gpu::LayoutConstants constants_of(const Matrix& matrix, const Layout& layout) {
  const Factors factors = factors_of(matrix, layout);
  const Coefficients& even = matrix.at_vertices.front();
  gpu::LayoutConstants constants{.kappa = even.kappa,
                                 .sigma_a = even.sigma_a,
                                 .relaxation = even.relaxation,
                                 .k11 = static_cast<float>(matrix.boundary.k11),
                                 .k12 = static_cast<float>(matrix.boundary.k12),
                                 .k22 = static_cast<float>(matrix.boundary.k22),
                                 .g = static_cast<float>(1 / factors.g),
                                 .m = static_cast<float>(1 / factors.m),
                                 .b = static_cast<float>(1 / factors.b),
                                 .weight = 1.0 / factors.weight};
  if (layout.entries == ENTRIES_STIFFNESS_HALF) {
    constants.sigma_a = glm::vec3(static_cast<float>(1 / factors.absorption));
    constants.relaxation = glm::vec3(static_cast<float>(1 / factors.relaxation));
  }
  return constants;
}

}  // namespace

std::uint32_t Layout::entries_per_unit() const {
  const bool pairs = columns == 16 && (entries == ENTRIES_RGB || entries == ENTRIES_MIXED);
  return pairs || entries == ENTRIES_HALF ? 2 : 1;
}

bool Layout::geometric() const {
  return entries == ENTRIES_GEOMETRY || entries == ENTRIES_MIXED || entries == ENTRIES_GEOMETRY_HALF;
}

std::uint64_t Packed::product_bytes() const {
  const std::size_t words =
      offset.size() + column.size() + weight.size() + row_sum.size() + order.size() + coefficients.size();
  return words * sizeof(std::uint32_t);
}

std::string refused(const Matrix& matrix, const Layout& layout) {
  if (layout.geometric() && layout.coefficients == COEFFICIENTS_EVEN && !matrix.even) {
    return "the material is not the same everywhere";
  }
  if (layout.entries == ENTRIES_STIFFNESS_HALF && matrix.model == Model::diffusion) {
    return "diffusion's entries hold stiffness and mass in one number";
  }
  if (layout.columns == 16) {
    for (const Bases& bases : bases_of(matrix.rows, units_of(matrix.rows, layout))) {
      if (!bases.fits) return "a slice has columns further apart than 16 bits reach";
    }
  }
  return {};
}

Packed pack(const Matrix& matrix, const Layout& layout) {
  Packed packed;
  const Units units = units_of(matrix.rows, layout);
  const std::vector<Bases> bases = layout.columns == 16 ? bases_of(matrix.rows, units) : std::vector<Bases>{};
  pack_offsets(layout, units, bases, packed);
  pack_units(matrix, layout, units, bases, packed);
  pack_rows(matrix, layout, packed);
  if (layout.window > 0) packed.order = units.order;
  if (layout.coefficients == COEFFICIENTS_EDGE) pack_coefficients(matrix, layout, packed);
  packed.constants = constants_of(matrix, layout);
  return packed;
}

}  // namespace quadgraph::layouts
