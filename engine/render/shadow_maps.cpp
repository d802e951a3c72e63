#include "engine/render/shadow_maps.h"

#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

#include "engine/render/draw.h"
#include "spirv/shadow.vert.h"

namespace quadgraph {
namespace {

constexpr float four_pi = 12.5663706f;

// A direction that is safely not parallel to `axis`.
glm::vec3 any_up(const glm::vec3& axis) {
  return std::abs(axis.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
}

gpu::ShadowView directional_view(const Light& light, const Sphere& bounds) {
  gpu::ShadowView view{};
  view.size = gpu::SHADOW_SIZE;
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

std::vector<gpu::ShadowView> point_views(const Light& light, const Sphere& bounds) {
  const glm::vec3 to_centre = bounds.centre - light.position;
  const float distance = glm::length(to_centre), r = bounds.radius;
  if (distance > 1.1f * r) {
    const float half = r / std::sqrt(distance * distance - r * r);
    return {perspective_view(light.position, to_centre / distance, half, distance - 1.02f * r, distance + 1.02f * r,
                             gpu::SHADOW_SIZE)};
  }
  std::vector<gpu::ShadowView> views;
  for (int axis = 0; axis < 3; ++axis) {
    for (float sign : {1.0f, -1.0f}) {
      glm::vec3 direction(0);
      direction[axis] = sign;
      views.push_back(
          perspective_view(light.position, direction, 1.0f, 1e-3f * r, distance + 1.02f * r, gpu::SHADOW_CUBE_SIZE));
    }
  }
  return views;
}

template <typename T>
void replace(vk::Context& context, const std::vector<T>& values, const char* name, vk::Buffer& buffer) {
  if (buffer.handle() == VK_NULL_HANDLE || buffer.size() != values.size() * sizeof(T)) {
    buffer = {context, values.size() * sizeof(T), vk::Place::read, name};
  }
  vk::write_bytes(context, buffer, std::as_bytes(std::span(values)));
}

vk::Image depth_image(vk::Context& context, std::uint32_t size) {
  return {context, {VK_FORMAT_D32_SFLOAT, size, size, 1, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT}, "shadows/depth"};
}

}  // namespace

gpu::LightRecord light_record(const Light& light) {
  if (light.kind == LightKind::ambient) return {gpu::LIGHT_AMBIENT, glm::vec3(0), light.power, 0, 0};
  const bool point = light.kind == LightKind::point;
  return {point ? gpu::LIGHT_POINT : gpu::LIGHT_DIRECTIONAL, point ? light.position : -light.direction,
          point ? light.power / four_pi : light.power, 0, 0};
}

std::vector<gpu::ShadowView> shadow_views(const Light& light, const Sphere& bounds) {
  if (light.kind == LightKind::ambient) return {};
  if (light.kind == LightKind::directional) return {directional_view(light, bounds)};
  return point_views(light, bounds);
}

ShadowMaps::ShadowMaps(vk::Context& context)
    : context_(context),
      pass_(context,
            {.vertex = shadow_vert,
             .fragment = {},
             .push_size = sizeof(gpu::ShadowPush),
             .colour_formats = {},
             .cull = VK_CULL_MODE_FRONT_BIT},
            "shadow") {}

PassStats ShadowMaps::update(const DisplayBuffers& mesh, const Sphere& bounds, std::span<const Light> lights) {
  std::vector<gpu::LightRecord> records;
  std::vector<gpu::ShadowView> views;
  for (const Light& light : lights) {
    const auto own = shadow_views(light, bounds);
    records.push_back(light_record(light));
    records.back().first_view = static_cast<std::uint32_t>(views.size());
    records.back().view_count = static_cast<std::uint32_t>(own.size());
    views.insert(views.end(), own.begin(), own.end());
  }

  PassStats stats{.name = "shadow maps"};
  vk::Commands commands(context_, 1);
  commands.begin_pass(stats.name);
  depths_.resize(views.size());
  std::size_t number = 0;
  for (gpu::ShadowView& view : views) {
    const std::uint64_t map_bytes = std::uint64_t{view.size} * view.size * sizeof(float);
    auto image = images_.find(view.size);
    if (image == images_.end()) image = images_.emplace(view.size, depth_image(context_, view.size)).first;
    const auto size = static_cast<float>(view.size);
    draw(commands, {{}, &image->second}, {0, 0, size, size}, pass_,
         gpu::ShadowPush{view.clip_from_world, mesh.vertices.address()}, mesh.triangles, 3 * mesh.triangle_count);
    vk::Buffer& depth = depths_[number++];
    if (depth.size() != map_bytes) depth = {context_, map_bytes, vk::Place::read, "shadows/map"};
    view.depth = depth.address();
    commands.copy(image->second, depth);
    stats.bytes += mesh.vertices.size() + mesh.triangles.size() + 3 * map_bytes;
    ++stats.count;
  }
  commands.end_pass();
  stats.time_ms = commands.submit_and_wait()[0].time_ms;

  light_count_ = static_cast<std::uint32_t>(records.size());
  replace<gpu::LightRecord>(context_, records, "shadows/lights", lights_);
  replace<gpu::ShadowView>(context_, views, "shadows/views", views_);
  return stats;
}

}  // namespace quadgraph
