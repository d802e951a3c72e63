// How light enters through the outside faces: frames, refraction, and the directions that stand for uniform light.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "engine/file/graph.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

struct FaceFrame {
  std::array<glm::dvec3, 3> corners;  // mm
  glm::dvec3 normal{0};               // unit, outward
  double area = 0;                    // mm^2
};

FaceFrame frame_of(const Level& level, std::uint32_t f);

glm::dvec3 point_at(const FaceFrame& frame, const glm::dvec3& barycentric);

// Refraction of `outside` (unit, towards the surface) at outward normal n. At grazing incidence it still goes in.
glm::dvec3 refract(const glm::dvec3& outside, const glm::dvec3& n, double eta);

// Cosine inside of light that has the cosine `outside` outside.
double refracted_cosine(double outside, double eta);

// What uniform light is made of after it has entered: inside cosines and shares, which sum to 1.
struct LambertianBundle {
  std::array<double, gpu::LAMBERTIAN_NODES> mu, share;

  double mean_cosine() const;
};

LambertianBundle lambertian_bundle(double eta);

// Inside directions of rays for the bundle, two on opposite sides per cosine, turned by 90 degrees from one to the
// next; they move with the body.
std::array<glm::dvec3, 2 * gpu::LAMBERTIAN_NODES> lambertian_directions(const FaceFrame& frame, std::uint32_t f,
                                                                        double eta);

// Inside direction of the one ray by which BEAM_MEAN enters face f: the mean cosine of the bundle, and an azimuth that
// moves with the body and differs from face to face without order (GOLDEN_TURN).
glm::dvec3 mean_direction(const FaceFrame& frame, std::uint32_t f, double eta);

// The way that light of BEAM_RECTANGLE travels to a point of face f, in its quarter (3: the one in the middle).
glm::dvec3 rectangle_incoming(const gpu::BeamRecord& beam, const FaceFrame& frame, std::uint32_t f,
                              std::uint32_t quarter, const glm::dvec3& point, double eta);

}  // namespace quadgraph
