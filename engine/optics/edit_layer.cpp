#include "engine/optics/edit_layer.h"

#include <algorithm>

#include "engine/base/error.h"

namespace quadgraph {

std::string layer_name(std::size_t number) {
  return "Layer " + std::to_string(number);
}

void check_layer(const EditLayer& layer) {
  const std::string& name = layer.name;
  if (name.empty() || name.size() > longest_layer_name) {
    throw InputError("name: found " + std::to_string(name.size()) + " bytes, allowed are 1 to " +
                     std::to_string(longest_layer_name));
  }
  const auto controls = [](char c) { return (c >= 0 && c < ' ') || c == 127; };
  if (std::ranges::any_of(name, controls)) {
    throw InputError("name: found a control character, allowed are letters, digits, spaces and signs");
  }
  if (!(layer.opacity >= 0 && layer.opacity <= 1)) {
    throw InputError("opacity: found " + std::to_string(layer.opacity) + ", allowed is 0 to 1");
  }
}

std::vector<Edit> applied_edits(std::span<const EditLayer> layers) {
  std::vector<Edit> applied;
  for (const EditLayer& layer : layers) {
    if (!layer.visible || layer.opacity == 0 || layer.edits.empty()) continue;
    const std::size_t first = applied.size();
    applied.insert(applied.end(), layer.edits.begin(), layer.edits.end());
    for (std::size_t i = first + 1; i < applied.size(); ++i) applied[i].joins = true;
    applied.back().opacity = layer.opacity;
  }
  return applied;
}

}  // namespace quadgraph
