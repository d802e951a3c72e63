#include "engine/optics/edit.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr float everywhere = std::numeric_limits<float>::max();

void check(bool fits, const char* field, double found, const char* allowed) {
  if (!fits) throw InputError(std::string(field) + ": found " + std::to_string(found) + ", allowed is " + allowed);
}

void check_by(const std::optional<glm::vec3>& by, const char* field, Edit::Operation operation) {
  for (int c = 0; by && c < 3; ++c) {
    const double value = static_cast<double>((*by)[c]), most = static_cast<double>(gpu::COEFFICIENT_MAX);
    const bool adds = operation == Edit::Operation::add;
    check(value >= (adds ? -most : 0) && value <= most, field, value, adds ? "-1e6 to 1e6" : "0 to 1e6");
  }
}

// Appends the image's texels to `texels`; where they lie.
gpu::ImageLevels put(const std::shared_ptr<const ImagePyramid>& image, std::vector<glm::vec3>& texels) {
  if (!image) return {};
  const auto first = static_cast<gpu::uint>(texels.size());
  texels.insert(texels.end(), image->texels.begin(), image->texels.end());
  return {first, image->columns, image->rows, image->levels};
}

gpu::MaterialEdit as_gpu(const Edit& edit, std::size_t first_point) {
  gpu::MaterialEdit e{};
  e.sigma_s_prime = edit.sigma_s_prime.value_or(glm::vec3(0));
  e.sigma_a = edit.sigma_a.value_or(glm::vec3(0));
  e.depth_from = edit.depth_from;
  e.depth_to = edit.depth_to;
  e.radius = edit.radius;
  e.softness = edit.softness;
  e.operation = static_cast<gpu::uint>(edit.operation);
  e.coefficients = (edit.sigma_s_prime ? gpu::EDIT_SCATTERING : 0u) | (edit.sigma_a ? gpu::EDIT_ABSORPTION : 0u);
  e.first_point = static_cast<gpu::uint>(first_point);
  e.point_count = static_cast<gpu::uint>(edit.stroke.size());
  e.low = glm::vec3(everywhere);
  e.high = glm::vec3(-everywhere);
  for (const glm::vec3& p : edit.stroke) {
    e.low = glm::min(e.low, p - glm::vec3(edit.radius + edit.softness));
    e.high = glm::max(e.high, p + glm::vec3(edit.radius + edit.softness));
  }
  e.placed = edit.placement ? 1u : 0u;
  if (edit.placement) e.box = image_box(*edit.placement);
  return e;
}

// What an edit does at a place in its box: the share of it that arrives there, and the factor of its image.
struct Arriving {
  glm::vec3 factor{1};
  float weight = 1;
};

Arriving arriving(const gpu::MaterialEdit& e, std::span<const glm::vec3> texels, const glm::vec3& position,
                  float spacing) {
  if (e.placed == 0) return {};
  const glm::vec3 place = gpu::in_box(e.box, position);
  const auto sampled = [&](const gpu::ImageLevels& image) {
    const gpu::ImageTap tap =
        gpu::image_tap(image, gpu::in_picture(e.box, place), gpu::texels_across(e.box, image, spacing));
    return gpu::mixed(tap, texels[tap.upper_left], texels[tap.upper_right], texels[tap.lower_left],
                      texels[tap.lower_right]);
  };
  Arriving found{glm::vec3(1), gpu::box_weight(e, place)};
  if (e.image.levels > 0) found.factor = sampled(e.image);
  if (e.mask.levels > 0) found.weight *= std::min(gpu::luminance(sampled(e.mask)), 1.0f);
  return found;
}

}  // namespace

