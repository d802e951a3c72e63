// Lights: what a user states, in physical units.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <string_view>

namespace quadgraph {

enum class LightKind { directional, point, ambient };

struct Light {
  LightKind kind = LightKind::directional;
  glm::vec3 direction{0, 0, -1};  // directional: unit, the way the light travels
  glm::vec3 position{0};          // point: mm
  // Directional: irradiance on a plane perpendicular to the light, W/mm^2. Point: power, W, sent out evenly in all
  // directions, so that the irradiance facing it at distance d is power / (4 pi d^2). Ambient: irradiance, W/mm^2, of
  // light that comes evenly from all sides; where the file says what the faces see, from where the body does not hide
  // it.
  glm::vec3 power{0};

  bool operator==(const Light&) const = default;
};

// Parses "directional:DX,DY,DZ:IRRADIANCE", "point:X,Y,Z:POWER" or "ambient:IRRADIANCE", the last one number or R/G/B.
// The direction need not be of unit length. Throws InputError naming what was found and what is allowed.
Light parse_light(std::string_view text);

// The text that parse_light reads back as the same light.
std::string to_string(const Light& light);

// Throws InputError unless the numbers are finite, the power is >= 0 and a direction has unit length.
void check_light(const Light& light);

}  // namespace quadgraph
