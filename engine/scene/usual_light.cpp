#include "engine/scene/usual_light.h"

#include "engine/render/light/default_lights.h"
#include "engine/render/light/studio.h"

namespace quadgraph {

std::vector<Light> named_lights(const std::vector<std::string>& texts, const View& view) {
  std::vector<Light> lights;
  for (const std::string& text : texts) {
    if (text == lamps_name) {
      const std::vector<Light> lamps = default_lights(view);
      lights.insert(lights.end(), lamps.begin(), lamps.end());
    } else {
      lights.push_back(text == studio_name ? studio_of(view) : parse_light(text));
    }
  }
  return lights;
}

void light_unlit(Scene& scene, const View& first, const SaidOfLight& said) {
  if (said.lights) return;
  scene.lights = {studio_of(first)};
  if (!said.ground) scene.render.ground = true;
}

}  // namespace quadgraph
