// How much of the sky the faces of every level see, from the one level that knows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/file/graph.h"

namespace quadgraph {

// The faces of a level as weighted sums of those of a neighbour: entries offset[f] to offset[f + 1] of face f, which
// sees all of the sky where there are none.
struct SkyRows {
  std::vector<std::uint32_t> offset, index;
  std::vector<float> weight;
};

// Of a level, from the next coarser one.
SkyRows finer_sky_rows(const Level& level);

// Of `coarse`, from the next finer level: by area and weight.
SkyRows coarser_sky_rows(const Level& level, const Level& coarse);

// Share of the cosine-weighted directions that meet no other part of the body, per outside face of every level. `sky`
// is that of level `known`; finer levels get it by their surface transfers, coarser ones as the mean over the finer
// faces that take from theirs, by area and weight, 1 where none does.
std::vector<std::vector<float>> sky_of_levels(std::span<const Level> levels, std::uint32_t known,
                                              std::span<const float> sky);

// Shares of the sky from the level that has Level::seen; all 1 without one.
std::vector<std::vector<float>> sky_of_levels(std::span<const Level> levels);

}  // namespace quadgraph
