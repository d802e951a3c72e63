#include "engine/scene/cut_json.h"

#include <string>

namespace quadgraph {

BodyCut cut_from(const JsonField& field) {
  const JsonField type = field.at("type");
  const std::string name = type.text();
  BodyCut cut;
  if (name == "plane" || name == "slab") {
    const bool slab = name == "slab";
    cut.kind = slab ? CutKind::slab : CutKind::plane;
    if (slab) {
      field.allow({"type", "normal", "offset", "thickness"});
      cut.thickness = field.at("thickness").real();
    } else {
      field.allow({"type", "normal", "offset"});
    }
    cut.normal = field.at("normal").triple();
    cut.offset = field.at("offset").real();
  } else if (name == "sphere") {
    field.allow({"type", "centre", "radius"});
    cut.kind = CutKind::sphere;
    cut.centre = field.at("centre").triple();
    cut.radius = field.at("radius").real();
  } else if (name == "box") {
    field.allow({"type", "centre", "size"});
    cut.kind = CutKind::box;
    cut.centre = field.at("centre").triple();
    cut.size = field.at("size").triple();
  } else {
    type.refuse("\"plane\", \"slab\", \"sphere\" or \"box\"");
  }
  field.within([&] { check_cut(cut); });
  return cut;
}

Json to_json(const BodyCut& cut) {
  switch (cut.kind) {
    case CutKind::plane:
      return {{"type", "plane"}, {"normal", triple_json(cut.normal)}, {"offset", real_json(cut.offset)}};
    case CutKind::slab:
      return {{"type", "slab"},
              {"normal", triple_json(cut.normal)},
              {"offset", real_json(cut.offset)},
              {"thickness", real_json(cut.thickness)}};
    case CutKind::sphere:
      return {{"type", "sphere"}, {"centre", triple_json(cut.centre)}, {"radius", real_json(cut.radius)}};
    case CutKind::box:
      break;
  }
  return {{"type", "box"}, {"centre", triple_json(cut.centre)}, {"size", triple_json(cut.size)}};
}

}  // namespace quadgraph
