// The display mesh as a picture.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "engine/base/pass_stats.h"
#include "engine/device/commands.h"
#include "engine/device/pipeline.h"
#include "engine/render/display/camera.h"
#include "engine/render/display/display_buffers.h"
#include "engine/render/inside/false_mesh.h"
#include "engine/render/light/shadow_maps.h"
#include "engine/render/picture/coverage.h"
#include "engine/render/picture/frame_offsets.h"
#include "engine/render/picture/picture_buffers.h"
#include "engine/solve/gather_field.h"
#include "engine/solve/level_buffers.h"
#include "shaders/light/render_shared.h"

namespace quadgraph {

// For radiance gathered along view rays.
struct GatherView {
  const GatherField& field;
  const device::Buffer& triangle_face;  // display_faces.h
  const device::Buffer* share;          // SurfaceShare per surface vertex of the finest level; null: unknown
  const device::Buffer* elsewhere;      // Simulation::elsewhere; null: unknown, or the same everywhere
};

// A RoughnessMap on the device.
struct PlacedRoughness {
  const device::Buffer& texels;
  const device::Buffer& rest;  // vec3 per display vertex, mm
  gpu::ImageBox box;
  gpu::ImageLevels image;
  float roughness;
};

// A NormalMap on the device.
struct PlacedNormals {
  const device::Buffer& texels;
  const device::Buffer& rest;  // vec3 per display vertex, mm, or DisplayMesh::texture_places
  gpu::ImageBox box;
  gpu::ImageLevels image;
  float strength;
  bool by_mesh;
};

struct RasterInput {
  const DisplayBuffers& mesh;
  const LevelBuffers& finest;
  const device::Buffer& vertex_exitance;     // vec3 per surface vertex of the finest level, W/mm^2
  const device::Buffer& vertex_unscattered;  // the same
  const ShadowMaps& shadows;
  float roughness = 0.3f;                             // alpha of GGX
  const PlacedRoughness* placed_roughness = nullptr;  // null: the same everywhere
  const PlacedNormals* placed_normals = nullptr;      // null: those of the mesh
  glm::vec2 mirrored{};  // alphas of the two pictures of environments, unless roughness is the same everywhere
  const GatherView* gather = nullptr;             // null: radiance as of a diffuser
  std::optional<float> transmission_roughness{};  // the same of light that comes through; empty: the surface's
  PictureFrame frame{};
  PixelFilter filter = PixelFilter::box;
};

// For radiance from the cells of the shortest-path method.
struct PathInput {
  const DisplayBuffers& mesh;
  const device::Buffer& field;  // gpu::PathField
  const ShadowMaps& shadows;
  OpticalSurface surface{};
  float roughness = 0.3f;                             // alpha of GGX
  const PlacedRoughness* placed_roughness = nullptr;  // as in RasterInput, as are the next
  const PlacedNormals* placed_normals = nullptr;
  glm::vec2 mirrored{};
};

// A view of the inside on the device.
struct FalseColours {
  device::Buffer vertices;  // gpu::FalseVertex, three per triangle
  device::Buffer indices;   // u32, 0, 1, 2 ...
  std::uint32_t vertex_count = 0;
  Plane plane{0, 0, 1, 0};
  bool diverging = false;
};

FalseColours upload_false_colours(device::Device& device, const FalseMesh& mesh, const Plane& plane, bool diverging);

// Draws in tiles, so that the memory of the samples does not grow with the picture. What it draws into is kept from
// picture to picture. Of a body with levels, only which triangle is seen is drawn; all else is computed from it.
class Rasteriser {
 public:
  explicit Rasteriser(device::Device& device);
  ~Rasteriser();

  std::vector<PassStats> run(const RasterInput& input, const Camera& camera, std::uint32_t width, std::uint32_t height);

  std::vector<PassStats> run(const PathInput& input, const Camera& camera, std::uint32_t width, std::uint32_t height);

  // Draws a view of the inside.
  std::vector<PassStats> run(const FalseColours& input, const Camera& camera, std::uint32_t width,
                             std::uint32_t height);

  // The last one drawn.
  const PictureBuffers& picture() const { return picture_; }
  PictureBuffers& picture() { return picture_; }

 private:
  struct Tile;
  struct Targets;

  device::Viewport viewport(const Tile& tile) const;
  static device::DrawTarget target(const Targets& targets, const Tile& tile);
  gpu::TilePixels tile_pixels(const Targets& targets, const Tile& tile) const;
  gpu::ShadePush shade_push(const RasterInput& input, const Tile& tile) const;
  void record(device::Commands& commands, const RasterInput& input, const CoveragePlaces& places, const Tile& tile);
  void record(device::Commands& commands, const PathInput& input, const Tile& tile);
  void record(device::Commands& commands, const FalseColours& input, const Camera& camera, const Tile& tile);
  static void copy_samples(device::Commands& commands, const Targets& targets, const Tile& tile);
  void record_resolve(device::Commands& commands, const Tile& tile);

  template <typename Record>
  std::vector<PassStats> run_tiles(Targets& targets, std::size_t pass_count, std::uint32_t width, std::uint32_t height,
                                   const Record& record_tile);

  void write_scene(const gpu::SurfaceScene& scene);
  const device::GraphicsPass& surface(const PathInput& input);
  const device::ComputePass& shading(const RasterInput& input);

  device::Device& device_;
  std::optional<device::GraphicsPass> visibility_;              // as all but resolve_ made at first use
  std::array<std::optional<device::ComputePass>, 4> shadings_;  // without shaped lights and with, gathered or not
  std::array<std::optional<device::GraphicsPass>, 2> paths_;    // from cells, without shaped lights and with
  std::optional<device::GraphicsPass> false_colour_;
  device::ComputePass resolve_;
  PictureBuffers picture_;
  std::unique_ptr<Targets> layers_, seen_;  // of a tile
  device::Buffer scene_;                    // made at first use, as targets are: no solve needs them
  Coverage coverage_;
};

}  // namespace quadgraph
