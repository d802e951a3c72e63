// The light of what nobody lit, and lights that have a name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/scene.h"

namespace quadgraph {

// The name that stands for default_lights.
inline constexpr std::string_view lamps_name = "lamps";

// Lights by their texts, as parse_light reads them; but the studio by its name alone stands behind the body as `view`
// sees it, and "lamps" are the default_lights of that view. Throws InputError.
std::vector<Light> named_lights(const std::vector<std::string>& texts, const View& view);

// What somebody has said of a scene.
struct SaidOfLight {
  bool lights = false, ground = false;
};

// What a picture shows where neither a scene file nor a command line says it: without lights the studio, behind the
// body as `first` sees it, the first view of the scene; and on the ground, unless something is said of that. A scene
// whose lights are said has no ground of itself.
void light_unlit(Scene& scene, const View& first, const SaidOfLight& said);

}  // namespace quadgraph
