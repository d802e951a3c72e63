// The rays by which one beam enters a body; see source_walk.h.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "engine/reference/entering.h"
#include "engine/reference/ray.h"
#include "engine/reference/source_walk.h"

namespace quadgraph {

// Whether one ray from the middle of a face stands for all of it.
bool enters_evenly(const FaceFrame& frame, const Quarters& quarters);

// `Light` gives what enters, W/mm^2 by channel, as QuarterLight does. `Sink` is that of Ray, and entered(channel,
// power); `end` too.
template <class Medium, class Light, class Sink>
class Beam {
 public:
  using Power = typename Ray<Medium, Sink>::Power;

  Beam(const Level& level, const Problem& problem, const Medium& medium, const gpu::BeamRecord& beam,
       const Light& light, Sink& sink, double end = gpu::WALK_END)
      : level_(level),
        problem_(problem),
        beam_(beam),
        light_(light),
        ray_(level, problem, medium, sink, end),
        sink_(sink) {}

  // Light through an open face; `quarters` decides by how many rays.
  void enter(std::uint32_t f, const Quarters& quarters) {
    const FaceFrame frame = frame_of(level_, f);
    if (enters_evenly(frame, quarters)) return from(f, frame, 3, power_of(f, QuarterLight::whole, frame.area));
    for (std::uint32_t k = 0; k < 4; ++k) from(f, frame, k, power_of(f, k, frame.area / 4));
  }

 private:
  Power power_of(std::uint32_t f, std::uint32_t quarter, double area) const {
    Power power = light_.at(f, quarter);
    for (auto& part : power) part = part * area;
    return power;
  }

  // From the middle of a quarter; the last is the one in the middle of the face.
  void from(std::uint32_t f, const FaceFrame& frame, std::uint32_t quarter, const Power& power) {
    glm::dvec3 barycentric(1.0 / 3);
    if (quarter < 3) {
      barycentric = glm::dvec3(1.0 / 6);
      barycentric[static_cast<int>(quarter)] = 2.0 / 3;
    }
    if (value_of(power[0]) == 0 && value_of(power[1]) == 0 && value_of(power[2]) == 0) return;
    for (int c = 0; c < 3; ++c) sink_.entered(c, power[static_cast<std::size_t>(c)]);
    if (beam_.kind == gpu::BEAM_LAMBERTIAN) return lambertian(f, frame, barycentric, power);
    const double eta = problem_.eta.behind(level_, f);
    if (beam_.kind == gpu::BEAM_MEAN) return ray_.run(f, barycentric, mean_direction(frame, f, eta), power);
    const glm::dvec3 outside = incoming(f, frame, quarter, point_at(frame, barycentric));
    ray_.run(f, barycentric, refract(outside, frame.normal, eta), power);
  }

  glm::dvec3 incoming(std::uint32_t f, const FaceFrame& frame, std::uint32_t quarter, const glm::dvec3& point) const {
    const glm::dvec3 vector(beam_.travel_or_from);
    if (beam_.kind == gpu::BEAM_DIRECTIONAL) return vector;
    if (beam_.kind == gpu::BEAM_POINT) return glm::normalize(point - vector);
    return rectangle_incoming(beam_, frame, f, quarter, point, problem_.eta.behind(level_, f));
  }

  void lambertian(std::uint32_t f, const FaceFrame& frame, const glm::dvec3& barycentric, const Power& power) {
    const double eta = problem_.eta.behind(level_, f);
    const LambertianBundle bundle = lambertian_bundle(eta);
    const auto directions = lambertian_directions(frame, f, eta);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const double share = 0.5 * bundle.share[i / 2];
      ray_.run(f, barycentric, directions[i], {power[0] * share, power[1] * share, power[2] * share});
    }
  }

  const Level& level_;
  const Problem& problem_;
  const gpu::BeamRecord& beam_;
  const Light& light_;
  Ray<Medium, Sink> ray_;
  Sink& sink_;
};

}  // namespace quadgraph
