// Lights: what a user states, in physical units.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <string_view>

namespace quadgraph {

enum class LightKind { directional, point, ambient, spot, rectangle, projector, environment };

struct Light {
  LightKind kind = LightKind::directional;
  glm::vec3 direction{0, 0, -1};  // directional, spot, projector: unit, the way the light travels, along the axis
  glm::vec3 position{0};          // point, spot, projector: mm; rectangle: its centre
  // Directional: irradiance on a plane perpendicular to the light, W/mm^2. Point: power, W, sent out evenly in all
  // directions, so that the irradiance facing it at distance d is power / (4 pi d^2). Ambient: irradiance, W/mm^2, of
  // light that comes evenly from all sides; where the file says what the faces see, from where the body does not hide
  // it. Spot: power, W, sent out in the cone (axis_intensity). Rectangle: power, W, sent out from its one side, with
  // the same radiance power / (pi |u x v|) everywhere and in all directions.
  // Projector: power, W, sent out if the image is white (1) all over; a plane across the axis is lit as the image is.
  // Environment: radiance of a texel of 1, W/(mm^2 sr).
  glm::vec3 power{0};
  float angle = 30;   // degrees; spot: from the axis to where the light ends, above 0, at most 90; projector: height of
                      // the image as seen from there, above 0, below 170
  float edge = 0.2f;  // spot: share of the angle over which it fades, 0 to 1
  glm::vec3 u{1, 0, 0}, v{0, 1, 0};  // rectangle: its edges, mm; it shines to where u x v points
  glm::vec3 up{0, 1, 0};             // projector: to where the image's top lies; not along its direction;
  // environment: unit y or z, to where the top row lies
  std::string file{};  // projector, environment: its image, .png, .exr or .hdr
  // Environment: counter-clockwise seen from above, degrees. At 0 the middle of the image lies at -z, or for up z at y:
  // behind the object as seen from azimuth 0; what is on the right of the image lies to the right of that.
  float turn = 0;

  bool operator==(const Light&) const = default;
};

// What parse_light reads, for help and errors.
extern const char* const light_forms;

// Parses "directional:DX,DY,DZ:IRRADIANCE", "point:X,Y,Z:POWER", "ambient:IRRADIANCE",
// "spot:X,Y,Z:DX,DY,DZ:ANGLE[,EDGE]:POWER", "rectangle:X,Y,Z:UX,UY,UZ:VX,VY,VZ:POWER",
// "projector:X,Y,Z:DX,DY,DZ:ANGLE[,UX,UY,UZ]:FILE:POWER" or "environment:FILE:TURN[,UP]:RADIANCE", the last one number
// or R/G/B. A direction need not be of unit length. Throws InputError naming what was found and what is allowed.
Light parse_light(std::string_view text);

// The text that parse_light reads back as the same light.
std::string to_string(const Light& light);

// Throws InputError unless the numbers are finite and in their ranges, the power is >= 0 and a direction has unit
// length.
void check_light(const Light& light);

// Cosines of the angles from its axis at which a spot light begins to fade and ends. In between its intensity is
// s^2 (3 - 2 s) of that on the axis, s linear in the cosine.
struct SpotCosines {
  float inner = 1, outer = 0;
};
SpotCosines spot_cosines(const Light& spot);

// W/sr, on the axis of a spot light: power / (pi (2 - inner - outer)), as half of the fading part counts.
glm::vec3 axis_intensity(const Light& spot);

}  // namespace quadgraph
