// The table of light kinds.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "engine/base/error.h"
#include "engine/render/light/lights.h"

namespace quadgraph {
namespace {

using Fields = std::vector<LightField>;

constexpr Range positive{.low = 0, .high = largest_power};
// Single precision cannot tell a narrower cone from its axis.
constexpr double least_angle = 0.1;

const LightField position_field{.name = "position",
                                .text = "X,Y,Z",
                                .form = FieldForm::point,
                                .member = &Light::position,
                                .unit = "mm",
                                .help = "position of the light"};
const LightField direction_field{.name = "direction",
                                 .text = "DX,DY,DZ",
                                 .form = FieldForm::direction,
                                 .member = &Light::direction,
                                 .unit = "",
                                 .help = "in which the light travels"};

LightField power(std::string_view name, std::string_view text, std::string_view unit, std::string_view help) {
  return {.name = name,
          .text = text,
          .form = FieldForm::power,
          .member = &Light::power,
          .unit = unit,
          .help = help,
          .range = positive};
}

LightField watts(std::string_view help) {
  return power("power", "POWER", "W", help);
}

LightField along(LightField field, std::string_view help) {
  field.help = help;
  return field;
}

LightField image(std::string_view help) {
  return {.name = "file", .text = "FILE", .form = FieldForm::file, .member = &Light::file, .unit = "", .help = help};
}

float itself(const Light&, float) {
  return 1;
}

float sphere(float distance) {
  return 4 * std::numbers::pi_v<float> * distance * distance;
}

LightForm directional() {
  return {.kind = LightKind::directional,
          .name = "directional",
          .help = "parallel light, like the sun's",
          .fields = {direction_field, power("irradiance", "IRRADIANCE", "W/mm^2", "on a plane that faces the light")},
          .image = LightImage::none,
          .power_over_irradiance = itself,
          .check = nullptr};
}

LightForm point() {
  return {.kind = LightKind::point,
          .name = "point",
          .help = "isotropic light from a point",
          .fields = {position_field,
                     watts("sent out in all directions: at the distance d the irradiance is power / (4 pi d^2)")},
          .image = LightImage::none,
          .power_over_irradiance = [](const Light&, float distance) { return sphere(distance); },
          .check = nullptr};
}

LightForm ambient() {
  return {.kind = LightKind::ambient,
          .name = "ambient",
          .help = "uniform light from all sides, where the body does not occlude it",
          .fields = {power("irradiance", "IRRADIANCE", "W/mm^2", "on a face that nothing occludes")},
          .image = LightImage::none,
          .power_over_irradiance = itself,
          .check = nullptr};
}

LightForm spot() {
  return {.kind = LightKind::spot,
          .name = "spot",
          .help = "a cone of light",
          .fields = {position_field,
                     along(direction_field, "axis of the cone"),
                     {.name = "angle",
                      .text = "ANGLE",
                      .form = FieldForm::number,
                      .member = &Light::angle,
                      .unit = "degrees",
                      .help = "half angle of the cone",
                      .range = {.low = least_angle, .high = 90}},
                     {.name = "edge",
                      .text = "EDGE",
                      .form = FieldForm::number,
                      .member = &Light::edge,
                      .unit = "",
                      .help = "share of the angle over which the light fades",
                      .optional = true,
                      .joined = true,
                      .range = {.low = 0, .high = 1}},
                     watts("in the whole cone")},
          .image = LightImage::none,
          .power_over_irradiance =
              [](const Light& light, float distance) {
                const SpotCosines cosines = spot_cosines(light);
                return 0.25f * sphere(distance) * (2 - cosines.inner - cosines.outer);
              },
          .check = nullptr};
}

void check_edges(const Light& light, const std::string& where) {
  const float area = glm::length(glm::cross(light.u, light.v));
  if (!(area > 0) || !std::isfinite(area)) {
    throw InputError(where + ": expected two finite edges that are not parallel");
  }
}

LightForm rectangle() {
  const LightField centre = along({.name = "centre",
                                   .text = "X,Y,Z",
                                   .form = FieldForm::point,
                                   .member = &Light::position,
                                   .unit = "mm",
                                   .help = ""},
                                  "centre of the rectangle");
  return {.kind = LightKind::rectangle,
          .name = "rectangle",
          .help = "a Lambertian rectangle of uniform radiance",
          .fields = {centre,
                     {.name = "u",
                      .text = "UX,UY,UZ",
                      .form = FieldForm::edge,
                      .member = &Light::u,
                      .unit = "mm",
                      .help = "one edge"},
                     {.name = "v",
                      .text = "VX,VY,VZ",
                      .form = FieldForm::edge,
                      .member = &Light::v,
                      .unit = "mm",
                      .help = "the other edge; it shines to where u x v points"},
                     watts("sent out from its one side, with the radiance power / (pi |u x v|)")},
          .image = LightImage::none,
          .power_over_irradiance = [](const Light&, float distance) { return 0.25f * sphere(distance); },
          .check = check_edges};
}

LightForm projector() {
  return {.kind = LightKind::projector,
          .name = "projector",
          .help = "an image projected onto planes perpendicular to the axis",
          .fields = {position_field,
                     along(direction_field, "to the middle of the image"),
                     {.name = "angle",
                      .text = "ANGLE",
                      .form = FieldForm::number,
                      .member = &Light::angle,
                      .unit = "degrees",
                      .help = "vertical angle of the image",
                      .range = {.low = least_angle, .high = 170, .below = true}},
                     {.name = "up",
                      .text = "UX,UY,UZ",
                      .form = FieldForm::top,
                      .member = &Light::up,
                      .unit = "",
                      .help = "direction to the top of the image",
                      .optional = true,
                      .joined = true},
                     image("PNG (decoded from sRGB), EXR or Radiance .hdr"),
                     watts("if the image is white all over")},
          .image = LightImage::projected,
          .power_over_irradiance =
              [](const Light& light, float distance) {  // of a square image
                const float side = 2 * distance * std::tan(0.5f * glm::radians(light.angle));
                return side * side;
              },
          .check = nullptr};
}

LightForm environment() {
  return {.kind = LightKind::environment,
          .name = "environment",
          .help =
              "an equirectangular environment map; at turn 0 its middle is behind the object as "
              "seen from azimuth 0",
          .fields = {image("EXR or Radiance .hdr; studio: soft-boxes in a grey room, built in"),
                     {.name = "turn",
                      .text = "TURN",
                      .form = FieldForm::turn,
                      .member = &Light::turn,
                      .unit = "degrees",
                      .help = "rotation about up, counter-clockwise seen from above",
                      .optional = true},
                     {.name = "up",
                      .text = "UP",
                      .form = FieldForm::axis,
                      .member = &Light::up,
                      .unit = "",
                      .help = "y or z, direction to the top row",
                      .optional = true,
                      .joined = true},
                     power("radiance", "RADIANCE", "W/(mm^2 sr)", "radiance of the value 1 in the image")},
          .image = LightImage::around,
          .power_over_irradiance = [](const Light&, float) { return 1 / std::numbers::pi_v<float>; },
          .check = nullptr};
}

}  // namespace

std::span<const LightForm> light_kinds() {
  static const std::vector<LightForm> all = {directional(), point(),     ambient(),    spot(),
                                             rectangle(),   projector(), environment()};
  return all;
}

const LightForm& form_of(LightKind kind) {
  const auto all = light_kinds();
  return *std::find_if(all.begin(), all.end(), [&](const LightForm& form) { return form.kind == kind; });
}

bool LightForm::has(FieldForm form) const {
  return std::any_of(fields.begin(), fields.end(), [&](const LightField& field) { return field.form == form; });
}

}  // namespace quadgraph
