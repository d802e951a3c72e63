#include "engine/render/light/shadow_views.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <optional>

namespace quadgraph {
namespace {

// A direction that is safely not parallel to `axis`.
glm::vec3 any_up(const glm::vec3& axis) {
  return std::abs(axis.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
}

gpu::ShadowView directional_view(const Light& light, const Sphere& bounds, std::uint32_t size) {
  gpu::ShadowView view{};
  view.size = size;
  // Two texels of margin, so that filtering never leaves the map on the object.
  const float half = bounds.radius * (1.0f + 4.0f / static_cast<float>(view.size));
  const float distance = 1.02f * bounds.radius;
  view.near = 0;
  view.far = 2.0f * distance;
  view.texel = 2.0f * half / static_cast<float>(view.size);
  const glm::vec3 eye = bounds.centre - distance * light.direction;
  view.clip_from_world = glm::orthoRH_ZO(-half, half, -half, half, view.near, view.far) *
                         glm::lookAtRH(eye, bounds.centre, any_up(light.direction));
  return view;
}

// `half` is the tangent of half the opening angle.
gpu::ShadowView perspective_view(const glm::vec3& eye, const glm::vec3& axis, float half, float near, float far,
                                 std::uint32_t size) {
  gpu::ShadowView view{};
  view.size = size;
  half *= 1.0f + 4.0f / static_cast<float>(size);
  view.near = near;
  view.far = far;
  view.texel = 2.0f * half / static_cast<float>(size);
  view.clip_from_world = glm::frustumRH_ZO(-half * near, half * near, -half * near, half * near, near, far) *
                         glm::lookAtRH(eye, eye + axis, any_up(axis));
  return view;
}

// From outside 1.1 times the sphere, the whole of it.
std::optional<gpu::ShadowView> distant_view(const glm::vec3& position, const Sphere& bounds, std::uint32_t size) {
  const glm::vec3 to_centre = bounds.centre - position;
  const float distance = glm::length(to_centre), r = bounds.radius;
  if (distance <= 1.1f * r) return std::nullopt;
  const float half = r / std::sqrt(distance * distance - r * r);
  return perspective_view(position, to_centre / distance, half, distance - 1.02f * r, distance + 1.02f * r, size);
}

std::vector<gpu::ShadowView> cube_views(const glm::vec3& position, const Sphere& bounds, std::uint32_t size) {
  const float r = bounds.radius, distance = glm::distance(position, bounds.centre);
  std::vector<gpu::ShadowView> views;
  for (int axis = 0; axis < 3; ++axis) {
    for (float sign : {1.0f, -1.0f}) {
      glm::vec3 direction(0);
      direction[axis] = sign;
      views.push_back(perspective_view(position, direction, 1.0f, 1e-3f * r, distance + 1.02f * r, size));
    }
  }
  return views;
}

std::vector<gpu::ShadowView> views_from(const glm::vec3& position, const Sphere& bounds, std::uint32_t size,
                                        std::uint32_t cube_size) {
  if (const auto view = distant_view(position, bounds, size)) return {*view};
  return cube_views(position, bounds, cube_size);
}

std::vector<gpu::ShadowView> point_views(const glm::vec3& position, const Sphere& bounds, std::uint32_t halvings) {
  return views_from(position, bounds, gpu::SHADOW_SIZE >> halvings, gpu::SHADOW_CUBE_SIZE >> halvings);
}

// The cone, if that is narrower than the body.
std::vector<gpu::ShadowView> spot_views(const Light& light, const Sphere& bounds, std::uint32_t halvings) {
  constexpr float widest = 75;  // degrees; of one view that still has fine texels everywhere
  const glm::vec3 to_centre = bounds.centre - light.position;
  const float r = bounds.radius, ahead = glm::dot(to_centre, light.direction);
  const auto distant = distant_view(light.position, bounds, gpu::SHADOW_SIZE >> halvings);
  const bool narrower = !distant || glm::radians(light.angle) < std::asin(r / glm::length(to_centre));
  if (light.angle > widest || !narrower) return point_views(light.position, bounds, halvings);
  const float near = std::max(ahead - 1.02f * r, 1e-3f * r);
  return {perspective_view(light.position, light.direction, std::tan(glm::radians(light.angle)), near,
                           std::max(ahead + 1.02f * r, 2 * near), gpu::SHADOW_SIZE >> halvings)};
}

}  // namespace

std::vector<gpu::ShadowView> shadow_views(const Light& light, const Sphere& bounds, std::uint32_t halvings) {
  if (light.kind == LightKind::directional) return {directional_view(light, bounds, gpu::SHADOW_SIZE >> halvings)};
  if (light.kind == LightKind::spot) return spot_views(light, bounds, halvings);
  const LightForm& form = form_of(light.kind);
  if (!form.has(FieldForm::point) || form.has(FieldForm::edge)) return {};
  return point_views(light.position, bounds, halvings);
}

std::vector<gpu::ShadowView> patch_views(const glm::vec3& position, const glm::vec3& axis, const Sphere& bounds,
                                         std::uint32_t halvings) {
  if (glm::dot(bounds.centre - position, axis) < -bounds.radius) return {};
  return views_from(position, bounds, gpu::SHADOW_PATCH_SIZE >> halvings, gpu::SHADOW_PATCH_CUBE_SIZE >> halvings);
}

}  // namespace quadgraph
