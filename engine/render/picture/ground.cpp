#include "engine/render/picture/ground.h"

#include <algorithm>
#include <cmath>

#include "engine/device/commands.h"
#include "interface/display/ground.comp.h"
#include "interface/display/ground_map.comp.h"
#include "interface/light/shadow.vert.h"
#include "shaders/display/ground_shared.h"

namespace quadgraph {
namespace {

constexpr float shadow_margin = 1.4f;  // of the map over the bounding sphere: where the shadow fades
constexpr float reach = 0.15f;         // radii

constexpr std::uint64_t texels = std::uint64_t{gpu::GROUND_SIZE} * gpu::GROUND_SIZE;

int axis_of(UpAxis up) {
  return up == UpAxis::z ? 2 : 1;
}

float lowest(device::Device& device, const DisplayBuffers& mesh, int axis) {
  float least = INFINITY;
  for (const glm::vec3& vertex : device::download<glm::vec3>(device, mesh.vertices))
    least = std::min(least, vertex[axis]);
  return least;
}

// Seen from below, first coordinate to the right, second (z, with y up) down the rows: depth 0 on the ground.
glm::mat4 from_below(const glm::vec3& middle, float half_width, float far, int axis) {
  const int second = axis == 1 ? 2 : 1;
  glm::mat4 clip(0);
  clip[0][0] = 1 / half_width;
  clip[second][1] = -1 / half_width;  // clip y is up, rows go down
  clip[axis][2] = 1 / far;
  clip[3] = {-middle.x / half_width, middle[second] / half_width, -middle[axis] / far, 1};
  return clip;
}

}  // namespace

Ground::Ground(device::Device& device)
    : device_(device),
      below_(device, {.vertex = &shader::shadow_vert, .fragment = nullptr, .cull = device::Cull::none},
             "ground from below"),
      map_(device, shader::ground_map),
      ground_(device, shader::ground),
      image_(device, {device::Format::depth32_float, gpu::GROUND_SIZE, gpu::GROUND_SIZE}, "picture/ground"),
      depth_(device, sizeof(float) * texels, device::Place::device, "picture/ground depth"),
      shadow_(device, sizeof(float) * texels, device::Place::device, "picture/ground shadow") {}

void Ground::make_map(const DisplayBuffers& mesh, const Sphere& bounds, UpAxis up) {
  const int axis = axis_of(up);
  middle_ = bounds.centre;
  middle_[axis] = lowest(device_, mesh, axis);
  half_width_ = shadow_margin * bounds.radius;
  light_half_width_ = gpu::GROUND_LIGHT_REACH * bounds.radius;
  const float far = 2.02f * bounds.radius, size = gpu::GROUND_SIZE;
  device::Commands commands(device_);
  commands.draw({{}, &image_}, {0, 0, size, size}, below_,
                gpu::ShadowPush{from_below(middle_, half_width_, far, axis), mesh.vertices.address()}, &mesh.triangles,
                3 * mesh.triangle_count);
  commands.copy(image_, depth_);
  commands.dispatch(
      map_,
      gpu::GroundMapPush{
          .depth = depth_.address(), .shadow = shadow_.address(), .far = far, .reach = reach * bounds.radius},
      texels);
  commands.submit_and_wait();
  made_for_ = up;
  lit_ = false;
}

void Ground::record_light(device::Commands& commands, const GroundSource& source) {
  if (!light_) light_.emplace(device_, source.at_rest);
  commands.begin_pass("ground light");
  light_->record(commands, source, {middle_, light_half_width_, made_for_ == UpAxis::z});
  commands.end_pass();
  lit_ = true;
}

std::vector<PassStats> Ground::run(const DisplayBuffers& mesh, const Sphere& bounds, const View& view,
                                   const Camera& camera, const PictureBuffers& picture,
                                   const std::optional<GroundSource>& source) {
  if (made_for_ != view.up) make_map(mesh, bounds, view.up);
  device::Commands commands(device_, 2);
  const bool relit = source && !lit_;
  if (relit) record_light(commands, *source);
  const glm::vec3 right = static_cast<float>(camera.half_width) * camera.right;
  const glm::vec3 up = static_cast<float>(camera.half_height) * camera.up;
  const gpu::GroundPush push{.shadow = shadow_.address(),
                             .light = source ? light_->light().address() : 0,
                             .scattered = picture.layers[0].address(),
                             .alpha = picture.alpha.address(),
                             .target = camera.target - glm::dvec3(middle_),
                             .corner = up - right,
                             .right = 2.0f * right,
                             .down = -2.0f * up,
                             .ahead = camera.ahead,
                             .spread = camera.parallel ? 0.0f : static_cast<float>(1 / camera.distance),
                             .half_width = half_width_,
                             .light_half_width = light_half_width_,
                             .z_up = view.up == UpAxis::z ? 1u : 0u,
                             .width = picture.width,
                             .height = picture.height};
  commands.begin_pass("ground");
  const int axis = axis_of(view.up);
  const bool from_above = camera.parallel || camera.eye[axis] > double{middle_[axis]};
  if (from_above) commands.dispatch(ground_, push, picture.pixels());
  commands.end_pass();
  const auto times = commands.submit_and_wait();
  std::vector<PassStats> passes;
  if (relit) passes.push_back({"ground light", times.front().time_ms, light_->bytes(), 1});
  passes.push_back({"ground", times.back().time_ms, 8 * sizeof(float) * picture.pixels(), 1});
  return passes;
}

}  // namespace quadgraph
