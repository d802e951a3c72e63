// Lights as text.
#include <glm/geometric.hpp>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/render/light/lights.h"

namespace quadgraph {
namespace {

using Parts = std::vector<std::string_view>;

// One kind of light as text: NAME, then `parts` more between colons, the power last.
struct Form {
  std::string_view name;
  LightKind kind;
  std::size_t parts;
  void (*read)(const Parts& parts, const std::string& where, Light& light);
  std::string (*write)(const Light& light);
};

glm::vec3 parse_direction(std::string_view text, const std::string& field) {
  const glm::dvec3 direction(parse_triple(text, ',', field));
  const double length = glm::length(direction);
  if (length == 0) throw InputError(field + ": found length 0, expected a direction");
  return glm::vec3(direction / length);
}

void read_directional(const Parts& parts, const std::string& where, Light& light) {
  light.direction = parse_direction(parts[1], where + ", direction");
}

std::string write_directional(const Light& light) {
  return triple_text(light.direction, ',') + ":";
}

void read_point(const Parts& parts, const std::string& where, Light& light) {
  light.position = parse_triple(parts[1], ',', where + ", position");
}

std::string write_point(const Light& light) {
  return triple_text(light.position, ',') + ":";
}

void read_ambient(const Parts&, const std::string&, Light&) {}

std::string write_ambient(const Light&) {
  return "";
}

void read_spot(const Parts& parts, const std::string& where, Light& light) {
  read_point(parts, where, light);
  light.direction = parse_direction(parts[2], where + ", direction");
  const auto numbers = split(parts[3], ',');
  if (numbers.size() > 2)
    throw InputError(where + ", angle: found '" + std::string(parts[3]) + "', expected ANGLE,EDGE");
  light.angle = static_cast<float>(parse_number(numbers[0], where + ", angle"));
  if (numbers.size() > 1) light.edge = static_cast<float>(parse_number(numbers[1], where + ", edge"));
}

std::string write_spot(const Light& light) {
  return write_point(light) + write_directional(light) + number_text(light.angle) + "," + number_text(light.edge) + ":";
}

void read_rectangle(const Parts& parts, const std::string& where, Light& light) {
  read_point(parts, where, light);
  light.u = parse_triple(parts[2], ',', where + ", first edge");
  light.v = parse_triple(parts[3], ',', where + ", second edge");
}

std::string write_rectangle(const Light& light) {
  return write_point(light) + triple_text(light.u, ',') + ":" + triple_text(light.v, ',') + ":";
}

void read_projector(const Parts& parts, const std::string& where, Light& light) {
  read_point(parts, where, light);
  light.direction = parse_direction(parts[2], where + ", direction");
  const auto comma = parts[3].find(',');
  light.angle = static_cast<float>(parse_number(parts[3].substr(0, comma), where + ", angle"));
  if (comma != std::string_view::npos) light.up = parse_triple(parts[3].substr(comma + 1), ',', where + ", up");
  light.file = parts[4];
}

std::string write_projector(const Light& light) {
  return write_point(light) + write_directional(light) + number_text(light.angle) + "," + triple_text(light.up, ',') +
         ":" + light.file + ":";
}

void read_environment(const Parts& parts, const std::string& where, Light& light) {
  light.file = parts[1];
  const auto values = split(parts[2], ',');
  light.turn = static_cast<float>(parse_number(values[0], where + ", turn"));
  const std::string_view up = values.size() > 1 ? values[1] : "y";
  if (values.size() > 2 || (up != "y" && up != "z")) {
    throw InputError(where + ", turn: found '" + std::string(parts[2]) + "', expected TURN, TURN,y or TURN,z");
  }
  light.up = up == "y" ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
}

std::string write_environment(const Light& light) {
  return light.file + ":" + number_text(light.turn) + (light.up.z > 0 ? ",z:" : ",y:");
}

constexpr Form forms[] = {{"directional", LightKind::directional, 3, read_directional, write_directional},
                          {"point", LightKind::point, 3, read_point, write_point},
                          {"ambient", LightKind::ambient, 2, read_ambient, write_ambient},
                          {"spot", LightKind::spot, 5, read_spot, write_spot},
                          {"rectangle", LightKind::rectangle, 5, read_rectangle, write_rectangle},
                          {"projector", LightKind::projector, 6, read_projector, write_projector},
                          {"environment", LightKind::environment, 4, read_environment, write_environment}};

}  // namespace

const char* const light_forms =
    "directional:DX,DY,DZ:IRRADIANCE (the way the light travels; W/mm^2), point:X,Y,Z:POWER (mm; W), "
    "ambient:IRRADIANCE (W/mm^2), spot:X,Y,Z:DX,DY,DZ:ANGLE[,EDGE]:POWER (ANGLE in degrees from the axis to where "
    "the light ends, EDGE the share of it over which it fades, 0.2; W in the whole cone), "
    "rectangle:X,Y,Z:UX,UY,UZ:VX,VY,VZ:POWER (centre and edges, mm; it shines to where U x V "
    "points; W in all), projector:X,Y,Z:DX,DY,DZ:ANGLE[,UX,UY,UZ]:FILE:POWER (ANGLE is the height of the image in "
    "degrees, U where its top lies, y; .png, .exr or .hdr; W if it is white all over) or "
    "environment:FILE:TURN[,UP]:RADIANCE (a picture of all that is around by longitude and latitude, degrees "
    "counter-clockwise about UP, y or z; W/(mm^2 sr) of what is 1 in it); the last one number or R/G/B";

Light parse_light(std::string_view text) {
  const Parts parts = split(text, ':');
  const std::string where = "light '" + std::string(text) + "'";
  for (const Form& form : forms) {
    if (form.name != parts[0] || form.parts != parts.size()) continue;
    Light light;
    light.kind = form.kind;
    light.power = parse_rgb(parts.back(), where + ", power");
    form.read(parts, where, light);
    check_light(light);
    return light;
  }
  throw InputError(where + ": expected " + light_forms);
}

std::string to_string(const Light& light) {
  for (const Form& form : forms) {
    if (form.kind == light.kind) return std::string(form.name) + ":" + form.write(light) + rgb_text(light.power);
  }
  return "";
}

}  // namespace quadgraph
