#include "engine/render/light/light_set.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "engine/render/light/shadow_views.h"

namespace quadgraph {
namespace {

using std::numbers::pi_v;

// Gauss-Legendre nodes on [-1, 1] and weights that sum to 1: light from the four on either edge is exact where nothing
// hides it, up to degree 7, and they divide the rectangle into patches as large as their weights.
constexpr int patches_per_side = 4;
constexpr float patch_node[patches_per_side] = {-0.8611363f, -0.3399810f, 0.3399810f, 0.8611363f};
constexpr float patch_weight[patches_per_side] = {0.1739274f, 0.3260726f, 0.3260726f, 0.1739274f};

gpu::LightShape spot_shape(const Light& light) {
  const SpotCosines cosines = spot_cosines(light);
  gpu::LightShape shape{};
  shape.axis = light.direction;
  shape.inner = cosines.inner;
  shape.outer = cosines.outer;
  return shape;
}

// Parts along a side of a patch, so many that each is at most half as wide as its distance to the body.
std::uint32_t parts_of(float width, const glm::vec3& position, const Sphere& bounds) {
  constexpr float most = 4;
  const float gap = glm::distance(position, bounds.centre) - bounds.radius;
  return static_cast<std::uint32_t>(gap > 0 ? std::clamp(std::ceil(2 * width / gap), 1.0f, most) : most);
}

gpu::LightShape patch_shape(const Light& rectangle, int i, int j) {
  gpu::LightShape shape{};
  shape.axis = glm::normalize(glm::cross(rectangle.u, rectangle.v));
  shape.share = patch_weight[i] * patch_weight[j];
  shape.right = patch_weight[i] * rectangle.u;
  shape.up = patch_weight[j] * rectangle.v;
  shape.width = std::max(glm::length(shape.right), glm::length(shape.up));
  shape.more_follow = i + j < 2 * (patches_per_side - 1) ? 1 : 0;
  return shape;
}

gpu::LightShape projector_shape(const Light& light, const ProjectedImage& image) {
  const float up = std::tan(glm::radians(0.5f * light.angle));
  const float right = up * static_cast<float>(image.columns) / static_cast<float>(image.rows);
  gpu::LightShape shape{};
  shape.axis = light.direction;
  shape.right = glm::normalize(glm::cross(light.direction, light.up));
  shape.up = glm::cross(shape.right, light.direction) / up;
  shape.right /= right;
  shape.texels = image.texels.address();
  shape.columns = image.columns;
  shape.rows = image.rows;
  shape.levels = image.levels;
  return shape;
}

gpu::Beam beam_of(const Light& light, const gpu::LightRecord& record, const gpu::LightShape& shape) {
  switch (light.kind) {
    case LightKind::ambient:
      return {{gpu::BEAM_LAMBERTIAN, {}, {}, {}}, record.power, gpu::BEAM_FACE, 0, 0};
    case LightKind::environment:
      return {{gpu::BEAM_LAMBERTIAN, shape.axis, shape.right, shape.up}, record.power, gpu::BEAM_RGB, 0, shape.texels};
    case LightKind::directional:
      return {{gpu::BEAM_DIRECTIONAL, light.direction, {}, {}}, record.power, gpu::BEAM_QUARTERS, 0, 0};
    case LightKind::rectangle:
      return {{gpu::BEAM_RECTANGLE, light.position, light.u, light.v}, record.power, gpu::BEAM_QUARTERS, 0, 0};
    case LightKind::point:
    case LightKind::spot:
    case LightKind::projector:
      break;
  }
  const auto floats = light.kind == LightKind::projector ? gpu::BEAM_RGB_QUARTERS : gpu::BEAM_QUARTERS;
  return {{gpu::BEAM_POINT, light.position, {}, {}}, record.power, floats, 0, 0};
}

}  // namespace

glm::mat3 environment_frame(const Light& light) {
  const bool z_up = light.up.z > 0;
  const glm::vec3 right(1, 0, 0), ahead = z_up ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, -1);
  const float turn = glm::radians(light.turn), c = std::cos(turn), s = std::sin(turn);
  return {c * right + s * ahead, light.up, c * ahead - s * right};
}

