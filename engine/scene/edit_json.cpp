#include "engine/scene/edit_json.h"

#include "engine/scene/placement_json.h"

namespace quadgraph {
namespace {

std::vector<glm::vec3> stroke_from(const JsonField& field) {
  std::vector<glm::vec3> points;
  for (const JsonField& point : field.items()) points.push_back(point.triple());
  return points;
}

Json stroke_json(const std::vector<glm::vec3>& points) {
  Json json = Json::array();
  for (const glm::vec3& point : points) json.push_back(triple_json(point));
  return json;
}

EditMirror mirror_from(const JsonField& field) {
  if (!field.value().is_object()) field.refuse("an object with stroke, placement, or both");
  field.allow({"stroke", "placement"});
  EditMirror mirror;
  if (const auto stroke = field.find("stroke")) mirror.stroke = stroke_from(*stroke);
  if (const auto placement = field.find("placement")) mirror.placement = placement_from(*placement);
  return mirror;
}

Json mirror_json(const EditMirror& mirror) {
  Json json = Json::object();
  if (!mirror.stroke.empty()) json["stroke"] = stroke_json(mirror.stroke);
  if (mirror.placement) json["placement"] = to_json(*mirror.placement);
  return json;
}

bool is_layer(const Json& value) {
  return value.is_object() && (value.contains("edits") || value.contains("name"));
}

EditLayer layer_from(const JsonField& field) {
  field.allow({"name", "visible", "opacity", "edits"});
  EditLayer layer{.name = field.at("name").text()};
  if (const auto visible = field.find("visible")) layer.visible = visible->truth();
  if (const auto opacity = field.find("opacity")) layer.opacity = static_cast<float>(opacity->number(0, 1));
  field.within([&] { check_layer(layer); });
  for (const JsonField& edit : field.at("edits").items()) layer.edits.push_back(edit_from(edit));
  return layer;
}

Json layer_json(const EditLayer& layer) {
  Json edits = Json::array();
  for (const Edit& edit : layer.edits) edits.push_back(to_json(edit));
  return {{"name", layer.name},
          {"visible", layer.visible},
          {"opacity", real_json(layer.opacity)},
          {"edits", std::move(edits)}};
}

}  // namespace

Edit edit_from(const JsonField& field) {
  field.allow({"operation", "sigma_s_prime", "sigma_a", "stroke", "radius", "depth", "softness", "placement", "image",
               "mask", "mirrored"});
  Edit edit;
  edit.operation = field.at("operation").named<EditOperation>();
  if (const auto scattering = field.find("sigma_s_prime")) edit.sigma_s_prime = scattering->rgb();
  if (const auto absorption = field.find("sigma_a")) edit.sigma_a = absorption->rgb();
  if (const auto stroke = field.find("stroke")) edit.stroke = stroke_from(*stroke);
  if (const auto radius = field.find("radius")) edit.radius = radius->real();
  if (const auto depth = field.find("depth")) {
    const auto ends = depth->items();
    if (ends.size() != 2) depth->refuse("[FROM, TO] (mm)");
    edit.depth_from = ends[0].real();
    edit.depth_to = ends[1].real();
  }
  if (const auto softness = field.find("softness")) edit.softness = softness->real();
  if (const auto placement = field.find("placement")) edit.placement = placement_from(*placement);
  if (const auto image = field.find("image")) edit.image = image_from(*image);
  if (const auto mask = field.find("mask")) edit.mask = image_from(*mask);
  if (const auto mirrored = field.find("mirrored")) edit.mirrored = mirror_from(*mirrored);
  field.within([&] { check_edit(edit); });
  return edit;
}

Json to_json(const Edit& edit) {
  Json json{{"operation", name_of(edit.operation)}};
  if (edit.sigma_s_prime) json["sigma_s_prime"] = rgb_json(*edit.sigma_s_prime);
  if (edit.sigma_a) json["sigma_a"] = rgb_json(*edit.sigma_a);
  if (!edit.stroke.empty()) {
    json["stroke"] = stroke_json(edit.stroke);
    json["radius"] = real_json(edit.radius);
  }
  if (edit.depth_from > 0 || edit.depth_to < Edit().depth_to) {
    json["depth"] = Json::array({real_json(edit.depth_from), real_json(edit.depth_to)});
  }
  if (edit.softness > 0) json["softness"] = real_json(edit.softness);
  if (edit.placement) json["placement"] = to_json(*edit.placement);
  if (edit.image) json["image"] = to_json(*edit.image);
  if (edit.mask) json["mask"] = to_json(*edit.mask);
  if (edit.mirrored) json["mirrored"] = mirror_json(*edit.mirrored);
  return json;
}

std::vector<EditLayer> layers_from(const JsonField& field) {
  std::vector<EditLayer> layers;
  bool within_own = true;  // the item before was a layer
  for (const JsonField& item : field.items()) {
    const bool is_own = is_layer(item.value());
    if (is_own || within_own) {
      if (layers.size() == most_layers) item.refuse("at most " + std::to_string(most_layers) + " layers");
      layers.push_back(is_own ? layer_from(item) : EditLayer{.name = layer_name(layers.size() + 1)});
    }
    if (!is_own) layers.back().edits.push_back(edit_from(item));
    within_own = is_own;
  }
  return layers;
}

Json layers_json(const std::vector<EditLayer>& layers) {
  const bool unnamed = layers.size() == 1 && layers[0].name == layer_name(1) && !layers[0].edits.empty();
  if (unnamed && layers[0].visible && layers[0].opacity == 1) return layer_json(layers[0])["edits"];
  Json json = Json::array();
  for (const EditLayer& layer : layers) json.push_back(layer_json(layer));
  return json;
}

}  // namespace quadgraph
