#include "engine/render/picture/rasteriser.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>
#include <span>

#include "engine/optics/fresnel.h"
#include "interface/display/false_colour.frag.h"
#include "interface/display/false_colour.vert.h"
#include "interface/display/gather.comp.h"
#include "interface/display/resolve.comp.h"
#include "interface/display/surface.frag.h"
#include "interface/display/surface.vert.h"
#include "interface/display/surface_gathered.frag.h"
#include "interface/display/surface_gathered.vert.h"
#include "interface/display/surface_path.frag.h"
#include "interface/display/surface_path.vert.h"
#include "shaders/path/path_light_shared.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t tile_pixels = 512;  // per side; 96 MiB of samples
// Of pictures of several frames, for each view ray: what is seen through them differs much.
constexpr std::uint32_t facets_where_clear = 4;

gpu::NormalMapRef normal_map(const PlacedNormals* placed) {
  if (placed == nullptr) return {};
  return {.rest = placed->rest.address(),
          .texels = placed->texels.address(),
          .image = placed->image,
          .box = placed->box,
          .strength = placed->strength,
          .by_mesh = placed->by_mesh ? 1u : 0u};
}

gpu::SurfaceScene scene(const RasterInput& input, const Camera& camera) {
  gpu::SurfaceScene scene{.clip_from_offset = camera.clip_from_offset,
                          .origin = camera.origin,
                          .eye = camera.seen_from(),
                          .reach = camera.reach,
                          .eta = 0,
                          .radiance_norm = 0,
                          .roughness = input.roughness,
                          .mirrored = input.mirrored,
                          .light_count = input.shadows.light_count(),
                          .vertices = input.mesh.vertices.address(),
                          .normals = input.mesh.normals.address(),
                          .face = input.mesh.face.address(),
                          .barycentric = input.mesh.barycentric.address(),
                          .faces = input.finest.faces.address(),
                          .face_kinds = input.finest.face_kind.address(),
                          .exitance = input.vertex_exitance.address(),
                          .unscattered = input.vertex_unscattered.address(),
                          .sky = input.finest.sky.address(),
                          .lights = input.shadows.lights().address(),
                          .shapes = input.shadows.shapes().address(),
                          .views = input.shadows.views().address(),
                          .triangles = input.mesh.triangles.address(),
                          .triangle_face = 0,
                          .points = 0,
                          .scale = 0,
                          .share = 0,
                          .elsewhere = {},
                          .solid = {},
                          .normal_map = normal_map(input.placed_normals)};
  if (input.gather != nullptr) {
    scene.triangle_face = input.gather->triangle_face.address();
    scene.points = input.gather->field.points().address();
    scene.scale = input.gather->field.scale().address();
    scene.solid = input.gather->field.solid();
    if (input.gather->share != nullptr) scene.share = input.gather->share->address();
    const device::Buffer* elsewhere = input.gather->elsewhere;
    for (std::uint64_t k = 0; elsewhere != nullptr && k < gpu::DOUBT_SAMPLES; ++k) {
      scene.elsewhere[k] = elsewhere->address() + k * (elsewhere->size() / gpu::DOUBT_SAMPLES);
    }
  }
  return scene;
}

gpu::SurfacePush surface_push(std::uint64_t scene, const PlacedRoughness* placed) {
  gpu::SurfacePush push{.scene = scene, .rest = 0, .texels = 0, .image = {}, .box = {}, .roughness = 0};
  if (placed == nullptr) return push;
  push.rest = placed->rest.address();
  push.texels = placed->texels.address();
  push.image = placed->image;
  push.box = placed->box;
  push.roughness = placed->roughness;
  return push;
}

gpu::SurfaceScene scene(const PathInput& input, const Camera& camera) {
  gpu::SurfaceScene scene{};
  scene.clip_from_offset = camera.clip_from_offset;
  scene.origin = camera.origin;
  scene.eye = camera.seen_from();
  scene.reach = camera.reach;
  scene.eta = input.eta;
  scene.roughness = input.roughness;
  scene.mirrored = input.mirrored;
  scene.normal_map = normal_map(input.placed_normals);
  scene.radiance_norm = static_cast<float>(radiance_norm(input.eta));
  scene.light_count = input.shadows.light_count();
  scene.vertices = input.mesh.vertices.address();
  scene.normals = input.mesh.normals.address();
  scene.lights = input.shadows.lights().address();
  scene.shapes = input.shadows.shapes().address();
  scene.views = input.shadows.views().address();
  return scene;
}

template <typename Input>
std::uint32_t variant_of(const Input& input) {
  return (input.shadows.shaped() ? VARIANT_SHAPED : 0u) |
         (input.placed_roughness != nullptr ? VARIANT_PLACED_ROUGHNESS : 0u) |
         (input.placed_normals != nullptr ? VARIANT_NORMAL_MAP : 0u);
}

device::GraphicsOptions pass_options(const device::Shader& vertex, const device::Shader& fragment,
                                     std::uint32_t variant = 0) {
  return {.vertex = &vertex,
          .fragment = &fragment,
          .colours = SAMPLE_LAYERS,
          .variant = variant,
          .depth = device::Depth::falls};
}

}  // namespace

