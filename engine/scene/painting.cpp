#include "engine/scene/painting.h"

#include "engine/base/error.h"
#include "engine/scene/layers.h"
#include "engine/scene/placement_json.h"

namespace quadgraph {
namespace {

constexpr double least_mm = 1e-3, most_mm = 1e4;

float length(const JsonField& field) {
  return static_cast<float>(field.number(least_mm, most_mm));
}

// What the brush does to coefficients, where that is said in place of a colour.
void put_coefficients(const JsonField& field, Edit& edit) {
  field.allow({"operation", "sigma_a", "sigma_s_prime"});
  Edit said{.operation = field.at("operation").named<EditOperation>()};
  if (const auto absorption = field.find("sigma_a")) said.sigma_a = absorption->rgb();
  if (const auto scattering = field.find("sigma_s_prime")) said.sigma_s_prime = scattering->rgb();
  field.within([&] { check_edit(said); });
  edit.operation = said.operation;
  edit.sigma_a = said.sigma_a;
  edit.sigma_s_prime = said.sigma_s_prime;
}

// What not every brush has.
void put_more(const JsonField& field, Brush& brush) {
  if (const auto from = field.find("depth_from")) {
    brush.edit.depth_from = static_cast<float>(from->number(0, most_mm));
    if (brush.edit.depth_from >= brush.edit.depth_to) from->refuse("less than depth");
  }
  if (const auto mask = field.find("mask")) brush.edit.mask = image_from(*mask);
  if (const auto pattern = field.find("pattern")) brush.edit.image = image_from(*pattern);
  const auto coefficients = field.find("coefficients");
  brush.by_colour = !coefficients.has_value();
  if (coefficients) put_coefficients(*coefficients, brush.edit);
}

Brush brush_from(const JsonField& field) {
  field.allow({"tool", "colour", "distance", "strength", "radius", "depth", "falloff", "mirror", "layer", "depth_from",
               "mask", "pattern", "coefficients"});
  Brush brush;
  brush.tool = field.at("tool").named<BrushTool>();
  const JsonField colour = field.at("colour");
  const auto channels = colour.items();
  if (channels.size() != 3) colour.refuse("three numbers from 0 to 1");
  for (int k = 0; k < 3; ++k) {
    brush.look.colour[k] = static_cast<float>(channels[static_cast<std::size_t>(k)].number(0, 1));
  }
  brush.look.distance = length(field.at("distance"));
  brush.strength = static_cast<float>(field.at("strength").number(0, 1));
  brush.edit.radius = length(field.at("radius"));
  brush.edit.depth_to = length(field.at("depth"));
  brush.edit.softness = static_cast<float>(field.at("falloff").number(0, most_mm));
  brush.mirror = field.at("mirror").named<Mirror>();
  put_more(field, brush);
  return brush;
}

// 0 of a scene without any, to which a touch or "add" adds one.
std::size_t layer_from(const JsonField& field, const Scene& scene) {
  const auto count = static_cast<std::uint32_t>(scene.layers.size());
  return field.at("layer").whole(0, count > 0 ? count - 1 : 0);
}

Camera seen_from(Stage& stage) {
  const Scene& scene = stage.scene();
  const float aspect = static_cast<float>(scene.render.width) / static_cast<float>(scene.render.height);
  return place_camera(scene.view, stage.engine().bounds(), aspect);
}

void rename(EditLayer& layer, const JsonField& value) {
  EditLayer renamed{.name = value.text()};
  value.within([&] { check_layer(renamed); });
  layer.name = renamed.name;
}

}  // namespace

Json to_json(const Brush& brush) {
  const glm::vec3& colour = brush.look.colour;
  return {{"tool", name_of(brush.tool)},
          {"colour", Json::array({real_json(colour.x), real_json(colour.y), real_json(colour.z)})},
          {"distance", real_json(brush.look.distance)},
          {"strength", real_json(brush.strength)},
          {"radius", real_json(brush.edit.radius)},
          {"depth", real_json(brush.edit.depth_to)},
          {"falloff", real_json(brush.edit.softness)},
          {"mirror", name_of(brush.mirror)}};
}

std::vector<Ring> brush_rings(Stage& stage, const JsonField& brush, const glm::vec2& pixels) {
  const auto turn = stage.take();
  const Brush hand = brush_from(brush);
  Picker picker;
  picker.follow(stage);
  const Scene& scene = stage.scene();
  auto rings = picker.rings(seen_from(stage), clip_place(scene, pixels), hand);
  const glm::vec2 half(0.5f * static_cast<float>(scene.render.width), 0.5f * static_cast<float>(scene.render.height));
  for (Ring& ring : rings) {
    for (glm::vec2& place : ring) place = half * glm::vec2(1 + place.x, 1 - place.y);
  }
  return rings;
}

glm::vec2 clip_place(const Scene& scene, const glm::vec2& pixels) {
  return {2 * pixels.x / static_cast<float>(scene.render.width) - 1,
          1 - 2 * pixels.y / static_cast<float>(scene.render.height)};
}

std::optional<Picked> picked_at(Stage& stage, const glm::vec2& pixels) {
  const Scene& scene = stage.scene();
  const float aspect = static_cast<float>(scene.render.width) / static_cast<float>(scene.render.height);
  return stage.engine().pick(scene.view, aspect, clip_place(scene, pixels));
}

Painted painted(Stage& stage, const JsonField& brush, std::span<const glm::vec2> places, bool begins) {
  if (places.empty() || places.size() > most_touches) {
    throw InputError("places: found " + std::to_string(places.size()) + ", allowed are 1 to " +
                     std::to_string(most_touches));
  }
  const auto turn = stage.take();
  Brush hand = brush_from(brush);
  Painted made{.scene = stage.scene(), .layer = layer_from(brush, stage.scene())};
  Picker picker;
  picker.follow(stage);
  const Camera camera = seen_from(stage);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto touch = picker.touch(camera, clip_place(made.scene, places[i]), hand.mirror);
    if (i == 0) made.touched = touch.has_value();
    if (!touch) {
      if (i == 0 && begins) break;  // beside the body
      continue;
    }
    if (i > 0 || !begins) {
      hand.go_on(made.scene, made.layer, *touch);
    } else if (!hand.touch(made.scene, made.layer, *touch)) {
      break;
    }
  }
  made.look = hand.look;
  return made;
}

Painted relayered(const Scene& scene, const JsonField& asked) {
  asked.allow({"layer", "change", "value"});
  Painted made{.scene = scene, .layer = layer_from(asked, scene)};
  const JsonField change = asked.at("change");
  const std::string what = change.text();
  const bool any = !scene.layers.empty();
  if (what == "add") {
    add_layer(made.scene, made.layer);
  } else if (what == "remove") {
    remove_layer(made.scene, made.layer);
  } else if (what == "up" || what == "down") {
    move_layer(made.scene, made.layer, what == "up");
  } else if (what == "name" && any) {
    rename(made.scene.layers[made.layer], asked.at("value"));
  } else if (what == "visible" && any) {
    made.scene.layers[made.layer].visible = asked.at("value").truth();
  } else if (what == "opacity" && any) {
    made.scene.layers[made.layer].opacity = static_cast<float>(asked.at("value").number(0, 1));
  } else {
    change.refuse("add, remove, up, down, and of a layer that is there name, visible, opacity");
  }
  return made;
}

}  // namespace quadgraph
