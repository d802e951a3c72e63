#include "engine/render/light/shadow_maps.h"

#include "engine/device/commands.h"
#include "interface/light/shadow.vert.h"

namespace quadgraph {
namespace {

device::Image depth_image(device::Device& device, std::uint32_t size) {
  return {device, {device::Format::depth32_float, size, size}, "shadows/depth"};
}

}  // namespace

ShadowMaps::ShadowMaps(device::Device& device)
    : device_(device),
      pass_(device, {.vertex = &shader::shadow_vert, .fragment = nullptr, .cull = device::Cull::front}, "shadow") {}

PassStats ShadowMaps::update(const DisplayBuffers& mesh, const LightSet& lights) {
  std::vector<gpu::ShadowView> views = lights.views;
  PassStats stats{.name = "shadow maps"};
  device::Commands commands(device_, 1);
  commands.begin_pass(stats.name);
  depths_.resize(views.size());
  std::size_t number = 0;
  for (gpu::ShadowView& view : views) {
    const std::uint64_t map_bytes = std::uint64_t{view.size} * view.size * sizeof(float);
    auto image = images_.find(view.size);
    if (image == images_.end()) image = images_.emplace(view.size, depth_image(device_, view.size)).first;
    const auto size = static_cast<float>(view.size);
    commands.draw({{}, &image->second}, {0, 0, size, size}, pass_,
                  gpu::ShadowPush{view.clip_from_world, mesh.vertices.address()}, &mesh.triangles,
                  3 * mesh.triangle_count);
    device::Buffer& depth = depths_[number++];
    if (depth.size() != map_bytes) depth = {device_, map_bytes, device::Place::device, "shadows/map"};
    view.depth = depth.address();
    commands.copy(image->second, depth);
    stats.bytes += mesh.vertices.size() + mesh.triangles.size() + 3 * map_bytes;
    ++stats.count;
  }
  commands.end_pass();
  stats.time_ms = commands.submit_and_wait()[0].time_ms;

  light_count_ = static_cast<std::uint32_t>(lights.records.size());
  shaped_ = lights.shaped;
  device::rewrite<gpu::LightRecord>(device_, lights.records, "shadows/lights", lights_);
  device::rewrite<gpu::LightShape>(device_, lights.shapes, "shadows/shapes", shapes_);
  device::rewrite<gpu::ShadowView>(device_, views, "shadows/views", views_);
  return stats;
}

}  // namespace quadgraph
