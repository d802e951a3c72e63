#include "engine/render/picture/radiance_probe.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "engine/base/error.h"
#include "engine/device/commands.h"
#include "engine/render/picture/rasteriser.h"
#include "interface/gather/radiance_probe.comp.h"

namespace quadgraph {
namespace {

void check(const Level& level, std::span<const std::uint32_t> face, std::span<const glm::vec3> direction) {
  if (face.size() != direction.size() || face.empty()) {
    throw InputError("radiance: " + std::to_string(face.size()) + " faces and " + std::to_string(direction.size()) +
                     " directions, as many of both are wanted, at least one");
  }
  for (std::size_t i = 0; i < face.size(); ++i) {
    const std::string where = "radiance " + std::to_string(i);
    if (face[i] >= level.face_count()) {
      throw InputError(where + ": face " + std::to_string(face[i]) + ", there are " +
                       std::to_string(level.face_count()));
    }
    const glm::uvec3& ids = level.faces[face[i]];
    const glm::vec3 p = level.vertices[ids.x];
    const glm::vec3 normal = glm::cross(level.vertices[ids.y] - p, level.vertices[ids.z] - p);
    if (!(std::abs(glm::length(direction[i]) - 1) < 1e-3f) || !(glm::dot(direction[i], normal) > 0)) {
      throw InputError(where + ": the direction must be of length 1 and point out of face " + std::to_string(face[i]));
    }
  }
}

}  // namespace

RadianceProbe::RadianceProbe(device::Device& device) : device_(device), pass_(device, shader::radiance_probe) {}

Leaving RadianceProbe::run(const Level& level, const GatherField& field, std::span<const std::uint32_t> face,
                           std::span<const glm::vec3> direction) {
  check(level, face, direction);
  const device::Buffer faces = device::upload(device_, face, "probe/faces");
  const device::Buffer directions = device::upload(device_, direction, "probe/directions");
  const device::Buffer radiance(device_, direction.size_bytes(), device::Place::device, "probe/radiance");
  const device::Buffer transmittance(device_, direction.size_bytes(), device::Place::device, "probe/transmittance");
  const gpu::RadianceProbePush push{.solid = field.solid_on_device().address(),
                                    .points = field.points().address(),
                                    .scale = field.scale().address(),
                                    .face = faces.address(),
                                    .direction = directions.address(),
                                    .radiance = radiance.address(),
                                    .transmittance = transmittance.address(),
                                    .count = static_cast<std::uint32_t>(face.size())};
  device::Commands commands(device_);
  commands.dispatch(pass_, push, face.size());
  commands.submit_and_wait();
  return {device::download<glm::vec3>(device_, radiance), device::download<glm::vec3>(device_, transmittance)};
}

}  // namespace quadgraph
