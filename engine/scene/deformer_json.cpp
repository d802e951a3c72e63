#include "engine/scene/deformer_json.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t most_points = 16;  // of a lattice, a side

std::vector<glm::dvec3> points_from(const JsonField& field) {
  std::vector<glm::dvec3> points;
  for (const JsonField& point : field.items()) points.push_back(point.precise_triple());
  return points;
}

glm::uvec3 counts_from(const JsonField& field, std::uint32_t low, std::uint32_t high) {
  const auto parts = field.items();
  if (parts.size() != 3) field.refuse("three whole numbers");
  return {parts[0].whole(low, high), parts[1].whole(low, high), parts[2].whole(low, high)};
}

void axis_from(const JsonField& field, Deformer& deformer) {
  if (const auto axis = field.find("axis")) deformer.axis = axis->precise_triple();
  if (const auto centre = field.find("centre")) deformer.centre = centre->precise_triple();
}

void range_from(const JsonField& field, Deformer& deformer) {
  axis_from(field, deformer);
  const auto shares = field.find("range"), lengths = field.find("range_mm");
  if (shares && lengths) lengths->refuse("one of range and range_mm");
  if (!shares && !lengths) return;
  const auto ends = (shares ? *shares : *lengths).items();
  if (ends.size() != 2) (shares ? *shares : *lengths).refuse("[BEGIN, END]");
  deformer.begin = ends[0].number();
  deformer.end = ends[1].number();
  deformer.range_in_mm = lengths.has_value();
}

void turning_from(const JsonField& field, Deformer& deformer) {
  if (deformer.kind == DeformerKind::bend) {
    field.allow({"type", "axis", "centre", "range", "range_mm", "degrees", "towards"});
    if (const auto towards = field.find("towards")) deformer.towards = towards->precise_triple();
  } else {
    field.allow({"type", "axis", "centre", "range", "range_mm", "degrees"});
  }
  range_from(field, deformer);
  deformer.degrees = field.at("degrees").number();
}

void scaling_from(const JsonField& field, Deformer& deformer) {
  field.allow({"type", "axis", "centre", "range", "range_mm", "factor"});
  range_from(field, deformer);
  deformer.factor = field.at("factor").number();
}

void transform_from(const JsonField& field, Deformer& deformer) {
  field.allow({"type", "axis", "centre", "degrees", "scale", "translate"});
  axis_from(field, deformer);
  if (const auto degrees = field.find("degrees")) deformer.degrees = degrees->number();
  if (const auto scale = field.find("scale")) {
    deformer.scale = scale->value().is_array() ? scale->precise_triple() : glm::dvec3(scale->number());
  }
  if (const auto translate = field.find("translate")) deformer.translate = translate->precise_triple();
}

void lattice_from(const JsonField& field, Deformer& deformer) {
  field.allow({"type", "size", "basis", "displacements", "box"});
  deformer.size = counts_from(field.at("size"), 1, most_points);
  deformer.displacements = points_from(field.at("displacements"));
  if (const auto basis = field.find("basis")) deformer.basis = basis->named<LatticeBasis>();
  if (const auto box = field.find("box")) {
    box->allow({"low", "high"});
    deformer.box = RestBox{box->at("low").precise_triple(), box->at("high").precise_triple()};
  }
}

void cage_from(const JsonField& field, Deformer& deformer) {
  field.allow({"type", "cage", "moved", "triangles"});
  deformer.cage = points_from(field.at("cage"));
  deformer.moved = points_from(field.at("moved"));
  for (const JsonField& triangle : field.at("triangles").items()) {
    deformer.triangles.push_back(counts_from(triangle, 0, static_cast<std::uint32_t>(deformer.cage.size()) - 1));
  }
}

void displaced_from(const JsonField& field, Deformer& deformer) {
  field.allow({"type", "shapes", "weights", "frame"});
  const JsonField shapes = field.at("shapes");
  const std::string file = shapes.text();
  deformer.shapes = shapes.within([&] { return load_shapes(file); });
  const auto weights = field.find("weights"), frame = field.find("frame");
  if (weights && frame) frame->refuse("one of weights and frame");
  if (weights) {
    for (const JsonField& weight : weights->items()) deformer.weights.push_back(weight.number());
  } else {
    deformer.weights = frame_weights(field.at("frame").number(), deformer.shapes->count());
  }
}

Json point_json(const glm::dvec3& point) {
  return {point.x, point.y, point.z};
}

Json points_json(const std::vector<glm::dvec3>& points) {
  Json json = Json::array();
  for (const glm::dvec3& point : points) json.push_back(point_json(point));
  return json;
}

void put_axis(const Deformer& deformer, Json& json) {
  json["axis"] = point_json(deformer.axis);
  if (deformer.centre) json["centre"] = point_json(*deformer.centre);
}

void put_lattice(const Deformer& deformer, Json& json) {
  json["size"] = {deformer.size.x, deformer.size.y, deformer.size.z};
  json["basis"] = name_of(deformer.basis);
  json["displacements"] = points_json(deformer.displacements);
  if (deformer.box) json["box"] = {{"low", point_json(deformer.box->low)}, {"high", point_json(deformer.box->high)}};
}

void put_cage(const Deformer& deformer, Json& json) {
  json["cage"] = points_json(deformer.cage);
  json["moved"] = points_json(deformer.moved);
  for (const glm::uvec3& t : deformer.triangles) json["triangles"].push_back({t.x, t.y, t.z});
}

void put_displaced(const Deformer& deformer, Json& json) {
  if (!deformer.shapes || deformer.shapes->file.empty()) throw InputError("displaced, shapes: they are in no file");
  json["shapes"] = deformer.shapes->file.string();
  json["weights"] = deformer.weights;
}

}  // namespace

Deformer deformer_from(const JsonField& field) {
  if (!field.value().is_object()) field.refuse("an object with a type");
  Deformer deformer;
  deformer.kind = field.at("type").named<DeformerKind>();
  using enum DeformerKind;
  switch (deformer.kind) {
    case twist:
    case bend:
      turning_from(field, deformer);
      break;
    case taper:
    case stretch:
      scaling_from(field, deformer);
      break;
    case transform:
      transform_from(field, deformer);
      break;
    case lattice:
      lattice_from(field, deformer);
      break;
    case cage:
      cage_from(field, deformer);
      break;
    case displaced:
      displaced_from(field, deformer);
      break;
    case placed:
      break;  // has no name that a file could say
  }
  field.within([&] { check_deformer(deformer); });
  return deformer;
}

Json to_json(const Deformer& deformer) {
  Json json{{"type", name_of(deformer.kind)}};
  using enum DeformerKind;
  if (deformer.kind == lattice) {
    put_lattice(deformer, json);
  } else if (deformer.kind == cage) {
    put_cage(deformer, json);
  } else if (deformer.kind == displaced) {
    put_displaced(deformer, json);
  } else {
    put_axis(deformer, json);
  }
  if (deformer.kind == twist || deformer.kind == bend || deformer.kind == transform) json["degrees"] = deformer.degrees;
  if (deformer.kind == bend) json["towards"] = point_json(deformer.towards);
  if (deformer.kind == taper || deformer.kind == stretch) json["factor"] = deformer.factor;
  if (deformer.kind == transform) {
    json["scale"] = point_json(deformer.scale);
    json["translate"] = point_json(deformer.translate);
  } else if (json.contains("axis")) {
    json[deformer.range_in_mm ? "range_mm" : "range"] = {deformer.begin, deformer.end};
  }
  return json;
}

}  // namespace quadgraph
