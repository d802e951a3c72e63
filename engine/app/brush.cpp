#include "engine/app/brush.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>

#include "engine/optics/material.h"

namespace quadgraph {
namespace {

constexpr float reach = 1.0f / 15, stride = 0.3f;  // of the body's radius; of the brush's
constexpr float least_sine = 0.1f;                 // of the angle between a surface's normal and what is upright on it

// Whether a stroke or a stamp goes over a place.
bool reaches(const Edit& edit, const glm::vec3& at) {
  if (edit.placement) return glm::distance(edit.placement->centre, at) <= 0.25f * edit.placement->size.z + edit.radius;
  const auto& stroke = edit.stroke;
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    if (gpu::segment_distance(at, stroke[i > 0 ? i - 1 : 0], stroke[i]) <= edit.radius) return true;
  }
  return false;
}

}  // namespace

Touch touched(const Picked& picked, const Camera& camera) {
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
Edit Brush::stroke_on(const Scene& scene) const {
  if (!by_colour) return edit;
  MaterialLook put = look;
  put.eta = default_eta;
  if (const auto& own = look_of(scene.material)) {
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

Edit Brush::stamp(const Edit& how, const Touch& touch) const {
  const ImagePyramid& shape = how.image ? *how.image : *how.mask;
  const float longest = static_cast<float>(std::max(shape.columns, shape.rows));
  const float width = 2 * how.radius * static_cast<float>(shape.columns) / longest;
  const float height = 2 * how.radius * static_cast<float>(shape.rows) / longest;
  Edit stamped = how;
  stamped.radius = 0;
  stamped.softness = std::min(how.softness, 0.25f * std::min(width, height));
  stamped.placement = Placement{touch.at, touch.inward, touch.upright, {width, height, 2 * how.radius}};
  return stamped;
}

void Brush::begin(Scene& scene, const Touch& touch) const {
  const Edit made = stroke_on(scene);
  if (stamps()) return scene.edits.push_back(stamp(made, touch));
  scene.edits.push_back(made);
  scene.edits.back().stroke = {touch.at};
}

void Brush::lead(Scene& scene, const Touch& touch) const {
  if (stamps()) {
    scene.edits.back() = stamp(stroke_on(scene), touch);
    return;
  }
  std::vector<glm::vec3>& stroke = scene.edits.back().stroke;
  if (glm::distance(stroke.back(), touch.at) > stride * edit.radius) stroke.push_back(touch.at);
}

void Brush::erase(Scene& scene, const Touch& touch) {
  const auto last =
      std::find_if(scene.edits.rbegin(), scene.edits.rend(), [&](const Edit& edit) { return reaches(edit, touch.at); });
  if (last != scene.edits.rend()) scene.edits.erase(std::next(last).base());
}

void Brush::pick(const Scene& scene, const Touch& touch) {
  const auto last = std::find_if(scene.edits.rbegin(), scene.edits.rend(), [&](const Edit& each) {
    const bool whole = each.operation == Edit::Operation::set && each.sigma_a && each.sigma_s_prime;
    return whole && reaches(each, touch.at);
  });
  const auto& own = look_of(scene.material);
  if (own) look = *own;
  if (last == scene.edits.rend()) return;
  gpu::Material painted{};
  painted.sigma_s_prime = *last->sigma_s_prime;
  painted.sigma_a = *last->sigma_a;
  painted.eta = own ? own->eta : default_eta;
  look = look_of(painted);
}

}  // namespace quadgraph
