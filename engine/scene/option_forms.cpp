#include "engine/scene/option_forms.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/file/body_names.h"
#include "engine/optics/material.h"
#include "engine/render/light/lights.h"
#include "engine/render/light/normal_map_file.h"
#include "engine/scene/material_map.h"
#include "engine/scene/option_members.h"
#include "engine/scene/usual_light.h"
#include "engine/scene/volume.h"

namespace quadgraph {

const std::string& text_in(const OptionValue& value) {
  return std::get<std::string>(value);
}

std::string material_help() {
  std::string names;
  for (const std::string& name : material_names()) names += (names.empty() ? "" : ", ") + name;
  return "a name (" + names +
         "); or sigma_s_prime=S,sigma_a=A,eta=E in 1/mm, one value or R/G/B each; or reflectance=C,mean_free_path=L: "
         "the colour that a thick body shows, below 1, and a length in mm; or sigma_s=S,g=G in place of sigma_s_prime: "
         "scattering of mean cosine G, which g=G beside a sigma_s_prime or a name says, too; "
         "or NAME,key=value; "
         "roughness=ALPHA of the surface; coat=water, lacquer or the share that a clear layer covers, of index "
         "coat_eta and coat_roughness; pattern=P,period=D,sharpness=K mixes in a second set, second_sigma_a and so on; "
         "or a file .npz of coefficients on a grid (docs/scene.md), with a coat or none";
}

std::string map_help() {
  std::string help = "how a volume (.npz) that was found elsewhere is carried into the body";
  for (const auto& kind : Names<MapKind>::values) {
    help += (kind.value == MapKind::box ? ". " : "; ") + std::string(kind.name) + ": " + std::string(kind.help);
  }
  return help +
         ". Then, joined by commas: scale=S (box: of the body's box; shell: mm of the body for one of the source), "
         "repeat=mirror or clamp, depth=MM of the shell, from=BODY.qgraph that the volume was found in (default: the "
         "volume's own box). Default: it lies in the body as it is";
}

std::string body_help() {
  return "of one body of a file that names several (docs/bodies.md): what it is made of, as --material; may be "
         "repeated. Bodies that are not named have --material";
}

OptionValue materials_of(const Scene& scene) {
  std::vector<std::string> texts;
  for (const auto& [body, material] : scene.materials) texts.push_back(body + "=" + material);
  return texts;
}

void set_materials_of(Scene& scene, const OptionValue& value) {
  for (const std::string& text : std::get<std::vector<std::string>>(value)) {
    const std::size_t at = text.find('=');
    const std::string body = text.substr(0, at);
    if (at == std::string::npos || !is_body_name(body)) {
      throw InputError("material-of: found '" + text + "', expected BODY=M, such as cup=porcelain");
    }
    try {
      check_material_text(text.substr(at + 1));
    } catch (const InputError& error) {
      throw InputError("material of '" + body + "': " + error.what());
    }
    scene.materials[body] = text.substr(at + 1);
  }
}

OptionValue map_of(const Scene& scene) {
  const std::optional<VolumeName> name = volume_name(scene.material);
  return name && name->map ? OptionValue(to_string(*name->map)) : OptionValue();
}

void set_map(Scene& scene, const OptionValue& value) {
  scene.material = with_map(scene.material, text_in(value));
}

std::string light_help() {
  return light_forms() + ", or " + std::string(lamps_name) +
         " (a warm key light from behind the object, a cool one from the side, a little ambient light). May be "
         "repeated. Default: studio, and with it --ground; lamps where no picture is made";
}

OptionValue lights_of(const Scene& scene) {
  std::vector<std::string> texts;
  for (const Light& light : scene.lights) texts.push_back(to_string(light));
  return texts;
}

void set_lights(Scene& scene, const OptionValue& value) {
  scene.lights = named_lights(std::get<std::vector<std::string>>(value), scene.view);
}

OptionValue view_of(const Scene& scene) {
  const View &view = scene.view, usual;
  const bool same = view.azimuth == usual.azimuth && view.elevation == usual.elevation && !view.distance;
  return same ? OptionValue() : OptionValue(to_string(view));
}

void set_view(Scene& scene, const OptionValue& value) {
  scene.view.distance.reset();
  scene.view.eye.reset();
  scene.view.look_at.reset();
  scene.view = parse_view(text_in(value), scene.view);
}

OptionValue eye_of(const Scene& scene) {
  return scene.view.eye ? OptionValue(place_text(*scene.view.eye)) : OptionValue();
}

void set_eye(Scene& scene, const OptionValue& value) {
  scene.view.eye = parse_place(text_in(value), "eye");
}

OptionValue look_at_of(const Scene& scene) {
  return scene.view.look_at ? OptionValue(place_text(*scene.view.look_at)) : OptionValue();
}

void set_look_at(Scene& scene, const OptionValue& value) {
  scene.view.look_at = parse_place(text_in(value), "look-at");
}

OptionValue size_of(const Scene& scene) {
  return std::to_string(scene.render.width) + "x" + std::to_string(scene.render.height);
}

namespace {

std::uint32_t parse_side(std::string_view text, const std::string& whole) {
  const double side = parse_number(text, "size '" + whole + "'");
  if (side < 1 || side > 65535 || side != std::floor(side)) {
    throw InputError("size: found '" + whole + "', expected WIDTHxHEIGHT in whole pixels");
  }
  return static_cast<std::uint32_t>(side);
}

}  // namespace

void set_size(Scene& scene, const OptionValue& value) {
  const std::string& text = text_in(value);
  const auto sides = split(text, text.find('X') == std::string::npos ? 'x' : 'X');
  if (sides.size() != 2) throw InputError("size: found '" + text + "', expected WIDTHxHEIGHT");
  scene.render.width = parse_side(sides[0], text);
  scene.render.height = parse_side(sides[1], text);
}

OptionValue stops_of(const Scene& scene) {
  const auto& stops = scene.tone.exposure_stops;
  return stops ? OptionValue(as_written(*stops)) : OptionValue(std::string("auto"));
}

void set_stops(Scene& scene, const OptionValue& value) {
  if (const auto* stops = std::get_if<double>(&value)) {
    scene.tone.exposure_stops = static_cast<float>(*stops);
  } else {
    scene.tone.exposure_stops = parse_exposure(text_in(value));
  }
}

OptionValue normal_map_of(const Scene& scene) {
  const auto& map = scene.render.normal_map;
  if (!map || map->placement) return {};
  return map->slopes->file.string();
}

void set_normal_map(Scene& scene, const OptionValue& value) {
  try {
    scene.render.normal_map = NormalMap{load_normal_map(text_in(value))};
  } catch (const InputError& error) {
    throw InputError(std::string("normal-map: ") + error.what());
  }
}

OptionValue background_of(const Scene& scene) {
  const ToneOptions &tone = scene.tone, usual;
  if (tone.transparent) return std::string("transparent");
  if (tone.background_top == usual.background_top && tone.background_bottom == usual.background_bottom) {
    return std::string("studio");
  }
  return tone.background_top == tone.background_bottom ? OptionValue(rgb_text(tone.background_top)) : OptionValue();
}

void set_background(Scene& scene, const OptionValue& value) {
  parse_background(text_in(value), scene.tone);
}

}  // namespace quadgraph
