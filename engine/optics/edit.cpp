#include "engine/optics/edit.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr float everywhere = std::numeric_limits<float>::max();

void check(bool fits, const char* field, double found, const char* allowed) {
  if (!fits) throw InputError(std::string(field) + ": found " + std::to_string(found) + ", allowed is " + allowed);
}

void check_points(std::span<const glm::vec3> stroke, const char* field) {
  for (const glm::vec3& p : stroke) {
    for (int c = 0; c < 3; ++c) check(std::isfinite(p[c]), field, static_cast<double>(p[c]), "finite numbers (mm)");
  }
}

void check_by(const std::optional<glm::vec3>& by, const char* field, Edit::Operation operation) {
  for (int c = 0; by && c < 3; ++c) {
    const double value = static_cast<double>((*by)[c]), most = static_cast<double>(gpu::COEFFICIENT_MAX);
    const bool adds = operation == Edit::Operation::add;
    check(value >= (adds ? -most : 0) && value <= most, field, value, adds ? "-1e6 to 1e6" : "0 to 1e6");
  }
}

// Images whose texels lie in one array, each of them once, however many edits stamp it.
class PutImages {
 public:
  explicit PutImages(std::vector<glm::vec3>& texels) : texels_(texels) {}

  // Appends the image's texels where they are not there yet; where they lie.
  gpu::ImageLevels put(const std::shared_ptr<const ImagePyramid>& image) {
    if (!image) return {};
    const auto [known, is_new] = first_.try_emplace(image.get(), static_cast<gpu::uint>(texels_.size()));
    if (is_new) texels_.insert(texels_.end(), image->texels.begin(), image->texels.end());
    return {known->second, image->columns, image->rows, image->levels};
  }

 private:
  std::vector<glm::vec3>& texels_;
  std::map<const ImagePyramid*, gpu::uint> first_;
};

// Appends the points of a stroke to `points`.
gpu::EditPlace put(std::span<const glm::vec3> stroke, float reach, std::vector<glm::vec3>& points) {
  gpu::EditPlace place{};
  place.first_point = static_cast<gpu::uint>(points.size());
  place.point_count = static_cast<gpu::uint>(stroke.size());
  place.low = glm::vec3(everywhere);
  place.high = glm::vec3(-everywhere);
  for (const glm::vec3& p : stroke) {
    place.low = glm::min(place.low, p - glm::vec3(reach));
    place.high = glm::max(place.high, p + glm::vec3(reach));
  }
  points.insert(points.end(), stroke.begin(), stroke.end());
  return place;
}

void put(const std::optional<Placement>& placement, gpu::EditPlace& place) {
  place.placed = placement ? 1u : 0u;
  if (placement) place.box = image_box(*placement);
}

gpu::MaterialEdit as_gpu(const Edit& edit, std::vector<glm::vec3>& points) {
  gpu::MaterialEdit e{};
  e.sigma_s_prime = edit.sigma_s_prime.value_or(glm::vec3(0));
  e.sigma_a = edit.sigma_a.value_or(glm::vec3(0));
  e.depth_from = edit.depth_from;
  e.depth_to = edit.depth_to;
  e.radius = edit.radius;
  e.softness = edit.softness;
  e.opacity = edit.opacity;
  e.joins = edit.joins ? 1u : 0u;
  e.operation = static_cast<gpu::uint>(edit.operation);
  e.coefficients = (edit.sigma_s_prime ? gpu::EDIT_SCATTERING : 0u) | (edit.sigma_a ? gpu::EDIT_ABSORPTION : 0u);
  e.place = put(edit.stroke, edit.radius + edit.softness, points);
  put(edit.placement, e.place);
  e.mirrored = edit.mirrored ? 1u : 0u;
  if (!edit.mirrored) return e;
  e.mirror = put(edit.mirrored->stroke, edit.radius + edit.softness, points);
  put(edit.mirrored->placement, e.mirror);
  e.mirror.box.right = -e.mirror.box.right;
  return e;
}

