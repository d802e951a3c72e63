// The display mesh as a picture.
#pragma once

#include <array>

#include "engine/render/camera.h"
#include "engine/render/display_buffers.h"
#include "engine/render/picture.h"
#include "engine/render/shadow_maps.h"
#include "engine/solve/gather_field.h"
#include "engine/solve/simulation.h"
#include "engine/vk/pipeline.h"
#include "shaders/render_shared.h"

namespace quadgraph {

// Integral of F_t(cos, eta) cos over the hemisphere, sr: what exitance is divided by to give radiance along F_t, so
// that it integrates back to the exitance (physics.md). pi for eta = 1.
double radiance_norm(double eta);

// For radiance gathered along view rays.
struct GatherView {
  const GatherField& field;
  const vk::Buffer& triangle_face;  // display_faces.h
};

struct RasterInput {
  const DisplayBuffers& mesh;
  const LevelBuffers& finest;
  const vk::Buffer& vertex_exitance;     // vec3 per surface vertex of the finest level, W/mm^2
  const vk::Buffer& vertex_unscattered;  // the same
  const ShadowMaps& shadows;
  float eta = 1;
  float roughness = 0.3f;              // alpha of GGX
  const GatherView* gather = nullptr;  // null: radiance as of a diffuser
};

struct RasterResult {
  Picture picture;
  std::vector<PassStats> passes;
};

// Draws in tiles, so that memory does not grow with the samples of the picture.
class Rasteriser {
 public:
  explicit Rasteriser(vk::Context& context);

  RasterResult run(const RasterInput& input, const Camera& camera, std::uint32_t width, std::uint32_t height);

 private:
  struct Tile;
  struct Targets;

  void record(vk::Commands& commands, const RasterInput& input, const gpu::SurfacePush& push, const Targets& targets,
              const Tile& tile);
  void record_resolve(vk::Commands& commands, const RasterInput& input, const gpu::SurfacePush& push,
                      const Targets& targets, const Tile& tile);

  vk::Context& context_;
  vk::GraphicsPass surface_, gathered_;
  vk::ComputePass resolve_, gather_;
};

}  // namespace quadgraph
