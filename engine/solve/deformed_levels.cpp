#include "engine/solve/deformed_levels.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <string>

#include "engine/solve/moved_bytes.h"
#include "interface/deform/deform_nodes.comp.h"
#include "interface/deform/shape_state.comp.h"
#include "shaders/deform/deform_shared.h"

namespace quadgraph {
namespace {

// Volume that a tet counts for at least, as a share of the cube of the rest box's diagonal, so that a body without any
// volume is finite.
constexpr double least_volume = 1e-15;

std::uint32_t elements_of(const Level& level) {
  return std::max(level.tet_count(), level.face_count());
}

double six_volume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  return glm::dot(b - a, glm::cross(c - a, d - a));
}

// Barycentric coordinates of every node in its tet.
std::vector<glm::vec4> places_of(const Level& rest) {
  std::vector<glm::vec4> places;
  places.reserve(rest.nodes.size());
  for (std::size_t i = 0; i < rest.nodes.size(); ++i) {
    const glm::uvec4& ids = rest.tets[i < rest.tets.size() ? i : rest.face_tets[i - rest.tets.size()]];
    const glm::dvec3 p[4] = {glm::dvec3(rest.vertices[ids[0]]), glm::dvec3(rest.vertices[ids[1]]),
                             glm::dvec3(rest.vertices[ids[2]]), glm::dvec3(rest.vertices[ids[3]])};
    const glm::dvec3 x(rest.nodes[i]);
    const glm::dvec4 parts(six_volume(x, p[1], p[2], p[3]), six_volume(p[0], x, p[2], p[3]),
                           six_volume(p[0], p[1], x, p[3]), six_volume(p[0], p[1], p[2], x));
    places.emplace_back(parts / six_volume(p[0], p[1], p[2], p[3]));
  }
  return places;
}

}  // namespace

std::string deformed_text(const ShapeState& state) {
  if (state.inverted == 0 && state.flat == 0) return "";
  char worst[32];
  std::snprintf(worst, sizeof(worst), "%.2g", state.worst);
  return std::to_string(state.inverted) + " of " + std::to_string(state.tets) + " tets are turned inside out, " +
         std::to_string(state.flat) + " nearly flat (worst quality " + worst +
         "); they count as their mirror images, and as thicker";
}

DeformedLevels::DeformedLevels(const std::vector<Level>& rest) : rest_(rest), measured_(rest.size()) {
  for (std::uint32_t i = 0; i < rest.size(); ++i) {
    meshes_.emplace_back(i, rest[i].vertices, "deformation/level " + std::to_string(i));
  }
}

void DeformedLevels::make_room(device::Device& device) {
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    Measured& measured = measured_[i];
    if (measured.sums.size() > 0) continue;
    const std::string prefix = "deformation/level " + std::to_string(i) + " ";
    measured.step = surface_sample_step(rest_[i]);
    const std::uint64_t sums = device::workgroups(elements_of(rest_[i])) * sizeof(gpu::ShapeSums);
    const std::uint64_t samples = (rest_[i].face_count() / measured.step + 1) * sizeof(glm::vec2);
    measured.sums = {device, sums, device::Place::device, prefix + "sums"};
    measured.samples = {device, samples, device::Place::device, prefix + "samples"};
    measured.sums_on_host = {device, sums, device::Place::host, prefix + "sums, read back"};
    measured.samples_on_host = {device, samples, device::Place::host, prefix + "samples, read back"};
  }
}

void DeformedLevels::record(Workspace& work, std::span<const Deformer> list, const RestBox& box,
                            std::vector<LevelBuffers>& levels) {
  make_room(work.recorder.device());
  const double extent = glm::length(box.high - box.low);
  const auto least = static_cast<float>(least_volume * extent * extent * extent);
  const bool moves_only = only_moves(list);
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    meshes_[i].record(work, list, box, levels[i].vertices);
    record_nodes(work, i, levels[i]);
    levels[i].least = moves_only ? gpu::LeastTet{} : gpu::LeastTet{least_quality, least};
    record_state(work, i, levels[i]);
  }
  list_.assign(list.begin(), list.end());
}

