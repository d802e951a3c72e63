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

class LightSet {
 public:
  std::vector<gpu::LightRecord> records;
  std::vector<gpu::LightShape> shapes;  // per record
  std::vector<gpu::ShadowView> views;   // those of the first record first; depth addresses left 0
  std::vector<gpu::Beam> beams;         // in the order of the records that make them up; offsets left 0
  std::uint32_t environments = 0;
  bool shaped = false;  // some kind beyond directional, point and ambient

  // The records of all lights on a body within `bounds`. `images` has loaded theirs, if they have any.
  LightSet(std::span<const Light> lights, const Sphere& bounds, const LightImages* images = nullptr);

 private:
  void add(gpu::LightRecord record, const gpu::LightShape& shape, std::span<const gpu::ShadowView> own);
  void add_environment(const Light& light, const EnvironmentImage& image);
  void add_projector(const Light& light, const ProjectedImage& image);
  void add_patches(const Light& rectangle);

  Sphere bounds_;
};

// Axes of an environment's image in the world: right, up and ahead.
glm::mat3 environment_frame(const Light& light);

// A light's record for shaders, without views: for a rectangle a patch in its middle, for a projector with the power of
// the whole image as intensity.
gpu::LightRecord light_record(const Light& light);

}  // namespace quadgraph
