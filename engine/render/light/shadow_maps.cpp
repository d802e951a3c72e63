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

// Made anew only where there is none of that size.
device::Image& ShadowMaps::image_for(std::size_t view, std::uint32_t size) {
  if (view < maps_.size() && maps_[view].options().width == size) return maps_[view];
  auto image = images_.find(size);
  if (image == images_.end()) image = images_.emplace(size, depth_image(device_, size)).first;
  if (image->second.address() == 0) return image->second;
  if (view >= maps_.size()) maps_.resize(view + 1);
  maps_[view] = std::move(image->second);
  images_.erase(image);
  return maps_[view];
}

const device::Buffer& ShadowMaps::buffer_for(std::size_t view, std::uint64_t bytes) {
  if (view >= depths_.size()) depths_.resize(view + 1);
  device::Buffer& depth = depths_[view];
  if (depth.size() != bytes) depth = {device_, bytes, device::Place::device, "shadows/map"};
  return depth;
}

PassStats ShadowMaps::update(const DisplayBuffers& mesh, const LightSet& lights) {
  std::vector<gpu::ShadowView> views = lights.views;
  PassStats stats{.name = "shadow maps"};
  device::Commands commands(device_, 1);
  commands.begin_pass(stats.name);
  if (maps_.size() > views.size()) maps_.resize(views.size());
  if (depths_.size() > views.size()) depths_.resize(views.size());
  for (std::size_t k = 0; k < views.size(); ++k) {
    gpu::ShadowView& view = views[k];
    const std::uint64_t map_bytes = std::uint64_t{view.size} * view.size * sizeof(float);
    const device::Image& image = image_for(k, view.size);
    const auto size = static_cast<float>(view.size);
    commands.draw({{}, &image}, {0, 0, size, size}, pass_,
                  gpu::ShadowPush{view.clip_from_world, mesh.vertices.address()}, &mesh.triangles,
                  3 * mesh.triangle_count);
    view.depth = image.address();
    stats.bytes += mesh.vertices.size() + mesh.triangles.size() + map_bytes;
    if (view.depth == 0) {
      const device::Buffer& depth = buffer_for(k, map_bytes);
      view.depth = depth.address();
      commands.copy(image, depth);
      stats.bytes += 2 * map_bytes;
    }
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
