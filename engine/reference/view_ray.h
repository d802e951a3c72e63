// One ray against the light that leaves the body along it; see radiance.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "engine/optics/fresnel.h"
#include "engine/reference/attenuation.h"
#include "engine/reference/radiance.h"
#include "engine/reference/tet_ray.h"
#include "shaders/gather/gather_shared.h"

namespace quadgraph {

// What is inside at a vertex, one channel.
template <class Real>
struct InsideValues {
  Real phi, entry, depth;
};

// Where a ray ends: each channel of it has less than `end` left, and behind lies less than `end` of its radiance unless
// less than `least` is left.
struct ViewEnd {
  double end{gpu::GATHER_END}, least{gpu::GATHER_LEAST};
};

// `Medium` is one of medium.h; `Inside` gives InsideValues at(vertex, channel) of its numbers.
template <class Medium, class Inside>
class ViewRay {
 public:
  using Real = typename Medium::Real;
  using Radiance = std::array<Real, 3>;  // W/(mm^2 sr), inside

  ViewRay(const Level& level, const Problem& problem, const Medium& medium, const Inside& inside,
          std::span<const CornerNormals> normals, const ViewEnd& end = {})
      : level_(level), problem_(problem), medium_(medium), inside_(inside), normals_(normals), end_(end), ray_(level) {}

  Radiance run(std::uint32_t f, const glm::dvec3& barycentric, glm::dvec3 direction) {
    radiance_.fill(Real(0));
    left_.fill(Real(1));
    escapes_.clear();
    ray_.start_on_face(f, barycentric);
    read_tet();
    for (std::uint32_t step = 0; step < gpu::GATHER_STEPS; ++step) {
      const TetRay::Exit exit = ray_.find_exit(direction);
      if (!exit.found) break;
      for (std::size_t c = 0; c < 3; ++c) cross(exit, c);
      const std::uint32_t next = ray_.leave(exit);
      read_corners();
      if (ended()) break;
      if (next < level_.tet_count()) {
        ray_.enter(next);
        read_tet();
      } else {
        direction = meet_surface(next - level_.tet_count(), direction);
      }
    }
    for (std::size_t c = 0; c < 3; ++c) radiance_[c] = radiance_[c] + left_[c] * even_radiance(c);
    return radiance_;
  }

  // Where the last one left the body.
  const std::vector<Escape>& escapes() const { return escapes_; }

 private:
  using Values = InsideValues<Real>;

  void read_tet() {
    for (int c = 0; c < 3; ++c) here_[static_cast<std::size_t>(c)] = medium_.at(ray_.tet(), c);
    read_corners();
  }

  void read_corners() {
    for (std::size_t k = 0; k < 4; ++k) {
      for (int c = 0; c < 3; ++c) corners_[static_cast<std::size_t>(c)][k] = inside_.at(ray_.corner(k).vertex, c);
    }
  }

  // By linear interpolation.
  static Values mean(const std::array<Values, 4>& at, const std::array<double, 4>& share) {
    const auto sum = [&](Real Values::* part) {
      return at[0].*part * share[0] + at[1].*part * share[1] + at[2].*part * share[2] + at[3].*part * share[3];
    };
    return {sum(&Values::phi), sum(&Values::entry), sum(&Values::depth)};
  }

  // Fluence of light that has not scattered, were it linear between the corners, at shares of them; `take` turns a
  // corner's numbers into those of the result.
  template <class Take>
  auto linear_light(std::size_t c, const std::array<double, 4>& share, const Take& take) const {
    using std::exp;
    const auto at = [&](std::size_t k) {
      return take(corners_[c][k].entry) * exp(-take(corners_[c][k].depth)) * share[k];
    };
    return at(0) + at(1) + at(2) + at(3);
  }

  static double plain(const Real& number) { return value_of(number); }
  static Real whole(const Real& number) { return number; }

  // Of light that has not scattered, what is made of mean factors held to what is `linear` between the corners, as in
  // gather_fields.glsl.
  template <class Linear>
  static Real held(const Real& uncollided, const Linear& linear) {
    return value_of(uncollided) <= linear(plain) ? uncollided : beyond(uncollided, linear(whole));
  }

  template <class Number>
  static Number beyond(const Number& uncollided, const Number& linear) {
    return linear * (2.0 - linear / uncollided);
  }

  std::array<double, 4> at_point() const {
    return {ray_.corner(0).lambda, ray_.corner(1).lambda, ray_.corner(2).lambda, ray_.corner(3).lambda};
  }

