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
// For each view ray: of pictures of several frames where the body is clear, since what is seen through facets differs
// much there, and along silhouettes; of those of a single frame along silhouettes.
constexpr std::uint32_t facets_of_several = 4, facets_of_edges = 16;

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

  std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  std::uint64_t samples() const { return 4 * pixels(); }
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
      seen_(std::make_unique<Targets>(device, device::Format::r32_uint, 1, seen_tile_pixels)),
      coverage_(device) {}

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

gpu::TilePixels Rasteriser::tile_pixels(const Targets& targets, const Tile& tile) const {
  return {.left = tile.x,
          .top = tile.y,
          .width = tile.width,
          .height = tile.height,
          .sample_stride = 2 * (targets.in_place() ? targets.width : tile.width),
          .picture_width = picture_.width,
          .picture_height = picture_.height};
}

gpu::ShadePush Rasteriser::shade_push(const RasterInput& input, const Tile& tile) const {
  const bool single = input.frame.count == 1;
  gpu::ShadePush push{.scene = scene_.address(),
                      .seen = seen_->address(0),
                      .marked = coverage_.marked(),
                      .coverage = coverage_.covered(),
                      .layers = {},
                      .alpha = picture_.alpha.address(),
                      .doubt = picture_.has_doubt ? picture_.doubt.address() : 0,
                      .tile = tile_pixels(*seen_, tile),
                      .frame = input.frame.index,
                      .facets = single ? 1 : facets_of_several,
                      .edge_facets = single ? facets_of_edges : facets_of_several,
                      .transmission = input.transmission_roughness.value_or(-1.0f)};
  for (std::size_t k = 0; k < PICTURE_LAYERS; ++k) push.layers[k] = picture_.layers[k].address();
  return push;
}

// To where shaders read them, if not in place.
void Rasteriser::copy_samples(device::Commands& commands, const Targets& targets, const Tile& tile) {
  for (std::size_t k = 0; k < targets.samples.size(); ++k) {
    commands.copy(targets.images[k], targets.samples[k], 2 * tile.width, 2 * tile.height);
  }
}

void Rasteriser::record_resolve(device::Commands& commands, const Tile& tile) {
  gpu::ResolvePush push{
      .samples = {}, .layers = {}, .alpha = picture_.alpha.address(), .tile = tile_pixels(*layers_, tile)};
  for (std::size_t k = 0; k < SAMPLE_LAYERS; ++k) push.samples[k] = layers_->address(k);
  for (std::size_t k = 0; k < PICTURE_LAYERS; ++k) push.layers[k] = picture_.layers[k].address();
  commands.begin_pass("resolve");
  copy_samples(commands, *layers_, tile);
  commands.dispatch(resolve_, push, tile.pixels());
  commands.end_pass();
}

void Rasteriser::record(device::Commands& commands, const RasterInput& input, const CoveragePlaces& places,
                        const Tile& tile) {
  if (!visibility_) visibility_.emplace(device_, visibility_options, "visibility");
  commands.begin_pass("visibility");
  commands.draw(target(*seen_, tile), viewport(tile), *visibility_, gpu::VisibilityPush{scene_.address()}, nullptr,
                3 * input.mesh.triangle_count);
  copy_samples(commands, *seen_, tile);
  commands.end_pass();
  coverage_.record(commands, tile_pixels(*seen_, tile), scene_.address(), seen_->address(0), input.mesh.triangle_count,
                   places);
  commands.begin_pass(input.gather != nullptr ? "gather" : "shading");
  commands.dispatch(shading(input), shade_push(input, tile), tile.pixels());
  commands.end_pass();
}

void Rasteriser::record(device::Commands& commands, const PathInput& input, const Tile& tile) {
  commands.begin_pass("surface");
  commands.draw(target(*layers_, tile), viewport(tile), surface(input),
                gpu::SurfacePathPush{scene_.address(), input.field.address()}, &input.mesh.triangles,
                3 * input.mesh.triangle_count);
  commands.end_pass();
  record_resolve(commands, tile);
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
  record_resolve(commands, tile);
}

