#include "engine/scene/edit_json.h"

#include "engine/scene/placement_json.h"

namespace quadgraph {
Edit edit_from(const JsonField& field) {
  field.allow(
      {"operation", "sigma_s_prime", "sigma_a", "stroke", "radius", "depth", "softness", "placement", "image", "mask"});
  Edit edit;
  edit.operation = field.at("operation").named<EditOperation>();
  if (const auto scattering = field.find("sigma_s_prime")) edit.sigma_s_prime = scattering->rgb();
  if (const auto absorption = field.find("sigma_a")) edit.sigma_a = absorption->rgb();
  if (const auto stroke = field.find("stroke")) {
    for (const JsonField& point : stroke->items()) edit.stroke.push_back(point.triple());
  }
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
  field.within([&] { check_edit(edit); });
  return edit;
}

Json to_json(const Edit& edit) {
  Json json{{"operation", name_of(edit.operation)}};
  if (edit.sigma_s_prime) json["sigma_s_prime"] = rgb_json(*edit.sigma_s_prime);
  if (edit.sigma_a) json["sigma_a"] = rgb_json(*edit.sigma_a);
  for (const glm::vec3& point : edit.stroke) json["stroke"].push_back(triple_json(point));
  if (!edit.stroke.empty()) json["radius"] = real_json(edit.radius);
  if (edit.depth_from > 0 || edit.depth_to < Edit().depth_to) {
    json["depth"] = Json::array({real_json(edit.depth_from), real_json(edit.depth_to)});
  }
  if (edit.softness > 0) json["softness"] = real_json(edit.softness);
  if (edit.placement) json["placement"] = to_json(*edit.placement);
  if (edit.image) json["image"] = to_json(*edit.image);
  if (edit.mask) json["mask"] = to_json(*edit.mask);
  return json;
}

}  // namespace quadgraph
