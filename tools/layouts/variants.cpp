#include "tools/layouts/variants.h"

namespace quadgraph::layouts {
namespace {

Layout sliced(std::uint32_t slice, std::uint32_t window = 0) {
  return {.slice = slice, .window = window};
}

Layout entries(int kind, int columns = 32, int coefficients = COEFFICIENTS_EVEN, std::uint32_t window = 0) {
  return {.window = window, .entries = kind, .columns = columns, .coefficients = coefficients};
}

void add_rows(std::vector<Variant>& all) {
  const auto add = [&](const char* name, const char* kernel, const Layout& layout, bool subgroups = false) {
    all.push_back({"rows", name, kernel, Operation::product, layout, subgroups});
  };
  add("sliced ELL 32 (present)", "product", present);
  add("CSR, an invocation a row", "product_csr", {.rows = ROWS_CSR});
  add("CSR, a subgroup a row", "product_csr_subgroup", {.rows = ROWS_CSR_SUBGROUP}, true);
  add("ELL", "product_ell", {.rows = ROWS_ELL});
  add("sliced ELL 8", "product_slice8", sliced(8));
  add("sliced ELL 64", "product_slice64", sliced(64));
  add("sliced ELL 32, sorted in 256", "product_sorted", sliced(32, 256));
  add("sliced ELL 32, sorted in 1024", "product_sorted", sliced(32, 1024));
}

void add_entries(std::vector<Variant>& all) {
  const auto add = [&](const char* name, const char* kernel, const Layout& layout) {
    all.push_back({"entries", name, kernel, Operation::product, layout, false});
  };
  add("RGB, column beside the block", "product_words", entries(ENTRIES_RGB_WORDS));
  add("RGB, 16-bit columns", "product_c16", entries(ENTRIES_RGB, 16));
  add("half RGB", "product_half", entries(ENTRIES_HALF));
  add("half RGB, 16-bit columns", "product_half_c16", entries(ENTRIES_HALF, 16));
  add("half RGB, 16-bit columns, sorted", "product_half_c16_sorted", entries(ENTRIES_HALF, 16, COEFFICIENTS_EVEN, 256));
  add("geometry", "product_geometry", entries(ENTRIES_GEOMETRY));
  add("geometry, half masses", "product_mixed", entries(ENTRIES_MIXED));
  add("geometry, half masses, 16-bit columns", "product_mixed_c16", entries(ENTRIES_MIXED, 16));
  add("geometry, half masses, 16-bit columns, sorted", "product_mixed_c16_sorted",
      entries(ENTRIES_MIXED, 16, COEFFICIENTS_EVEN, 256));
  add("geometry, all half, 16-bit columns", "product_geometry_half", entries(ENTRIES_GEOMETRY_HALF, 16));
  add("geometry, all half, 16-bit columns, sorted", "product_geometry_half_sorted",
      entries(ENTRIES_GEOMETRY_HALF, 16, COEFFICIENTS_EVEN, 256));
  add("geometry, edge means", "product_edge", entries(ENTRIES_GEOMETRY, 32, COEFFICIENTS_EDGE));
  Layout vertices = entries(ENTRIES_GEOMETRY, 32, COEFFICIENTS_EDGE);
  vertices.at_vertices = true;
  add("geometry, edge means of the material at vertices", "product_edge", vertices);
  add("geometry, half masses, edge means", "product_edge_mixed", entries(ENTRIES_MIXED, 32, COEFFICIENTS_EDGE));
  add("geometry, half masses, 16-bit columns, sorted, edge means", "product_edge_mixed_c16_sorted",
      entries(ENTRIES_MIXED, 16, COEFFICIENTS_EDGE, 256));
  add("RGB stiffness, half masses, 16-bit columns, sorted", "product_stiffness_half_sorted",
      entries(ENTRIES_STIFFNESS_HALF, 16, COEFFICIENTS_EVEN, 256));
}

void add_vectors(std::vector<Variant>& all) {
  const auto add = [&](const char* name, const char* kernel, int vectors) {
    all.push_back({"vectors", name, kernel, Operation::product, {.vectors = vectors}, false});
  };
  add("16 bytes an RGB value", "product_wide", VECTORS_WIDE);
  add("three planes", "product_planes", VECTORS_PLANES);
}

void add_reductions(std::vector<Variant>& all) {
  const auto add = [&](const char* name, const char* kernel, Operation operation, bool subgroups) {
    all.push_back({"reductions", name, kernel, operation, present, subgroups});
  };
  add("shared memory, last workgroup (present)", "product_ticket", Operation::product_dot, false);
  add("subgroups, last workgroup", "product_subgroup", Operation::product_dot, true);
  add("subgroups, second dispatch", "product_partials", Operation::product_then_dot, true);
}

void add_smoothers(std::vector<Variant>& all) {
  const auto add = [&](const char* group, const char* name, const char* kernel, Operation operation,
                       const Layout& layout = present) {
    all.push_back({group, name, kernel, operation, layout, false});
  };
  add("smoothing", "residual, then update", "residual", Operation::residual_update);
  add("smoothing", "one dispatch", "smooth", Operation::smooth);
  add("smoothing", "one dispatch, sorted", "smooth_sorted", Operation::smooth, sliced(32, 256));
  add("smoothing", "one dispatch, half vectors", "smooth_half_vectors", Operation::smooth, {.vectors = VECTORS_HALF});
  add("smoothing", "one dispatch, half RGB, 16-bit columns, sorted", "smooth_half_c16_sorted", Operation::smooth,
      entries(ENTRIES_HALF, 16, COEFFICIENTS_EVEN, 256));
  Layout half = entries(ENTRIES_HALF, 16, COEFFICIENTS_EVEN, 256);
  half.vectors = VECTORS_HALF;
  add("smoothing", "one dispatch, half RGB, 16-bit columns, sorted, half vectors",
      "smooth_half_c16_sorted_half_vectors", Operation::smooth, half);
  add("smoothing", "one dispatch, geometry, half masses, 16-bit columns, sorted", "smooth_mixed_c16_sorted",
      Operation::smooth, entries(ENTRIES_MIXED, 16, COEFFICIENTS_EVEN, 256));
  add("two from zero", "two dispatches", "smooth", Operation::start_smooth);
  add("two from zero", "one dispatch, first step found again at the neighbours", "smooth_zero", Operation::smooth_zero);
}

}  // namespace

std::vector<Variant> all_variants() {
  std::vector<Variant> all;
  add_rows(all);
  add_entries(all);
  add_vectors(all);
  add_reductions(all);
  add_smoothers(all);
  return all;
}

}  // namespace quadgraph::layouts
