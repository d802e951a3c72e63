// Layers of edits, as of paint programs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/optics/edit.h"

namespace quadgraph {

inline constexpr std::size_t most_layers = 256, longest_layer_name = 64;  // of a scene; bytes

// Edits that are shown or hidden together. `opacity`: how much of what they do together is left, of 0 to 1: the
// coefficients are so far on the way from what is below to what the layer makes of it, however often its edits overlap.
struct EditLayer {
  std::string name;
  bool visible = true;
  float opacity = 1;
  std::vector<Edit> edits{};  // one after the other

  bool operator==(const EditLayer&) const = default;
};

// "Layer 3", for the third.
std::string layer_name(std::size_t number);

// Name and opacity. Throws InputError naming the field, what was found and what is allowed.
void check_layer(const EditLayer& layer);

// What a device applies, one edit after the other: those of the layers that are seen, the first layer first.
std::vector<Edit> applied_edits(std::span<const EditLayer> layers);

}  // namespace quadgraph