void check_placement(const Placement& p) {
  const auto finite = [](const char* field, const glm::vec3& value) {
    for (int c = 0; c < 3; ++c) check(std::isfinite(value[c]), field, static_cast<double>(value[c]), "finite numbers");
  };
  finite("centre", p.centre);
  finite("direction", p.direction);
  finite("up", p.up);
  for (int c = 0; c < 3; ++c) {
    check(p.size[c] > 0 && std::isfinite(p.size[c]), "size", static_cast<double>(p.size[c]),
          "width, height and depth of more than 0 (mm)");
  }
  if (glm::length(glm::dvec3(p.direction)) == 0) throw InputError("direction: found 0, 0, 0, allowed is a direction");
  const glm::dvec3 direction = glm::normalize(glm::dvec3(p.direction)), up(p.up);
  if (glm::length(glm::cross(direction, up)) <= 1e-4 * glm::length(up)) {
    throw InputError("up: found 0 or a direction along that of the picture, allowed is any other");
  }
}

gpu::ImageBox image_box(const Placement& p) {
  const glm::dvec3 direction = glm::normalize(glm::dvec3(p.direction));
  const glm::dvec3 right = glm::normalize(glm::cross(direction, glm::dvec3(p.up)));
  return {p.centre, glm::vec3(right), glm::vec3(glm::cross(right, direction)), 0.5f * p.size};
}

static_assert(static_cast<gpu::uint>(Edit::Operation::multiply) == gpu::EDIT_MULTIPLY &&
              static_cast<gpu::uint>(Edit::Operation::add) == gpu::EDIT_ADD &&
              static_cast<gpu::uint>(Edit::Operation::set) == gpu::EDIT_SET);

void check_edit(const Edit& edit) {
  if (!edit.sigma_s_prime && !edit.sigma_a) throw InputError("sigma_s_prime, sigma_a: found neither, one is required");
  check_by(edit.sigma_s_prime, "sigma_s_prime", edit.operation);
  check_by(edit.sigma_a, "sigma_a", edit.operation);
  for (const glm::vec3& p : edit.stroke) {
    for (int c = 0; c < 3; ++c) check(std::isfinite(p[c]), "stroke", static_cast<double>(p[c]), "finite numbers (mm)");
  }
  const bool reaches = std::isfinite(edit.radius) && (edit.stroke.empty() ? edit.radius == 0 : edit.radius > 0);
  check(reaches, "radius", static_cast<double>(edit.radius), "more than 0 (mm) with a stroke, and none without");
  check(edit.depth_from >= 0, "depth", static_cast<double>(edit.depth_from), "0 (mm) or more");
  check(edit.depth_to > edit.depth_from, "depth", static_cast<double>(edit.depth_to), "more than where it begins (mm)");
  check(edit.softness >= 0 && std::isfinite(edit.softness), "softness", static_cast<double>(edit.softness),
        "0 (mm) or more");
  if (edit.placement) return check_placement(*edit.placement);
  if (edit.image || edit.mask) throw InputError("placement: found none, an image or a mask needs one");
}

EditArrays::EditArrays(std::span<const Edit> all) {
  for (const Edit& edit : all) {
    edits.push_back(as_gpu(edit, points.size()));
    edits.back().image = put(edit.image, texels);
    edits.back().mask = put(edit.mask, texels);
    points.insert(points.end(), edit.stroke.begin(), edit.stroke.end());
  }
}

gpu::Optical EditArrays::apply(gpu::Optical optical, const glm::vec3& position, float depth, float spacing) const {
  for (const gpu::MaterialEdit& e : edits) {
    float distance = everywhere;
    for (std::uint32_t k = 0; k < e.point_count; ++k) {
      const glm::vec3 &a = points[e.first_point + (k > 0 ? k - 1 : 0)], &b = points[e.first_point + k];
      distance = std::min(distance, gpu::segment_distance(position, a, b));
    }
    const Arriving found = arriving(e, texels, position, spacing);
    optical = gpu::edited(optical, e, found.factor, found.weight * gpu::edit_weight(e, distance, depth));
  }
  return optical;
}

bool EditArrays::wants_depth() const {
  return std::any_of(edits.begin(), edits.end(),
                     [](const auto& e) { return e.depth_from > 0 || e.depth_to < everywhere; });
}

}  // namespace quadgraph
