#include "engine/scene/layers.h"

#include <algorithm>
#include <utility>

namespace quadgraph {
namespace {

// "Layer 3", of the third; with the next number that no layer has in its name.
std::string fresh_name(const Scene& scene) {
  const auto taken = [&](const std::string& name) {
    return std::ranges::any_of(scene.layers, [&](const EditLayer& layer) { return layer.name == name; });
  };
  std::size_t number = scene.layers.size() + 1;
  while (taken(layer_name(number))) ++number;
  return layer_name(number);
}

}  // namespace

void add_layer(Scene& scene, std::size_t& active) {
  auto& layers = scene.layers;
  if (layers.size() >= most_layers) return;
  active = layers.empty() ? 0 : std::min(active + 1, layers.size());
  layers.insert(layers.begin() + static_cast<std::ptrdiff_t>(active), EditLayer{.name = fresh_name(scene)});
}

void remove_layer(Scene& scene, std::size_t& active) {
  if (active >= scene.layers.size()) return;
  scene.layers.erase(scene.layers.begin() + static_cast<std::ptrdiff_t>(active));
  active = active > 0 ? active - 1 : 0;
}

void move_layer(Scene& scene, std::size_t& active, bool up) {
  auto& layers = scene.layers;
  const std::size_t other = up ? active + 1 : active - 1;  // wraps around where there is none below
  if (active >= layers.size() || other >= layers.size()) return;
  std::swap(layers[active], layers[other]);
  active = other;
}

std::size_t topmost(const Scene& scene) {
  return scene.layers.empty() ? 0 : scene.layers.size() - 1;
}

void keep_active(const Scene& scene, std::size_t& active) {
  active = std::min(active, topmost(scene));
}

}  // namespace quadgraph
