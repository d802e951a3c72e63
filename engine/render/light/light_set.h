// All lights as shaders take them: records of what sends light out, views of their shadow maps, and the beams by which
// the light enters the body.
#pragma once

#include <glm/mat3x3.hpp>
#include <span>
#include <vector>

#include "engine/render/display/camera.h"
#include "engine/render/light/light_images.h"
#include "engine/render/light/lights.h"
#include "shaders/light/render_shared.h"

namespace quadgraph {

// Four halvings fit most_lights rectangles, each of 16 patches of six views, into it.
inline constexpr std::uint64_t most_map_bytes = std::uint64_t{512} << 20;

class LightSet {
 public:
  std::vector<gpu::LightRecord> records;
  std::vector<gpu::LightShape> shapes;  // per record
  std::vector<gpu::ShadowView> views;   // those of the first record first; depth addresses left 0
  std::vector<gpu::Beam> beams;         // in the order of the records that make them up; offsets left 0
  std::uint32_t environments = 0;
  bool shaped = false;  // some kind beyond directional, point and ambient

  // The records of all lights on a body within `bounds`. `images` has loaded theirs, if they have any. Shadow maps are
  // halved in size until all together take no more than most_map_bytes, which few lights never do.
  LightSet(std::span<const Light> lights, const Sphere& bounds, const LightImages* images = nullptr);

  std::uint64_t map_bytes() const;  // of all views

 private:
  void add(std::span<const Light> lights, const LightImages* images);
  void add(gpu::LightRecord record, const gpu::LightShape& shape, std::span<const gpu::ShadowView> own);
  void add_environment(const Light& light, const EnvironmentImage& image);
  void add_projector(const Light& light, const ProjectedImage& image);
  void add_patches(const Light& rectangle);

  Sphere bounds_;
  std::uint32_t halvings_ = 0;  // of the sides of shadow maps
};

// Axes of an environment's image in the world: right, up and ahead.
glm::mat3 environment_frame(const Light& light);

// A light's record for shaders, without views: for a rectangle a patch in its middle, for a projector with the power of
// the whole image as intensity.
gpu::LightRecord light_record(const Light& light);

}  // namespace quadgraph
