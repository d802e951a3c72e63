#include "engine/render/picture/rasteriser.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "engine/render/picture/surface_scene.h"
#include "interface/display/false_colour.frag.h"
#include "interface/display/false_colour.vert.h"
#include "interface/display/gather.comp.h"
#include "interface/display/resolve.comp.h"
#include "interface/display/shading.comp.h"
#include "interface/display/surface_path.frag.h"
#include "interface/display/surface_path.vert.h"
#include "interface/display/visibility.frag.h"
#include "interface/display/visibility.vert.h"
#include "shaders/path/path_light_shared.h"

namespace quadgraph {
namespace {

// Per side: 48 bytes a sample are 48 MiB, and 4 bytes a sample 16 MiB, without what they are copied to.
constexpr std::uint32_t layers_tile_pixels = 512, seen_tile_pixels = 1024;
// Of pictures of several frames, for each view ray: what is seen through them differs much.
constexpr std::uint32_t facets_where_clear = 4;

// Of what draws layers of samples.
device::GraphicsOptions layers_options(const device::Shader& vertex, const device::Shader& fragment,
                                       std::uint32_t variant = 0) {
  return {.vertex = &vertex,
          .fragment = &fragment,
          .colours = SAMPLE_LAYERS,
          .cull = device::Cull::none,
          .variant = variant,
          .depth = device::Depth::falls};
}

const device::GraphicsOptions visibility_options{.vertex = &shader::visibility_vert,
                                                 .fragment = &shader::visibility_frag,
                                                 .colours = 1,
                                                 .colour = device::Format::r32_uint,
                                                 .depth = device::Depth::falls};

}  // namespace

struct Rasteriser::Tile {
  std::uint32_t x, y, width, height;  // pixels inside the picture

  std::uint64_t samples() const { return 4ull * width * height; }
};

// What tiles are drawn into: images of one kind, which shaders read in place or copies of.
struct Rasteriser::Targets {
  Targets(device::Device& its_device, device::Format its_format, std::uint32_t its_images, std::uint32_t most)
      : device(its_device), format(its_format), images_each(its_images), tile_pixels(most) {}

  // For tiles of a picture of that size.
  void make_room(std::uint32_t picture_width, std::uint32_t picture_height) {
    const std::uint32_t wide = std::max(width, std::min(picture_width, tile_pixels)),
                        high = std::max(height, std::min(picture_height, tile_pixels));
    if (made && wide == width && high == height) return;
    made = false;
    width = wide;
    height = high;
    images.clear();
    samples.clear();
    depth.emplace(device, image_options(device::Format::depth32_float), "picture/depth");
    for (std::uint32_t k = 0; k < images_each; ++k) {
      images.emplace_back(device, image_options(format), "picture/samples");
      if (in_place()) continue;
      samples.emplace_back(device, bytes_of(4ull * width * height), device::Place::device, "picture/samples");
    }
    made = true;
  }

  device::ImageOptions image_options(device::Format of) const { return {of, 2 * width, 2 * height}; }
  bool in_place() const { return images.front().address() != 0; }
  std::uint64_t bytes_of(std::uint64_t count) const {  // samples, in one image
    return device::texel_bytes(format) * count;
  }

  // Where a shader reads the samples of image k.
  std::uint64_t address(std::size_t k) const { return in_place() ? images[k].address() : samples[k].address(); }