// The mirror image of an edit is of the same kind as the edit.
void check_mirror(const Edit& edit, const EditMirror& mirror) {
  if (edit.stroke.empty() && !edit.placement)
    throw InputError("mirrored: found, an edit everywhere has no mirror image");
  check(mirror.stroke.size() == edit.stroke.size(), "mirrored: stroke", static_cast<double>(mirror.stroke.size()),
        ("as many points as the stroke itself has, " + std::to_string(edit.stroke.size())).c_str());
  check_points(mirror.stroke, "mirrored: stroke");
  if (mirror.placement.has_value() != edit.placement.has_value()) {
    throw InputError(std::string("mirrored: placement: found ") + (mirror.placement ? "one" : "none") +
                     ", allowed is one where the edit itself has one, and none else");
  }
  if (!mirror.placement) return;
  try {
    check_placement(*mirror.placement);
  } catch (const InputError& error) {
    throw InputError(std::string("mirrored: placement: ") + error.what());
  }
}

gpu::EditReach reach_at(const EditArrays& all, const gpu::MaterialEdit& e, const gpu::EditPlace& where,
                        const glm::vec3& position, float depth, float spacing) {
  float distance = everywhere;
  for (std::uint32_t k = 0; k < where.point_count; ++k) {
    const glm::vec3 &a = all.points[where.first_point + (k > 0 ? k - 1 : 0)], &b = all.points[where.first_point + k];
    distance = std::min(distance, gpu::segment_distance(position, a, b));
  }
  gpu::EditReach reach{glm::vec3(1), gpu::edit_weight(e, where, distance, depth)};
  if (where.placed == 0) return reach;
  const glm::vec3 place = gpu::in_box(where.box, position);
  const auto sampled = [&](const gpu::ImageLevels& image) {
    const gpu::ImageTap tap =
        gpu::image_tap(image, gpu::in_picture(where.box, place), gpu::texels_across(where.box, image, spacing));
    return gpu::mixed(tap, all.texels[tap.upper_left], all.texels[tap.upper_right], all.texels[tap.lower_left],
                      all.texels[tap.lower_right]);
  };
  reach.weight *= gpu::box_weight(where.box, place, e.softness);
  if (e.image.levels > 0) reach.factor = sampled(e.image);
  if (e.mask.levels > 0) reach.weight *= std::min(gpu::luminance(sampled(e.mask)), 1.0f);
  return reach;
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
  check_points(edit.stroke, "stroke");
  const bool reaches = std::isfinite(edit.radius) && (edit.stroke.empty() ? edit.radius == 0 : edit.radius > 0);
  check(reaches, "radius", static_cast<double>(edit.radius), "more than 0 (mm) with a stroke, and none without");
  check(edit.depth_from >= 0, "depth", static_cast<double>(edit.depth_from), "0 (mm) or more");
  check(edit.depth_to > edit.depth_from, "depth", static_cast<double>(edit.depth_to), "more than where it begins (mm)");
  check(edit.softness >= 0 && std::isfinite(edit.softness), "softness", static_cast<double>(edit.softness),
        "0 (mm) or more");
  check(edit.opacity >= 0 && edit.opacity <= 1, "opacity", static_cast<double>(edit.opacity), "0 to 1");
  if (edit.mirrored) check_mirror(edit, *edit.mirrored);
  if (edit.placement) return check_placement(*edit.placement);
  if (edit.image || edit.mask) throw InputError("placement: found none, an image or a mask needs one");
}

EditArrays::EditArrays(std::span<const Edit> all) {
  PutImages images(texels);
  for (const Edit& edit : all) {
    edits.push_back(as_gpu(edit, points));
    edits.back().image = images.put(edit.image);
    edits.back().mask = images.put(edit.mask);
  }
}

gpu::Optical EditArrays::apply(gpu::Optical optical, const glm::vec3& position, float depth, float spacing) const {
  gpu::Optical below = optical;
  for (const gpu::MaterialEdit& e : edits) {
    if (e.joins == 0) below = optical;
    gpu::EditReach reach = reach_at(*this, e, e.place, position, depth, spacing);
    if (e.mirrored == 1) {
      const gpu::EditReach other = reach_at(*this, e, e.mirror, position, depth, spacing);
      if (other.weight > reach.weight) reach = other;
    }
    optical = gpu::edited(optical, e, reach);
    if (e.opacity < 1) optical = gpu::mixed(below, optical, e.opacity);
  }
  return optical;
}

bool EditArrays::wants_depth() const {
  return std::any_of(edits.begin(), edits.end(),
                     [](const auto& e) { return e.depth_from > 0 || e.depth_to < everywhere; });
}

}  // namespace quadgraph