struct Rasteriser::Tile {
  std::uint32_t x, y, width, height;  // pixels inside the picture

  std::uint64_t sample_bytes() const { return 64ull * width * height; }
};

// For tiles of up to as many pixels.
struct Rasteriser::Targets {
  Targets(device::Device& device, std::uint32_t tile_width, std::uint32_t tile_height)
      : width(tile_width),
        height(tile_height),
        depth(device, image_options(device::Format::depth32_float), "picture/depth") {
    for (int k = 0; k < SAMPLE_LAYERS; ++k) {
      images.emplace_back(device, image_options(device::Format::rgba32_float), "picture/samples");
      if (in_place()) continue;
      samples.emplace_back(device, 64ull * width * height, device::Place::device, "picture/samples");
    }
  }

  device::ImageOptions image_options(device::Format format) const { return {format, 2 * width, 2 * height}; }
  bool in_place() const { return images.front().address() != 0; }  // images are read, not copies of them

  std::uint32_t width, height;  // pixels of 2 x 2 samples
  std::vector<device::Image> images;
  device::Image depth;
  std::vector<device::Buffer> samples;  // the same, of what a tile covers, where images are not read in place
};

Rasteriser::Rasteriser(device::Device& device) : device_(device), resolve_(device, shader::resolve) {}

const device::GraphicsPass& Rasteriser::surface(const RasterInput& input) {
  const bool gathered = input.gather != nullptr;
  const std::uint32_t variant = variant_of(input);
  auto& pass = surfaces_[(gathered ? 1 : 0) + 2 * variant];
  if (pass) return *pass;
  if (!gathered)
    return pass.emplace(device_, pass_options(shader::surface_vert, shader::surface_frag, variant), "surface");
  return pass.emplace(device_, pass_options(shader::surface_gathered_vert, shader::surface_gathered_frag, variant),
                      "surface gathered");
}

const device::GraphicsPass& Rasteriser::surface(const PathInput& input) {
  const std::uint32_t variant = variant_of(input);
  auto& pass = paths_[variant];
  if (pass) return *pass;
  device::GraphicsOptions options = pass_options(shader::surface_path_vert, shader::surface_path_frag, variant);
  options.cull = device::Cull::none;
  return pass.emplace(device_, options, "surface of cells");
}

const device::ComputePass& Rasteriser::resolve(const RasterInput& input) {
  if (input.gather == nullptr) return resolve_;
  const std::uint32_t shaped = input.shadows.shaped() ? 1 : 0;
  auto& pass = gathers_[shaped];
  if (pass) return *pass;
  return pass.emplace(device_, shader::gather, device::ComputeOptions{.variant = shaped});
}

Rasteriser::~Rasteriser() = default;

void Rasteriser::make_room(std::uint32_t width, std::uint32_t height) {
  picture_.resize(device_, width, height);
  if (picture_.has_doubt) picture_.make_room_doubt(device_);
  std::uint32_t tile_width = std::min(width, tile_pixels), tile_height = std::min(height, tile_pixels);
  if (targets_ && targets_->width >= tile_width && targets_->height >= tile_height) return;
  if (targets_) {
    tile_width = std::max(tile_width, targets_->width);
    tile_height = std::max(tile_height, targets_->height);
    targets_.reset();
  }
  targets_ = std::make_unique<Targets>(device_, tile_width, tile_height);
}

device::Viewport Rasteriser::viewport(const Tile& tile) const {
  return {-2.0f * static_cast<float>(tile.x), -2.0f * static_cast<float>(tile.y),
          2.0f * static_cast<float>(picture_.width), 2.0f * static_cast<float>(picture_.height)};
}

device::DrawTarget Rasteriser::target(const Tile& tile) const {
  device::DrawTarget target{{}, &targets_->depth, 2 * tile.width, 2 * tile.height};
  for (const device::Image& image : targets_->images) target.colours.push_back(&image);
  return target;
}

gpu::ResolvePush Rasteriser::resolve_push(std::uint64_t scene, const Tile& tile) const {
  gpu::ResolvePush resolve{.scene = scene,
                           .samples = {},
                           .layers = {},
                           .alpha = picture_.alpha.address(),
                           .doubt = picture_.has_doubt ? picture_.doubt.address() : 0,
                           .tile_x = tile.x,
                           .tile_y = tile.y,
                           .tile_width = tile.width,
                           .tile_height = tile.height,
                           .sample_stride = 2 * (targets_->in_place() ? targets_->width : tile.width),
                           .picture_width = picture_.width,
                           .frame = 0,
                           .facets = 1,
                           .transmission = 0};
  for (std::size_t k = 0; k < PICTURE_LAYERS; ++k) resolve.layers[k] = picture_.layers[k].address();
  for (std::size_t k = 0; k < SAMPLE_LAYERS; ++k) {
    resolve.samples[k] = targets_->in_place() ? targets_->images[k].address() : targets_->samples[k].address();
  }
  return resolve;
}

