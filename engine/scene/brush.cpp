#include "engine/scene/brush.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>

#include "engine/base/error.h"
#include "engine/optics/material.h"
#include "engine/scene/layers.h"

namespace quadgraph {
namespace {

constexpr float reach = 1.0f / 15, stride = 0.3f;  // of the body's radius; of the brush's

bool reaches(const std::optional<Placement>& placement, const std::vector<glm::vec3>& stroke, float radius,
             const glm::vec3& at) {
  if (placement) return glm::distance(placement->centre, at) <= 0.25f * placement->size.z + radius;
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    if (gpu::segment_distance(at, stroke[i > 0 ? i - 1 : 0], stroke[i]) <= radius) return true;
  }
  return false;
}

// Whether a stroke or a stamp goes over a place, or its mirror image does.
bool reaches(const Edit& edit, const glm::vec3& at) {
  if (reaches(edit.placement, edit.stroke, edit.radius, at)) return true;
  return edit.mirrored && reaches(edit.mirrored->placement, edit.mirrored->stroke, edit.radius, at);
}

}  // namespace

TouchPlace touched(const Picked& picked, const Camera& camera) {
  const glm::vec3 outward = glm::normalize(picked.to_rest * picked.normal);
  const auto along = [&](const glm::vec3& direction) {
    const glm::vec3 there = picked.to_rest * (direction - glm::dot(direction, picked.normal) * picked.normal);
    return there - glm::dot(there, outward) * outward;
  };
  glm::vec3 upright = along(camera.up);
  if (glm::length(upright) < least_sine * glm::length(picked.to_rest * camera.up)) upright = along(-camera.backward);
  return {picked.at_rest, -outward, glm::normalize(upright)};
}

Brush Brush::for_body(float radius) {
  Brush brush;
  brush.edit.sigma_a = glm::vec3(3);
  brush.edit.radius = reach * radius;
  brush.edit.depth_to = reach * radius;
  brush.edit.softness = 0.5f * reach * radius;
  brush.look.distance = 0.25f * reach * radius;
  return brush;
}

// Colour and distance on their way from the material's to the brush's, as coefficients.
Edit Brush::stroke_on(const Scene& scene, const std::string& body) const {
  if (!by_colour) return edit;
  MaterialLook put = look;
  put.eta = default_eta;
  if (const auto& own = look_of(said_material(scene, body))) {
    put.eta = own->eta;
    put.colour = glm::mix(own->colour, look.colour, strength);
    put.distance = own->distance * std::pow(look.distance / own->distance, strength);
  }
  const gpu::Material material = parse_material(material_of(put));
  Edit made = edit;
  made.operation = Edit::Operation::set;
  made.sigma_s_prime = material.sigma_s_prime;
  made.sigma_a = material.sigma_a;
  return made;
}

// The box of a stamp.
Placement Brush::placement_at(const TouchPlace& place) const {
  const ImagePyramid& shape = edit.image ? *edit.image : *edit.mask;
  const float longest = static_cast<float>(std::max(shape.columns, shape.rows));
  const float width = 2 * edit.radius * static_cast<float>(shape.columns) / longest;
  const float height = 2 * edit.radius * static_cast<float>(shape.rows) / longest;
  return {place.at, place.inward, place.upright, {width, height, 2 * edit.radius}};
}

Edit Brush::stroke_at(const Scene& scene, const Touch& touch) const {
  Edit made = stroke_on(scene, touch.body);
  if (touch.mirrored) made.mirrored.emplace();
  if (stamps()) {
    made.radius = 0;
    made.placement = placement_at(touch.here);
    made.softness = std::min(made.softness, 0.25f * std::min(made.placement->size.x, made.placement->size.y));
    if (touch.mirrored) made.mirrored->placement = placement_at(*touch.mirrored);
  } else {
    made.stroke = {touch.here.at};
    if (touch.mirrored) made.mirrored->stroke = {touch.mirrored->at};
  }
  return made;
}

void Brush::begin(Scene& scene, std::size_t layer, const Touch& touch) const {
  scene.layers.at(layer).edits.push_back(stroke_at(scene, touch));
}

void Brush::lead(Scene& scene, std::size_t layer, const Touch& touch) const {
  auto& edits = scene.layers.at(layer).edits;
  if (edits.empty()) return;
  Edit& last = edits.back();
  if (stamps()) {
    last = stroke_at(scene, touch);
  } else if (glm::distance(last.stroke.back(), touch.here.at) > stride * edit.radius) {
    last.stroke.push_back(touch.here.at);
    if (last.mirrored) last.mirrored->stroke.push_back(touch.mirrored.value_or(touch.here).at);
  }
}

bool Brush::touch(Scene& scene, std::size_t& layer, const Touch& touch) {
  if (tool == BrushTool::pick) {
    pick(scene, touch);
    tool = BrushTool::paint;
    return false;
  }
  if (scene.layers.empty()) add_layer(scene, layer);
  EditLayer& active = scene.layers.at(layer);
  if (!active.visible) {
    throw InputError("'" + active.name + "' is hidden: show it by its eye, or choose another layer, to paint or erase");
  }
  if (tool == BrushTool::paint) {
    begin(scene, layer, touch);
  } else {
    erase(active, touch);
  }
  return true;
}

void Brush::go_on(Scene& scene, std::size_t layer, const Touch& touch) const {
  if (layer >= scene.layers.size()) return;
  if (tool == BrushTool::paint) lead(scene, layer, touch);
  if (tool == BrushTool::erase) erase(scene.layers[layer], touch);
}

void Brush::erase(EditLayer& layer, const Touch& touch) {
  auto& edits = layer.edits;
  const auto last =
      std::find_if(edits.rbegin(), edits.rend(), [&](const Edit& stroke) { return reaches(stroke, touch.here.at); });
  if (last != edits.rend()) edits.erase(std::next(last).base());
}

void Brush::pick(const Scene& scene, const Touch& touch) {
  const std::vector<Edit> seen = applied_edits(scene.layers);
  const auto last = std::find_if(seen.rbegin(), seen.rend(), [&](const Edit& each) {
    const bool whole = each.operation == Edit::Operation::set && each.sigma_a && each.sigma_s_prime;
    return whole && reaches(each, touch.here.at);
  });
  const auto& own = look_of(said_material(scene, touch.body));
  if (own) look = *own;
  if (last == seen.rend()) return;
  gpu::Material painted{};
  painted.sigma_s_prime = *last->sigma_s_prime;
  painted.sigma_a = *last->sigma_a;
  painted.eta = own ? own->eta : default_eta;
  look = look_of(painted);
}

}  // namespace quadgraph
