// The entries of an operator as they lie on the device, for the CPU: packed (shaders/solver/packing.h), or plain where
// packing would round too much.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/listener.h"
#include "engine/base/solve_options.h"
#include "engine/reference/block.h"
#include "engine/reference/operator.h"

namespace quadgraph {

// ENTRIES_* of shaders/solver/packing.h.
enum class EntryFormat : std::uint32_t { packed, plain };

// The format for the rows of a level in its present shape. The methods on the graph, the published ones, are stored as
// published. Rounding shifts the fluxes between the vertices of an element by a share of its largest entry, which may
// be as much as all that holds the shape of the solution there: so fem rows are plain if a vertex has an entry above
// 1000 times what a well-shaped element of its size has, or more than a hundredth of the vertices lie in elements of
// which rounding changes the conduction by about as much as it is (long needles, layers of flat tets), or if the
// conduction of all elements together, over their volume, is above 25: cubes cut into six have 10, baked meshes 15 to
// 22, where the exitance changes by less than 1e-4, slivers of 1 degree all through 30 (2e-4), of 0.1 degrees 160
// (3e-3).
EntryFormat format_of(const Level& level, Method method, const Listener& listener = {});

// 32-bit words of an entry.
constexpr std::uint32_t stored_words(Model model, EntryFormat format) {
  if (format == EntryFormat::plain) return model == Model::sp3 ? 10 : 4;
  return model == Model::sp3 ? 4 : 2;
}

// Entries of these columns, all of them 0.
std::vector<std::uint32_t> stored_columns(std::span<const std::uint32_t> columns, Model model, EntryFormat format);

// Replaces the weight of entry `e`.
void store_weight(std::span<std::uint32_t> words, std::size_t e, const Block& weight, Model model, EntryFormat format);

struct StoredEntry {
  std::uint32_t column = 0;
  Block weight;
};

// What entry `e` of `words` says.
StoredEntry stored_entry(std::span<const std::uint32_t> words, std::size_t e, Model model, EntryFormat format);

// `rows` with entries rounded as packed ones are; the sums of rows stay what they are.
Rows as_packed(Rows rows, Model model);

}  // namespace quadgraph
