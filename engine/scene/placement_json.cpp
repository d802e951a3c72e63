#include "engine/scene/placement_json.h"

#include "engine/render/light/image_file.h"

namespace quadgraph {

Placement placement_from(const JsonField& field) {
  field.allow({"centre", "direction", "up", "size"});
  Placement placement;
  placement.centre = field.at("centre").triple();
  if (const auto direction = field.find("direction")) placement.direction = direction->triple();
  if (const auto up = field.find("up")) placement.up = up->triple();
  placement.size = field.at("size").triple();
  field.within([&] { check_placement(placement); });
  return placement;
}

Json to_json(const Placement& placement) {
  return {{"centre", triple_json(placement.centre)},
          {"direction", triple_json(placement.direction)},
          {"up", triple_json(placement.up)},
          {"size", triple_json(placement.size)}};
}

std::shared_ptr<const ImagePyramid> image_from(const JsonField& field) {
  const std::string file = field.text();
  return field.within([&] { return load_pyramid(file); });
}

Json to_json(const ImagePyramid& image) {
  if (image.file.empty()) throw InputError("image: it is in no file");
  return image.file.string();
}

}  // namespace quadgraph