void Rasteriser::record_resolve(device::Commands& commands, const char* name, const device::ComputePass& pass,
                                const gpu::ResolvePush& push) {
  commands.begin_pass(name);
  for (std::size_t k = 0; !targets_->in_place() && k < SAMPLE_LAYERS; ++k) {
    commands.copy(targets_->images[k], targets_->samples[k], 2 * push.tile_width, 2 * push.tile_height);
  }
  commands.dispatch(pass, push, std::uint64_t{push.tile_width} * push.tile_height);
  commands.end_pass();
}

void Rasteriser::record(device::Commands& commands, const RasterInput& input, const Tile& tile) {
  commands.begin_pass("surface");
  commands.draw(target(tile), viewport(tile), surface(input), surface_push(scene_.address(), input.placed_roughness),
                input.gather != nullptr ? nullptr : &input.mesh.triangles, 3 * input.mesh.triangle_count);
  commands.end_pass();
  gpu::ResolvePush push = resolve_push(scene_.address(), tile);
  push.frame = input.frame;
  push.facets = input.single_frame ? 1 : facets_where_clear;
  push.transmission = input.transmission_roughness.value_or(-1.0f);
  record_resolve(commands, input.gather != nullptr ? "gather" : "resolve", resolve(input), push);
}

void Rasteriser::record(device::Commands& commands, const PathInput& input, const Tile& tile) {
  commands.begin_pass("surface");
  commands.draw(target(tile), viewport(tile), surface(input),
                gpu::SurfacePathPush{surface_push(scene_.address(), input.placed_roughness), input.field.address()},
                &input.mesh.triangles, 3 * input.mesh.triangle_count);
  commands.end_pass();
  record_resolve(commands, "resolve", resolve_, resolve_push(scene_.address(), tile));
}

void Rasteriser::record(device::Commands& commands, const FalseColours& input, const Camera& camera, const Tile& tile) {
  const gpu::FalseColourPush push{.clip_from_offset = camera.clip_from_offset,
                                  .vertices = input.vertices.address(),
                                  .origin = camera.origin,
                                  .eye = camera.seen_from(),
                                  .plane = input.plane,
                                  .diverging = input.diverging ? 1u : 0u};
  commands.begin_pass("false colour");
  commands.draw(target(tile), viewport(tile), *false_colour_, push, &input.indices, input.vertex_count);
  commands.end_pass();
  record_resolve(commands, "resolve", resolve_, resolve_push(scene_.address(), tile));
}

// Adds up what the two passes of every tile took.
template <typename Record>
std::vector<PassStats> Rasteriser::run_tiles(std::uint32_t width, std::uint32_t height, const Record& record_tile) {
  make_room(width, height);
  std::vector<PassStats> passes(2);
  for (std::uint32_t y = 0; y < height; y += tile_pixels) {
    for (std::uint32_t x = 0; x < width; x += tile_pixels) {
      const Tile tile{x, y, std::min(tile_pixels, width - x), std::min(tile_pixels, height - y)};
      device::Commands commands(device_, 2);
      record_tile(commands, tile);
      const auto times = commands.submit_and_wait();
      for (std::size_t k = 0; k < passes.size(); ++k) {
        passes[k].name = times[k].name;
        passes[k].time_ms += times[k].time_ms;
        ++passes[k].count;
      }
      passes[0].bytes += (2 * SAMPLE_LAYERS + 1) * tile.sample_bytes() / 2;
      passes[1].bytes += (targets_->in_place() ? 1 : 3) * SAMPLE_LAYERS * tile.sample_bytes();  // read; copied before
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
  write_scene(scene(input, camera));
  picture_.has_doubt = false;
  auto passes =
      run_tiles(width, height, [&](device::Commands& commands, const Tile& tile) { record(commands, input, tile); });
  picture_.false_colour = false;
  passes[0].bytes += passes[0].count * (64ull * input.mesh.vertex_count + input.mesh.triangles.size());
  return passes;
}

std::vector<PassStats> Rasteriser::run(const RasterInput& input, const Camera& camera, std::uint32_t width,
                                       std::uint32_t height) {
  write_scene(scene(input, camera));
  picture_.has_doubt = input.gather != nullptr && input.gather->share != nullptr;
  auto passes =
      run_tiles(width, height, [&](device::Commands& commands, const Tile& tile) { record(commands, input, tile); });
  picture_.false_colour = false;
  picture_.has_surroundings = false;
  passes[0].bytes += passes[0].count * (64ull * input.mesh.vertex_count + input.mesh.triangles.size());
  // Bytes of the body are counted as if every vertex were read once.
  if (input.gather != nullptr) passes[1].bytes += passes[1].count * input.gather->field.points().size();
  return passes;
}

std::vector<PassStats> Rasteriser::run(const FalseColours& input, const Camera& camera, std::uint32_t width,
                                       std::uint32_t height) {
  if (!false_colour_) {
    device::GraphicsOptions options = pass_options(shader::false_colour_vert, shader::false_colour_frag);
    options.cull = device::Cull::none;
    false_colour_.emplace(device_, options, "false colour");
  }
  picture_.has_doubt = false;
  auto passes = run_tiles(width, height,
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
