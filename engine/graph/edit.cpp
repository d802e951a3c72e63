#include "engine/graph/edit.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <string>

#include "engine/graph/error.h"

namespace quadgraph {
namespace {

constexpr float everywhere = std::numeric_limits<float>::max();

void check(bool fits, const char* field, double found, const char* allowed) {
  if (!fits) throw InputError(std::string(field) + ": found " + std::to_string(found) + ", allowed is " + allowed);
}

void check_by(const std::optional<glm::vec3>& by, const char* field, Edit::Operation operation) {
  for (int c = 0; by && c < 3; ++c) {
    const double value = static_cast<double>((*by)[c]);
    const bool fits = std::isfinite(value) && (value >= 0 || operation == Edit::Operation::add);
    check(fits, field, value, operation == Edit::Operation::add ? "a finite number" : "a number >= 0");
  }
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
  return e;
}

}  // namespace

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
}

EditArrays::EditArrays(std::span<const Edit> all) {
  for (const Edit& edit : all) {
    edits.push_back(as_gpu(edit, points.size()));
    points.insert(points.end(), edit.stroke.begin(), edit.stroke.end());
  }
}

gpu::Optical EditArrays::apply(gpu::Optical optical, const glm::vec3& position, float depth) const {
  for (const gpu::MaterialEdit& e : edits) {
    float distance = everywhere;
    for (std::uint32_t k = 0; k < e.point_count; ++k) {
      const glm::vec3 &a = points[e.first_point + (k > 0 ? k - 1 : 0)], &b = points[e.first_point + k];
      distance = std::min(distance, gpu::segment_distance(position, a, b));
    }
    optical = gpu::edited(optical, e, gpu::edit_weight(e, distance, depth));
  }
  return optical;
}

bool EditArrays::wants_depth() const {
  return std::any_of(edits.begin(), edits.end(),
                     [](const auto& e) { return e.depth_from > 0 || e.depth_to < everywhere; });
}

}  // namespace quadgraph
