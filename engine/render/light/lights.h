// Lights: what a user states, in physical units. The table `light_kinds` says all there is to say of a kind but how
// its light travels (engine/render/light/light_set.h) and is spread (shaders/light/light_kinds.h): texts, scene files,
// checks, help, the window, Python, docs/scene.schema.json and the tables of docs/lights.md follow from it.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/base/names.h"
#include "engine/base/range.h"

namespace quadgraph {

enum class LightKind { directional, point, ambient, spot, rectangle, projector, environment };

// What single precision has room for, squared and summed over a surface: of a power or its like, and of a place or
// edge.
inline constexpr float largest_power = 1e15f;
inline constexpr float largest_length = 1e9f;  // mm

// Of a scene; their shadow maps share 512 MiB.
inline constexpr std::size_t most_lights = 1024;

// Members that a kind does not name are not used.
struct Light {
  LightKind kind = LightKind::directional;
  glm::vec3 direction{0, 0, -1};     // unit, the way the light travels, along the axis
  glm::vec3 position{0};             // mm; of a rectangle its centre
  glm::vec3 power{0};                // of the quantity that the kind's last field names; >= 0
  float angle = 30;                  // degrees
  float edge = 0.2f;                 // share of the angle
  glm::vec3 u{1, 0, 0}, v{0, 1, 0};  // edges, mm
  glm::vec3 up{0, 1, 0};             // to where the top of an image lies
  std::string file{};                // image: .png, .exr or .hdr
  float turn = 0;                    // degrees

  bool operator==(const Light&) const = default;
};

// How a field of a light is written, checked and turned.
enum class FieldForm {
  direction,  // a vector of any length but 0, kept at unit length
  point,      // mm
  edge,       // a vector, mm
  top,        // a vector, not along the direction
  axis,       // y or z
  number,     // in the field's range
  turn,       // degrees about the axis
  file,       // a name without ':'
  power,      // >= 0, one number or R/G/B
};

template <>
struct Names<FieldForm> {
  static constexpr std::string_view what = "form";
  static constexpr auto values =
      std::to_array<Named<FieldForm>>({{FieldForm::direction, "direction", "a vector of any length but 0"},
                                       {FieldForm::point, "point", "three coordinates"},
                                       {FieldForm::edge, "edge", "a vector"},
                                       {FieldForm::top, "top", "a vector that is not along the direction"},
                                       {FieldForm::axis, "axis", "y or z"},
                                       {FieldForm::number, "number", "a number in its range"},
                                       {FieldForm::turn, "turn", "an angle about the axis"},
                                       {FieldForm::file, "file", "the name of an image"},
                                       {FieldForm::power, "power", "one number or R/G/B"}});
};

struct LightField {
  std::string_view name;  // in a scene file
  std::string_view text;  // what stands for it in the form of `parse_light`
  FieldForm form;
  std::variant<glm::vec3 Light::*, float Light::*, std::string Light::*> member;
  std::string_view unit, help;
  bool optional = false;  // may be left out of a scene file
  bool joined = false;    // in a text it may follow the field before, after a comma
  Range range{};
};

enum class LightImage { none, projected, around };

struct LightForm {
  LightKind kind;
  std::string_view name, help;
  std::vector<LightField> fields;  // in the order of a text; the last one is the power
  LightImage image;
  // Power over the irradiance, mm^2 or sr, that it causes at that distance, mm, on a plane that faces the light.
  float (*power_over_irradiance)(const Light& light, float distance);
  // Throws InputError, beginning with `where`, for what no field alone tells; may be null.
  void (*check)(const Light& light, const std::string& where);

  bool has(FieldForm form) const;
};

// All kinds, in the order in which they are offered.
std::span<const LightForm> light_kinds();
const LightForm& form_of(LightKind kind);

// "spot:X,Y,Z:DX,DY,DZ:ANGLE[,EDGE]:POWER": what parse_light reads for a kind.
std::string text_form(const LightForm& form);

// What an optional field has where nobody says it, as parse_light reads it; empty for one that is required.
std::string default_text(const LightField& field);

// The text forms of all light kinds with their help, for --help.
const std::string& light_forms();

// Parses one of the text forms; the power is one number or R/G/B. A direction need not be of unit length. Throws
// InputError naming what was found and what is allowed.
Light parse_light(std::string_view text);

// The text that parse_light reads back as the same light.
std::string to_string(const Light& light);

// Throws InputError unless the numbers are finite and in their ranges, the power is >= 0 and a direction has unit
// length.
void check_light(const Light& light);

// Throws InputError unless there are at most most_lights.
void check_light_count(std::size_t count);

// Whether it shines from a place: `position` counts.
bool has_position(const Light& light);

// Whether it comes from all around, less what the body hides: `ambient` and `environment`.
bool from_all_around(const Light& light);

// Cosines of the angles from its axis at which a spot light begins to fade and ends. In between its intensity is
// s^2 (3 - 2 s) of that on the axis, s linear in the cosine.
struct SpotCosines {
  float inner = 1, outer = 0;
};
SpotCosines spot_cosines(const Light& spot);

// W/sr, on the axis of a spot light: power / (pi (2 - inner - outer)), as half of the fading part counts.
glm::vec3 axis_intensity(const Light& spot);

}  // namespace quadgraph