  device::Device& device;
  const device::Format format;
  const std::uint32_t images_each, tile_pixels;  // pixels per side, at most
  bool made = false;                             // all of what follows, for the next
  std::uint32_t width = 0, height = 0;           // pixels of 2 x 2 samples
  std::vector<device::Image> images;
  std::optional<device::Image> depth;
  std::vector<device::Buffer> samples;  // of what a tile covers, where images are not read in place
};

Rasteriser::Rasteriser(device::Device& device)
    : device_(device),
      resolve_(device, shader::resolve),
      layers_(std::make_unique<Targets>(device, device::Format::rgba32_float, SAMPLE_LAYERS, layers_tile_pixels)),
      seen_(std::make_unique<Targets>(device, device::Format::r32_uint, 1, seen_tile_pixels)) {}

const device::GraphicsPass& Rasteriser::surface(const PathInput& input) {
  auto& pass = paths_[input.shadows.shaped() ? 1 : 0];
  if (pass) return *pass;
  return pass.emplace(device_,
                      layers_options(shader::surface_path_vert, shader::surface_path_frag, input.shadows.shaped()),
                      "surface of cells");
}

const device::ComputePass& Rasteriser::shading(const RasterInput& input) {
  const std::uint32_t shaped = input.shadows.shaped() ? 1 : 0;
  auto& pass = shadings_[2 * shaped + (input.gather != nullptr ? 1 : 0)];
  if (pass) return *pass;
  const device::Shader& shader = input.gather != nullptr ? shader::gather : shader::shading;
  return pass.emplace(device_, shader, device::ComputeOptions{.variant = shaped});
}

Rasteriser::~Rasteriser() = default;

device::Viewport Rasteriser::viewport(const Tile& tile) const {
  return {-2.0f * static_cast<float>(tile.x), -2.0f * static_cast<float>(tile.y),
          2.0f * static_cast<float>(picture_.width), 2.0f * static_cast<float>(picture_.height)};
}

device::DrawTarget Rasteriser::target(const Targets& targets, const Tile& tile) {
  device::DrawTarget target{{}, &*targets.depth, 2 * tile.width, 2 * tile.height};
  for (const device::Image& image : targets.images) target.colours.push_back(&image);
  return target;
}

gpu::ResolvePush Rasteriser::resolve_push(const Targets& targets, const Tile& tile) const {
  gpu::ResolvePush resolve{.scene = scene_.address(),
                           .seen = 0,
                           .samples = {},
                           .layers = {},
                           .alpha = picture_.alpha.address(),
                           .doubt = picture_.has_doubt ? picture_.doubt.address() : 0,
                           .tile_x = tile.x,
                           .tile_y = tile.y,
                           .tile_width = tile.width,
                           .tile_height = tile.height,
                           .sample_stride = 2 * (targets.in_place() ? targets.width : tile.width),
                           .picture_width = picture_.width,
                           .picture_height = picture_.height,
                           .frame = 0,
                           .facets = 1,
                           .transmission = 0};
  for (std::size_t k = 0; k < PICTURE_LAYERS; ++k) resolve.layers[k] = picture_.layers[k].address();
  if (&targets == seen_.get()) {
    resolve.seen = targets.address(0);
  } else {
    for (std::size_t k = 0; k < SAMPLE_LAYERS; ++k) resolve.samples[k] = targets.address(k);
  }
  return resolve;
}

void Rasteriser::record_resolve(device::Commands& commands, const char* name, const device::ComputePass& pass,
                                const Targets& targets, const gpu::ResolvePush& push) {
  commands.begin_pass(name);
  for (std::size_t k = 0; k < targets.samples.size(); ++k) {
    commands.copy(targets.images[k], targets.samples[k], 2 * push.tile_width, 2 * push.tile_height);
  }
  commands.dispatch(pass, push, std::uint64_t{push.tile_width} * push.tile_height);
  commands.end_pass();
}

void Rasteriser::record(device::Commands& commands, const RasterInput& input, const Tile& tile) {
  if (!visibility_) visibility_.emplace(device_, visibility_options, "visibility");
  commands.begin_pass("visibility");
  commands.draw(target(*seen_, tile), viewport(tile), *visibility_, gpu::VisibilityPush{scene_.address()}, nullptr,
                3 * input.mesh.triangle_count);
  commands.end_pass();
  gpu::ResolvePush push = resolve_push(*seen_, tile);
  push.frame = input.frame;
  push.facets = input.single_frame ? 1 : facets_where_clear;
  push.transmission = input.transmission_roughness.value_or(-1.0f);
  record_resolve(commands, input.gather != nullptr ? "gather" : "shading", shading(input), *seen_, push);
}

void Rasteriser::record(device::Commands& commands, const PathInput& input, const Tile& tile) {
  commands.begin_pass("surface");
  commands.draw(target(*layers_, tile), viewport(tile), surface(input),
                gpu::SurfacePathPush{scene_.address(), input.field.address()}, &input.mesh.triangles,
                3 * input.mesh.triangle_count);
  commands.end_pass();
  record_resolve(commands, "resolve", resolve_, *layers_, resolve_push(*layers_, tile));
}

void Rasteriser::record(device::Commands& commands, const FalseColours& input, const Camera& camera, const Tile& tile) {
  const gpu::FalseColourPush push{.clip_from_offset = camera.clip_from_offset,
                                  .vertices = input.vertices.address(),
                                  .origin = camera.origin,
                                  .eye = camera.seen_from(),
                                  .plane = input.plane,
                                  .diverging = input.diverging ? 1u : 0u};
  commands.begin_pass("false colour");
  commands.draw(target(*layers_, tile), viewport(tile), *false_colour_, push, &input.indices, input.vertex_count);
  commands.end_pass();
  record_resolve(commands, "resolve", resolve_, *layers_, resolve_push(*layers_, tile));
}

// Adds up what the two passes of every tile took.
template <typename Record>
std::vector<PassStats> Rasteriser::run_tiles(Targets& targets, std::uint32_t width, std::uint32_t height,
                                             const Record& record_tile) {
  picture_.resize(device_, width, height);
  if (picture_.has_doubt) picture_.make_room_doubt(device_);
  targets.make_room(width, height);
  std::vector<PassStats> passes(2);
  const std::uint32_t side = targets.tile_pixels;
  for (std::uint32_t y = 0; y < height; y += side) {
    for (std::uint32_t x = 0; x < width; x += side) {
      const Tile tile{x, y, std::min(side, width - x), std::min(side, height - y)};
      device::Commands commands(device_, 2);
      record_tile(commands, tile);
      const auto times = commands.submit_and_wait();
      for (std::size_t k = 0; k < passes.size(); ++k) {
        passes[k].name = times[k].name;
        passes[k].time_ms += times[k].time_ms;
        ++passes[k].count;
      }
      const std::uint64_t colours = targets.images.size() * targets.bytes_of(tile.samples());
      passes[0].bytes += colours + 4 * tile.samples();            // and depths
      passes[1].bytes += (targets.in_place() ? 1 : 3) * colours;  // read; copied before
    }
  }
  const std::uint64_t doubt = picture_.has_doubt ? sizeof(gpu::PixelDoubt) : 0;
  passes[1].bytes += (12 * PICTURE_LAYERS + 4 + doubt) * picture_.pixels();
  return passes;
}

void Rasteriser::write_scene(const gpu::SurfaceScene& scene) {
  if (scene_.size() == 0) scene_ = {device_, sizeof(gpu::SurfaceScene), device::Place::device, "picture/scene"};
  device::write_bytes(device_, scene_, std::as_bytes(std::span(&scene, 1)));
}

std::vector<PassStats> Rasteriser::run(const PathInput& input, const Camera& camera, std::uint32_t width,
                                       std::uint32_t height) {
  write_scene(surface_scene(input, camera));
  picture_.has_doubt = false;
  auto passes = run_tiles(*layers_, width, height,
                          [&](device::Commands& commands, const Tile& tile) { record(commands, input, tile); });
  picture_.false_colour = false;
  passes[0].bytes += passes[0].count * (64ull * input.mesh.vertex_count + input.mesh.triangles.size());
  return passes;
}

std::vector<PassStats> Rasteriser::run(const RasterInput& input, const Camera& camera, std::uint32_t width,
                                       std::uint32_t height) {
  write_scene(surface_scene(input, camera));
  picture_.has_doubt = input.gather != nullptr && input.gather->share != nullptr;
  auto passes = run_tiles(*seen_, width, height,
                          [&](device::Commands& commands, const Tile& tile) { record(commands, input, tile); });
  picture_.false_colour = false;
  picture_.has_surroundings = false;
  passes[0].bytes += passes[0].count * (input.mesh.vertices.size() + input.mesh.triangles.size());
  passes[1].bytes += passes[1].count * (64ull * input.mesh.vertex_count + input.mesh.triangles.size());
  // Bytes of the body are counted as if every vertex were read once.
  if (input.gather != nullptr) passes[1].bytes += passes[1].count * input.gather->field.points().size();
  return passes;
}

std::vector<PassStats> Rasteriser::run(const FalseColours& input, const Camera& camera, std::uint32_t width,
                                       std::uint32_t height) {
  if (!false_colour_) {
    false_colour_.emplace(device_, layers_options(shader::false_colour_vert, shader::false_colour_frag),
                          "false colour");
  }
  picture_.has_doubt = false;
  auto passes = run_tiles(*layers_, width, height,
                          [&](device::Commands& commands, const Tile& tile) { record(commands, input, camera, tile); });
  picture_.false_colour = true;
  picture_.has_surroundings = false;
  passes[0].bytes += passes[0].count * input.vertices.size();
  return passes;
}

FalseColours upload_false_colours(device::Device& device, const FalseMesh& mesh, const Plane& plane, bool diverging) {
  std::vector<std::uint32_t> indices(mesh.size());
  std::iota(indices.begin(), indices.end(), 0u);
  return {.vertices = device::upload<gpu::FalseVertex>(device, mesh, "picture/inside"),
          .indices = device::upload<std::uint32_t>(device, indices, "picture/inside"),
          .vertex_count = static_cast<std::uint32_t>(mesh.size()),
          .plane = plane,
          .diverging = diverging};
}

}  // namespace quadgraph
