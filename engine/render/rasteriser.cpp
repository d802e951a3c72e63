#include "engine/render/rasteriser.h"

#include <algorithm>
#include <numbers>
#include <span>

#include "engine/graph/fresnel.h"
#include "engine/render/draw.h"
#include "spirv/gather.comp.h"
#include "spirv/resolve.comp.h"
#include "spirv/surface.frag.h"
#include "spirv/surface.vert.h"
#include "spirv/surface_gathered.frag.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t tile_pixels = 512;  // per side; 96 MiB of samples
constexpr VkFormat sample_format = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr std::array<const char*, PICTURE_LAYERS> layer_names = {"scattered", "specular", "unscattered",
                                                                 "transmittance"};

std::vector<float> floats(const vk::Buffer& buffer) {
  const auto mapped = buffer.mapped_as<float>();
  return {mapped.begin(), mapped.end()};
}

gpu::SurfaceScene scene(const RasterInput& input, const Camera& camera) {
  gpu::SurfaceScene scene{.clip_from_world = camera.clip_from_world,
                          .eye = camera.eye,
                          .eta = input.eta,
                          .roughness = input.roughness,
                          .radiance_norm = static_cast<float>(radiance_norm(input.eta)),
                          .light_count = input.shadows.light_count(),
                          .vertices = input.mesh.vertices.address(),
                          .normals = input.mesh.normals.address(),
                          .face = input.mesh.face.address(),
                          .barycentric = input.mesh.barycentric.address(),
                          .faces = input.finest.faces.address(),
                          .exitance = input.vertex_exitance.address(),
                          .unscattered = input.vertex_unscattered.address(),
                          .sky = input.finest.sky.address(),
                          .lights = input.shadows.lights().address(),
                          .views = input.shadows.views().address(),
                          .triangle_face = 0,
                          .points = 0,
                          .scale = 0,
                          .solid = {}};
  if (input.gather != nullptr) {
    scene.triangle_face = input.gather->triangle_face.address();
    scene.points = input.gather->field.points().address();
    scene.scale = input.gather->field.scale().address();
    scene.solid = input.gather->field.solid();
  }
  return scene;
}

vk::GraphicsOptions pass_options(vk::Spirv fragment) {
  return {.vertex = surface_vert,
          .fragment = fragment,
          .push_size = sizeof(gpu::SurfacePush),
          .colour_formats = std::vector<VkFormat>(SAMPLE_LAYERS, sample_format)};
}

}  // namespace

struct Rasteriser::Tile {
  std::uint32_t x, y, width, height;  // pixels inside the picture
};

struct Rasteriser::Targets {
  Targets(vk::Context& context, std::uint32_t picture_width, std::uint32_t picture_height)
      : width(picture_width),
        height(picture_height),
        samples_x(2 * std::min(width, tile_pixels)),
        samples_y(2 * std::min(height, tile_pixels)),
        depth(context, image_options(VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT),
              "picture/depth"),
        alpha(context, 4 * pixels(), vk::Place::host, "picture/alpha") {
    for (int k = 0; k < SAMPLE_LAYERS; ++k) {
      images.emplace_back(context, image_options(sample_format, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT),
                          "picture/samples");
      samples.emplace_back(context, sample_bytes(), vk::Place::read, "picture/samples");
    }
    for (const char* name : layer_names)
      layers.emplace_back(context, 12 * pixels(), vk::Place::host, std::string("picture/") + name);
  }

  std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  std::uint64_t sample_bytes() const { return 16ull * samples_x * samples_y; }
  vk::ImageOptions image_options(VkFormat format, VkImageUsageFlags usage) const {
    return {format, samples_x, samples_y, 1, usage};
  }

  std::uint32_t width, height;         // pixels of the picture
  std::uint32_t samples_x, samples_y;  // of a tile
  std::vector<vk::Image> images;       // of a tile
  vk::Image depth;
  std::vector<vk::Buffer> samples;  // the same
  std::vector<vk::Buffer> layers;   // of the picture
  vk::Buffer alpha;
};

double radiance_norm(double eta) {
  constexpr int steps = 4096;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double cos_o = (i + 0.5) / steps;
    sum += fresnel_transmittance(cos_o, eta) * cos_o;
  }
  return 2 * std::numbers::pi * sum / steps;
}