gpu::LightRecord light_record(const Light& light) {
  switch (light.kind) {
    case LightKind::ambient:
      return {gpu::LIGHT_AMBIENT, glm::vec3(0), light.power, 0, 0};
    case LightKind::environment:
      return {gpu::LIGHT_ENVIRONMENT, glm::vec3(0), light.power, 0, 0};
    case LightKind::directional:
      return {gpu::LIGHT_DIRECTIONAL, -light.direction, light.power, 0, 0};
    case LightKind::spot:
      return {gpu::LIGHT_SPOT, light.position, axis_intensity(light), 0, 0};
    case LightKind::rectangle:
      return {gpu::LIGHT_PATCH, light.position, light.power / pi_v<float>, 0, 0};
    case LightKind::projector:
      return {gpu::LIGHT_PROJECTOR, light.position, light.power, 0, 0};
    case LightKind::point:
      break;
  }
  return {gpu::LIGHT_POINT, light.position, light.power / (4 * pi_v<float>), 0, 0};
}

LightSet::LightSet(std::span<const Light> lights, const Sphere& bounds, const LightImages* images) : bounds_(bounds) {
  add(lights, images);
  while (map_bytes() > most_map_bytes) {
    const std::uint32_t halvings = halvings_ + 1;
    *this = LightSet({}, bounds);
    halvings_ = halvings;
    add(lights, images);
  }
}

std::uint64_t LightSet::map_bytes() const {
  std::uint64_t bytes = 0;
  for (const gpu::ShadowView& view : views) bytes += std::uint64_t{view.size} * view.size * sizeof(float);
  return bytes;
}

void LightSet::add(std::span<const Light> lights, const LightImages* images) {
  for (const Light& light : lights) {
    if (light.kind == LightKind::rectangle) {
      add_patches(light);
    } else if (light.kind == LightKind::projector) {
      add_projector(light, images->projected(light.file));
    } else if (light.kind == LightKind::environment) {
      add_environment(light, images->environment(light.file));
      continue;
    } else {
      add(light_record(light), light.kind == LightKind::spot ? spot_shape(light) : gpu::LightShape{},
          shadow_views(light, bounds_, halvings_));
    }
    beams.push_back(beam_of(light, records.back(), shapes.back()));
  }
}

void LightSet::add(gpu::LightRecord record, const gpu::LightShape& shape, std::span<const gpu::ShadowView> own) {
  record.first_view = static_cast<std::uint32_t>(views.size());
  record.view_count = static_cast<std::uint32_t>(own.size());
  views.insert(views.end(), own.begin(), own.end());
  records.push_back(record);
  shapes.push_back(shape);
  shaped = shaped || record.kind >= gpu::LIGHT_FIRST_SHAPED;
}

void LightSet::add_environment(const Light& light, const EnvironmentImage& image) {
  const glm::mat3 frame = environment_frame(light);
  gpu::LightShape shape{};
  shape.right = frame[0];
  shape.up = frame[1];
  shape.axis = frame[2];
  shape.texels = image.texels.address();
  add(light_record(light), shape, {});
  beams.push_back(beam_of(light, records.back(), shapes.back()));
  ++environments;
  for (const Sun& sun : image.environment.suns) {
    const Light peak{.direction = -(frame * sun.towards), .power = light.power * sun.irradiance};
    add(light_record(peak), {}, shadow_views(peak, bounds_, halvings_));
    beams.push_back(beam_of(peak, records.back(), shapes.back()));
  }
}

void LightSet::add_projector(const Light& light, const ProjectedImage& image) {
  const gpu::LightShape shape = projector_shape(light, image);
  gpu::LightRecord record = light_record(light);
  record.power *= 0.25f * glm::length(shape.right) * glm::length(shape.up);  // over the image's area at 1 mm
  add(record, shape, shadow_views(light, bounds_, halvings_));
}

void LightSet::add_patches(const Light& rectangle) {
  for (int i = 0; i < patches_per_side; ++i) {
    for (int j = 0; j < patches_per_side; ++j) {
      gpu::LightRecord record = light_record(rectangle);
      record.towards_or_at += 0.5f * (patch_node[i] * rectangle.u + patch_node[j] * rectangle.v);
      gpu::LightShape shape = patch_shape(rectangle, i, j);
      shape.parts = parts_of(shape.width, record.towards_or_at, bounds_);
      add(record, shape, patch_views(record.towards_or_at, shape.axis, bounds_, halvings_));
    }
  }
}

}  // namespace quadgraph
