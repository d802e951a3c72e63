#include "engine/render/light/shadow_maps.h"

#include <algorithm>
#include <cstring>

#include "engine/device/commands.h"
#include "interface/light/shadow.vert.h"

namespace quadgraph {
namespace {

constexpr std::size_t most_own = 128;                            // views, each with a buffer of its own
constexpr std::uint64_t shared_bytes = std::uint64_t{64} << 20;  // of a buffer that views share
constexpr std::size_t views_at_once = 1024;                      // in one submission

std::uint64_t bytes_of(const gpu::ShadowView& view) {
  return std::uint64_t{view.size} * view.size * sizeof(float);
}

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

// Buffers for the maps of all views, and where in them each lies.
void ShadowMaps::make_places(const std::vector<gpu::ShadowView>& views) {
  const bool shared = views.size() > most_own;
  std::vector<std::uint64_t> sizes;
  places_.clear();
  for (const gpu::ShadowView& view : views) {
    const std::uint64_t bytes = bytes_of(view);
    if (sizes.empty() || !shared || sizes.back() + bytes > shared_bytes) sizes.push_back(0);
    places_.push_back({sizes.size() - 1, sizes.back()});
    sizes.back() += bytes;
  }
  depths_.resize(sizes.size());
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    if (depths_[k].size() == sizes[k]) continue;
    depths_[k] = {device_, sizes[k], device::Place::device, "shadows/map"};
    for (std::size_t view = 0; view < drawn_.size(); ++view) {
      if (places_[view].buffer == k) drawn_[view].size = 0;
    }
  }
  if (!shared) whole_.clear();
}

std::uint64_t ShadowMaps::address_of(const Place& place) const {
  return depths_[place.buffer].address() + place.offset;
}

// The address of the copy. An image fills the beginning of a buffer, so that it reaches a shared one by way of another.
std::uint64_t ShadowMaps::copy_to_place(device::Commands& commands, const device::Image& image, std::size_t view) {
  const Place& place = places_[view];
  const device::Buffer& target = depths_[place.buffer];
  const std::uint32_t size = image.options().width;
  const std::uint64_t bytes = std::uint64_t{size} * size * sizeof(float);
  if (target.size() == bytes) {
    commands.copy(image, target);
  } else {
    device::Buffer& whole = whole_[size];
    if (!whole.exists()) whole = {device_, bytes, device::Place::device, "shadows/whole"};
    commands.copy(image, whole);
    commands.copy(whole, target, bytes, place.offset);
  }
  return address_of(place);
}

// The address of the map that shows what is wanted; 0 where it is to be drawn.
std::uint64_t ShadowMaps::take_drawn(std::size_t view, gpu::ShadowView wanted) {
  if (view >= drawn_.size()) return 0;
  wanted.depth = view < maps_.size() ? maps_[view].address() : address_of(places_[view]);
  gpu::ShadowView& shown = drawn_[view];
  if (std::memcmp(&shown, &wanted, sizeof(wanted)) == 0) return shown.depth;
  shown.size = 0;
  return 0;
}

PassStats ShadowMaps::draw(const DisplayBuffers& mesh, std::span<gpu::ShadowView> views, std::size_t first) {
  PassStats stats{.name = "shadow maps"};
  device::Commands commands(device_, 1);
  commands.begin_pass(stats.name);
  for (std::size_t k = 0; k < views.size(); ++k) {
    gpu::ShadowView& view = views[k];
    view.depth = take_drawn(first + k, view);
    if (view.depth != 0) continue;
    const std::uint64_t map_bytes = bytes_of(view);
    const device::Image& image = image_for(first + k, view.size);
    const auto size = static_cast<float>(view.size);
    commands.draw({{}, &image}, {0, 0, size, size}, pass_,
                  gpu::ShadowPush{view.clip_from_world, mesh.vertices.address()}, &mesh.triangles,
                  3 * mesh.triangle_count);
    view.depth = image.address();
    stats.bytes += mesh.vertices.size() + mesh.triangles.size() + map_bytes;
    if (view.depth == 0) {
      view.depth = copy_to_place(commands, image, first + k);
      stats.bytes += 2 * map_bytes;
    }
    ++stats.count;
  }
  commands.end_pass();
  stats.time_ms = commands.submit_and_wait()[0].time_ms;
  return stats;
}

PassStats ShadowMaps::update(const DisplayBuffers& mesh, const LightSet& lights) {
  std::vector<gpu::ShadowView> views = lights.views;
  if (maps_.size() > views.size()) maps_.resize(views.size());
  if (drawn_.size() > views.size()) drawn_.resize(views.size());
  if (views.empty() || image_for(0, views[0].size).address() == 0) make_places(views);
  PassStats stats{.name = "shadow maps"};
  for (std::size_t first = 0; first < views.size(); first += views_at_once) {
    const std::size_t count = std::min(views_at_once, views.size() - first);
    const PassStats part = draw(mesh, std::span(views).subspan(first, count), first);
    stats.time_ms += part.time_ms;
    stats.bytes += part.bytes;
    stats.count += part.count;
  }
  drawn_ = views;

  light_count_ = static_cast<std::uint32_t>(lights.records.size());
  shaped_ = lights.shaped;
  device::rewrite<gpu::LightRecord>(device_, lights.records, "shadows/lights", lights_);
  device::rewrite<gpu::LightShape>(device_, lights.shapes, "shadows/shapes", shapes_);
  device::rewrite<gpu::ShadowView>(device_, views, "shadows/views", views_);
  return stats;
}

}  // namespace quadgraph
