#include "engine/render/rasteriser.h"

#include <algorithm>
#include <numbers>
#include <span>

#include "engine/graph/fresnel.h"
#include "engine/render/draw.h"
#include "spirv/resolve.comp.h"
#include "spirv/surface.frag.h"
#include "spirv/surface.vert.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t tile_pixels = 512;  // per side; 64 MiB of samples
constexpr VkFormat sample_format = VK_FORMAT_R32G32B32A32_SFLOAT;

std::vector<float> floats(const vk::Buffer& buffer) {
  const auto mapped = buffer.mapped_as<float>();
  return {mapped.begin(), mapped.end()};
}

gpu::SurfaceScene scene(const RasterInput& input, const Camera& camera) {
  return {.clip_from_world = camera.clip_from_world,
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
          .lights = input.shadows.lights().address(),
          .views = input.shadows.views().address()};
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
        diffuse_image(context, image_options(sample_format, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT), "diffuse samples"),
        specular_image(context, image_options(sample_format, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT), "specular samples"),
        depth_image(context, image_options(VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT), "depth"),
        diffuse_samples(context, sample_bytes(), vk::Place::device, "diffuse samples"),
        specular_samples(context, sample_bytes(), vk::Place::device, "specular samples"),
        diffuse(context, 12 * pixels(), vk::Place::host, "diffuse"),
        specular(context, 12 * pixels(), vk::Place::host, "specular"),
        alpha(context, 4 * pixels(), vk::Place::host, "alpha") {}

  std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  std::uint64_t sample_bytes() const { return 16ull * samples_x * samples_y; }
  vk::ImageOptions image_options(VkFormat format, VkImageUsageFlags usage) const {
    return {format, samples_x, samples_y, 1, usage};
  }

  std::uint32_t width, height;         // pixels of the picture
  std::uint32_t samples_x, samples_y;  // of a tile
  vk::Image diffuse_image, specular_image, depth_image;
  vk::Buffer diffuse_samples, specular_samples;
  vk::Buffer diffuse, specular, alpha;
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
      surface_(context,
               {.vertex = surface_vert,
                .fragment = surface_frag,
                .push_size = sizeof(gpu::SurfacePush),
                .colour_formats = {sample_format, sample_format}},
               "surface"),
      resolve_(context, resolve_comp, sizeof(gpu::ResolvePush), "resolve") {}

void Rasteriser::record(vk::Commands& commands, const RasterInput& input, const gpu::SurfacePush& push,
                        const Targets& targets, const Tile& tile) {
  commands.begin_pass("surface");
  draw(commands, {{&targets.diffuse_image, &targets.specular_image}, &targets.depth_image},
       {-2.0f * static_cast<float>(tile.x), -2.0f * static_cast<float>(tile.y),
        2.0f * static_cast<float>(targets.width), 2.0f * static_cast<float>(targets.height)},
       surface_, push, input.mesh.triangles, 3 * input.mesh.triangle_count);
  commands.end_pass();
  commands.begin_pass("resolve");
  commands.copy(targets.diffuse_image, targets.diffuse_samples);
  commands.copy(targets.specular_image, targets.specular_samples);
  commands.dispatch(resolve_,
                    gpu::ResolvePush{.diffuse_samples = targets.diffuse_samples.address(),
                                     .specular_samples = targets.specular_samples.address(),
                                     .diffuse = targets.diffuse.address(),
                                     .specular = targets.specular.address(),
                                     .alpha = targets.alpha.address(),
                                     .tile_x = tile.x,
                                     .tile_y = tile.y,
                                     .tile_width = tile.width,
                                     .tile_height = tile.height,
                                     .sample_stride = targets.samples_x,
                                     .picture_width = targets.width},
                    std::uint64_t{tile.width} * tile.height);
  commands.end_pass();
}

RasterResult Rasteriser::run(const RasterInput& input, const Camera& camera, std::uint32_t width,
                             std::uint32_t height) {
  const Targets targets(context_, width, height);
  const gpu::SurfaceScene constants = scene(input, camera);
  const auto scene_buffer = vk::upload<gpu::SurfaceScene>(context_, std::span(&constants, 1), "surface scene");
  PassStats surface{.name = "surface"}, resolve{.name = "resolve"};
  for (std::uint32_t y = 0; y < height; y += tile_pixels) {
    for (std::uint32_t x = 0; x < width; x += tile_pixels) {
      vk::Commands commands(context_, 2);
      record(commands, input, {scene_buffer.address()}, targets,
             {x, y, std::min(tile_pixels, width - x), std::min(tile_pixels, height - y)});
      const auto times = commands.submit_and_wait();
      surface.time_ms += times[0].time_ms;
      resolve.time_ms += times[1].time_ms;
      surface.bytes += 52ull * input.mesh.vertex_count + input.mesh.triangles.size() + 5 * targets.sample_bytes() / 2;
      resolve.bytes += 6 * targets.sample_bytes();
      ++surface.count;
      ++resolve.count;
    }
  }
  resolve.bytes += 28 * targets.pixels();
  return {{width, height, floats(targets.diffuse), floats(targets.specular), floats(targets.alpha)},
          {surface, resolve}};
}

}  // namespace quadgraph