// Adds up what the passes of every tile took: the first draws samples, the last one makes pixels of them.
template <typename Record>
std::vector<PassStats> Rasteriser::run_tiles(Targets& targets, std::size_t pass_count, std::uint32_t width,
                                             std::uint32_t height, const Record& record_tile) {
  picture_.resize(device_, width, height);
  if (picture_.has_doubt) picture_.make_room_doubt(device_);
  targets.make_room(width, height);
  std::vector<PassStats> passes(pass_count);
  const std::uint32_t side = targets.tile_pixels;
  for (std::uint32_t y = 0; y < height; y += side) {
    for (std::uint32_t x = 0; x < width; x += side) {
      const Tile tile{x, y, std::min(side, width - x), std::min(side, height - y)};
      device::Commands commands(device_, static_cast<std::uint32_t>(pass_count));
      record_tile(commands, tile);
      const auto times = commands.submit_and_wait();
      for (std::size_t k = 0; k < passes.size(); ++k) {
        passes[k].name = times[k].name;
        passes[k].time_ms += times[k].time_ms;
        ++passes[k].count;
      }
      const std::uint64_t colours = targets.images.size() * targets.bytes_of(tile.samples());
      passes.front().bytes += (targets.in_place() ? 1 : 3) * colours + 4 * tile.samples();  // copied; and depths
      passes.back().bytes += colours;                                                       // read
    }
  }
  const std::uint64_t doubt = picture_.has_doubt ? sizeof(gpu::PixelDoubt) : 0;
  passes.back().bytes += (12 * PICTURE_LAYERS + 4 + doubt) * picture_.pixels();
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
  auto passes = run_tiles(*layers_, 2, width, height,
                          [&](device::Commands& commands, const Tile& tile) { record(commands, input, tile); });
  picture_.false_colour = false;
  passes.front().bytes += passes.front().count * (64ull * input.mesh.vertex_count + input.mesh.triangles.size());
  return passes;
}

std::vector<PassStats> Rasteriser::run(const RasterInput& input, const Camera& camera, std::uint32_t width,
                                       std::uint32_t height) {
  write_scene(surface_scene(input, camera));
  picture_.has_doubt = input.gather != nullptr && input.gather->share != nullptr;
  coverage_.make_room(std::min(width, seen_tile_pixels), std::min(height, seen_tile_pixels));
  const CoveragePlaces places = coverage_places(input.frame, input.filter);
  auto passes = run_tiles(*seen_, 3, width, height,
                          [&](device::Commands& commands, const Tile& tile) { record(commands, input, places, tile); });
  picture_.false_colour = false;
  picture_.has_surroundings = false;
  // Bytes of the body are counted as if every vertex were read once.
  const std::uint64_t shape = input.mesh.vertices.size() + input.mesh.triangles.size(), tiles = passes.front().count;
  passes[0].bytes += tiles * shape;
  passes[1].bytes += tiles * shape + (sizeof(gpu::PixelCoverage) + 16) * picture_.pixels();
  passes[2].bytes += tiles * (64ull * input.mesh.vertex_count + input.mesh.triangles.size());
  if (input.gather != nullptr) passes[2].bytes += tiles * input.gather->field.points().size();
  return passes;
}

std::vector<PassStats> Rasteriser::run(const FalseColours& input, const Camera& camera, std::uint32_t width,
                                       std::uint32_t height) {
  if (!false_colour_) {
    false_colour_.emplace(device_, layers_options(shader::false_colour_vert, shader::false_colour_frag),
                          "false colour");
  }
  picture_.has_doubt = false;
  auto passes = run_tiles(*layers_, 2, width, height,
                          [&](device::Commands& commands, const Tile& tile) { record(commands, input, camera, tile); });
  picture_.false_colour = true;
  picture_.has_surroundings = false;
  passes.front().bytes += passes.front().count * input.vertices.size();
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