Rasteriser::Rasteriser(vk::Context& context)
    : context_(context),
      surface_(context, pass_options(surface_frag), "surface"),
      gathered_(context, pass_options(surface_gathered_frag), "surface gathered"),
      resolve_(context, resolve_comp, sizeof(gpu::ResolvePush), "resolve"),
      gather_(context, gather_comp, sizeof(gpu::ResolvePush), "gather") {}

void Rasteriser::record(vk::Commands& commands, const RasterInput& input, const gpu::SurfacePush& push,
                        const Targets& targets, const Tile& tile) {
  DrawTarget target{{}, &targets.depth};
  for (const vk::Image& image : targets.images) target.colours.push_back(&image);
  commands.begin_pass("surface");
  draw(commands, target,
       {-2.0f * static_cast<float>(tile.x), -2.0f * static_cast<float>(tile.y),
        2.0f * static_cast<float>(targets.width), 2.0f * static_cast<float>(targets.height)},
       input.gather != nullptr ? gathered_ : surface_, push, input.mesh.triangles, 3 * input.mesh.triangle_count);
  commands.end_pass();
  record_resolve(commands, input, push, targets, tile);
}

void Rasteriser::record_resolve(vk::Commands& commands, const RasterInput& input, const gpu::SurfacePush& push,
                                const Targets& targets, const Tile& tile) {
  gpu::ResolvePush resolve{.scene = push.scene,
                           .samples = {},
                           .layers = {},
                           .alpha = targets.alpha.address(),
                           .tile_x = tile.x,
                           .tile_y = tile.y,
                           .tile_width = tile.width,
                           .tile_height = tile.height,
                           .sample_stride = targets.samples_x,
                           .picture_width = targets.width};
  for (std::size_t k = 0; k < PICTURE_LAYERS; ++k) resolve.layers[k] = targets.layers[k].address();
  commands.begin_pass(input.gather != nullptr ? "gather" : "resolve");
  for (std::size_t k = 0; k < SAMPLE_LAYERS; ++k) {
    commands.copy(targets.images[k], targets.samples[k]);
    resolve.samples[k] = targets.samples[k].address();
  }
  commands.dispatch(input.gather != nullptr ? gather_ : resolve_, resolve, std::uint64_t{tile.width} * tile.height);
  commands.end_pass();
}

RasterResult Rasteriser::run(const RasterInput& input, const Camera& camera, std::uint32_t width,
                             std::uint32_t height) {
  const Targets targets(context_, width, height);
  const gpu::SurfaceScene constants = scene(input, camera);
  const auto scene_buffer = vk::upload<gpu::SurfaceScene>(context_, std::span(&constants, 1), "picture/scene");
  std::vector<PassStats> passes(2);
  const std::uint64_t surface_bytes = 64ull * input.mesh.vertex_count + input.mesh.triangles.size() +
                                      (2 * SAMPLE_LAYERS + 1) * targets.sample_bytes() / 2;
  // Copied, then read. Of the body, as if every vertex were read once.
  const std::uint64_t resolve_bytes =
      3 * SAMPLE_LAYERS * targets.sample_bytes() + (input.gather != nullptr ? input.gather->field.points().size() : 0);
  for (std::uint32_t y = 0; y < height; y += tile_pixels) {
    for (std::uint32_t x = 0; x < width; x += tile_pixels) {
      vk::Commands commands(context_, 2);
      record(commands, input, {scene_buffer.address()}, targets,
             {x, y, std::min(tile_pixels, width - x), std::min(tile_pixels, height - y)});
      const auto times = commands.submit_and_wait();
      for (std::size_t k = 0; k < passes.size(); ++k) {
        passes[k].name = times[k].name;
        passes[k].time_ms += times[k].time_ms;
        passes[k].bytes += k == 0 ? surface_bytes : resolve_bytes;
        ++passes[k].count;
      }
    }
  }
  passes[1].bytes += (12 * PICTURE_LAYERS + 4) * targets.pixels();
  return {{width, height, floats(targets.layers[0]), floats(targets.layers[1]), floats(targets.layers[2]),
           floats(targets.layers[3]), floats(targets.alpha)},
          passes};
}

}  // namespace quadgraph