  void cross(const TetRay::Exit& exit, std::size_t c) {
    using std::exp;
    const Values from = mean(corners_[c], at_point()), to = mean(corners_[c], exit.lambda);
    const Real tau = here_[c].extinction() * exit.length;
    const Real x = tau + to.depth - from.depth;  // along the ray the light may become brighter
    Real uncollided = value_of(x) >= 0 ? exp(-from.depth) * weighted(from.entry, to.entry, x)
                                       : exp(-to.depth - tau) * weighted(to.entry, from.entry, -x);
    uncollided = held(uncollided, [&](const auto& take) {
      return weighted(linear_light(c, at_point(), take), linear_light(c, exit.lambda, take), take(tau));
    });
    const Real fluence = weighted(from.phi, to.phi, tau) + uncollided;
    const Real scattering = here_[c].scattering * (exit.length / (4 * glm::pi<double>()));
    radiance_[c] = radiance_[c] + left_[c] * scattering * fluence;
    left_[c] = left_[c] * exp(-tau);
  }

  // Whether what lies behind the ray's point matters little.
  bool ended() const {
    for (std::size_t c = 0; c < 3; ++c) {
      const double left = value_of(left_[c]);
      if (left > end_.end) return false;
      if (left > end_.least && left * even_value(c) > end_.end * value_of(radiance_[c])) return false;
    }
    return true;
  }

  // Mirrors the ray, by the share that stays inside.
  glm::dvec3 meet_surface(std::uint32_t f, const glm::dvec3& direction) {
    const glm::dvec3 flat = ray_.face_normal();
    if (level_.reflecting(f)) return mirrored(direction, flat);
    const glm::dvec3 normal = normals_.empty() ? flat : smooth_normal(f);
    const double cosine = std::clamp(glm::dot(direction, normal), 0.0, 1.0);
    const double eta = problem_.eta.behind(level_, f), kept = internal_reflectance(cosine, eta);
    if (kept < 1) {
      glm::dvec3 point(0);
      for (std::size_t k = 0; k < 4; ++k) point += ray_.corner(k).lambda * ray_.corner(k).position;
      const double outside = std::sqrt(std::max(1 - eta * eta * (1 - cosine * cosine), 0.0));
      const glm::dvec3 way = glm::normalize(eta * (direction - cosine * normal) + outside * normal);
      const glm::dvec3 left(value_of(left_[0]), value_of(left_[1]), value_of(left_[2]));
      escapes_.push_back({(1 - kept) * left, f, point, outward_of(flat, way)});
    }
    for (Real& left : left_) left = left * kept;
    return -outward_of(flat, 2 * cosine * normal - direction);
  }

  // `way`, turned out of the face of normal `flat` if it is not.
  static glm::dvec3 outward_of(const glm::dvec3& flat, const glm::dvec3& way) {
    return glm::normalize(way + std::max(double{gpu::LEAST_VIEW_COSINE} - glm::dot(way, flat), 0.0) * flat);
  }

  // At the ray's point, on outside face f opposite to corner 3.
  glm::dvec3 smooth_normal(std::uint32_t f) const {
    glm::dvec3 barycentric(0);
    for (int k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (ray_.corner(c).vertex == level_.faces[f][k]) barycentric[k] = ray_.corner(c).lambda;
      }
    }
    return normal_at(normals_[f], barycentric);
  }

  // Radiance at the ray's point, were all behind it as it is there; 0 in a clear region.
  Real even_radiance(std::size_t c) const {
    using std::exp;
    if (value_of(here_[c].extinction()) == 0) return Real(0);
    const Values point = mean(corners_[c], at_point());
    Real uncollided = point.entry * exp(-point.depth);
    uncollided = held(uncollided, [&](const auto& take) { return linear_light(c, at_point(), take); });
    return here_[c].albedo() * (1 / (4 * glm::pi<double>())) * (point.phi + uncollided);
  }

  double even_value(std::size_t c) const {
    const double sigma_t = value_of(here_[c].scattering) + value_of(here_[c].absorption);
    double phi = 0, entry = 0, depth = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Values& at = corners_[c][k];
      phi += ray_.corner(k).lambda * value_of(at.phi);
      entry += ray_.corner(k).lambda * value_of(at.entry);
      depth += ray_.corner(k).lambda * value_of(at.depth);
    }
    const double albedo = sigma_t > 0 ? value_of(here_[c].scattering) / sigma_t : 0;
    double uncollided = entry * std::exp(-depth);
    const double linear = linear_light(c, at_point(), plain);
    if (uncollided > linear) uncollided = beyond(uncollided, linear);
    return albedo / (4 * glm::pi<double>()) * (phi + uncollided);
  }

  const Level& level_;
  const Problem& problem_;
  const Medium& medium_;
  const Inside& inside_;
  std::span<const CornerNormals> normals_;
  ViewEnd end_;
  TetRay ray_;
  std::array<Coefficients<Real>, 3> here_{};        // by channel
  std::array<std::array<Values, 4>, 3> corners_{};  // by channel, of the ray's corners
  Radiance left_{};                                 // e^-tau, less what left through faces
  Radiance radiance_{};
  std::vector<Escape> escapes_;
};

}  // namespace quadgraph
