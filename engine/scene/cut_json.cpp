#include "engine/scene/cut_json.h"

namespace quadgraph {

BodyCut cut_from(const JsonField& field) {
  BodyCut cut;
  cut.kind = field.at("type").named<CutKind>();
  switch (cut.kind) {
    case CutKind::plane:
    case CutKind::slab:
      if (cut.kind == CutKind::slab) {
        field.allow({"type", "normal", "offset", "thickness"});
        cut.thickness = field.at("thickness").real();
      } else {
        field.allow({"type", "normal", "offset"});
      }
      cut.normal = field.at("normal").triple();
      cut.offset = field.at("offset").real();
      break;
    case CutKind::sphere:
      field.allow({"type", "centre", "radius"});
      cut.centre = field.at("centre").triple();
      cut.radius = field.at("radius").real();
      break;
    case CutKind::box:
      field.allow({"type", "centre", "size"});
      cut.centre = field.at("centre").triple();
      cut.size = field.at("size").triple();
      break;
  }
  field.within([&] { check_cut(cut); });
  return cut;
}

Json to_json(const BodyCut& cut) {
  Json json{{"type", name_of(cut.kind)}};
  switch (cut.kind) {
    case CutKind::plane:
    case CutKind::slab:
      json["normal"] = triple_json(cut.normal);
      json["offset"] = real_json(cut.offset);
      if (cut.kind == CutKind::slab) json["thickness"] = real_json(cut.thickness);
      break;
    case CutKind::sphere:
      json["centre"] = triple_json(cut.centre);
      json["radius"] = real_json(cut.radius);
      break;
    case CutKind::box:
      json["centre"] = triple_json(cut.centre);
      json["size"] = triple_json(cut.size);
      break;
  }
  return json;
}

}  // namespace quadgraph