void DeformedLevels::record_nodes(Workspace& work, std::uint32_t number, const LevelBuffers& level) {
  if (level.nodes.size() == 0) return;
  device::Buffer& place = measured_[number].place;
  if (place.size() == 0) {
    place = device::upload<glm::vec4>(work.recorder.device(), places_of(rest_[number]), "deformation/places of nodes");
  }
  const gpu::DeformNodesPush push{.vertices = level.vertices.address(),
                                  .tets = level.tets.address(),
                                  .face_tets = level.face_tets.address(),
                                  .place = place.address(),
                                  .nodes = level.nodes.address(),
                                  .tet_count = level.tet_count,
                                  .count = level.node_count};
  work.recorder.dispatch(work.passes.of(shader::deform_nodes), push, level.node_count, "deform",
                         level.node_count * (sizeof(glm::uvec4) + sizeof(glm::vec4) + 5 * vec3_bytes));
}

void DeformedLevels::record_state(Workspace& work, std::uint32_t number, const LevelBuffers& level) {
  const Measured& measured = measured_[number];
  const gpu::ShapeStatePush push{.vertices = level.vertices.address(),
                                 .tets = level.tets.address(),
                                 .faces = level.faces.address(),
                                 .face_kinds = level.face_kind.address(),
                                 .face_tets = level.face_tets.address(),
                                 .sums = measured.sums.address(),
                                 .samples = measured.samples.address(),
                                 .tet_count = level.tet_count,
                                 .face_count = level.face_count,
                                 .step = measured.step,
                                 .least = level.least};
  work.recorder.dispatch(work.passes.of(shader::shape_state), push, elements_of(rest_[number]), "tet quality",
                         level.tet_count * (sizeof(glm::uvec4) + 4 * vec3_bytes) +
                             level.face_count * (sizeof(glm::uvec3) + 3 * vec3_bytes) + measured.sums.size());
  work.recorder.copy(measured.sums, measured.sums_on_host, measured.sums.size());
  work.recorder.copy(measured.samples, measured.samples_on_host, measured.samples.size());
}

ShapeState DeformedLevels::state(std::uint32_t number) const {
  const Measured& measured = measured_[number];
  const Level& level = rest_[number];
  ShapeState state{.tets = level.tet_count()};
  double inverted = 0, flat = 0, conduction = 0, volume = 0, area = 0;
  for (const gpu::ShapeSums& sums : measured.sums_on_host.mapped_as<gpu::ShapeSums>()) {
    inverted += static_cast<double>(sums.inverted);
    flat += static_cast<double>(sums.flat_count);
    conduction += static_cast<double>(sums.conduction);
    volume += static_cast<double>(sums.volume);
    area += static_cast<double>(sums.area);
    state.worst = std::min(state.worst, static_cast<double>(sums.worst));
  }
  state.inverted = static_cast<std::uint32_t>(inverted);
  state.flat = static_cast<std::uint32_t>(flat);
  state.conduction = volume > 0 ? conduction / volume : HUGE_VAL;
  state.chord = area > 0 ? 4 * volume / area : HUGE_VAL;
  const auto samples = measured.samples_on_host.mapped_as<glm::vec2>();
  for (std::uint32_t f = 0; f < level.face_count(); f += measured.step) {
    if (level.reflecting(f)) continue;
    const glm::dvec2 sample(samples[f / measured.step]);
    state.samples.push_back({sample.x, sample.y, level.face_tets[f]});
  }
  return state;
}

void DeformedLevels::put_back(device::Device& device, std::vector<LevelBuffers>& levels) {
  for (std::size_t i = 0; i < levels.size(); ++i) {
    meshes_[i].put_back(device, levels[i].vertices);
    if (levels[i].nodes.size() > 0) device::write_bytes(device, levels[i].nodes, std::as_bytes(rest_[i].nodes));
    levels[i].least = {};
    levels[i].inverted = false;
  }
  list_.clear();
}

}  // namespace quadgraph
