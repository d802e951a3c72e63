#include "engine/render/display/display_motion.h"

#include <glm/vec4.hpp>
#include <vector>

#include "interface/deform/deform_bounds.comp.h"
#include "interface/deform/deform_normals.comp.h"
#include "shaders/deform/deform_shared.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3), index_bytes = sizeof(std::uint32_t);

struct Incidence {
  std::vector<std::uint32_t> offset, triangle;
};

Incidence triangles_at_vertices(const DisplayMesh& mesh) {
  Incidence found;
  found.offset.assign(mesh.vertices.size() + 1, 0);
  for (const glm::uvec3& ids : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++found.offset[ids[k] + 1];
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) found.offset[v + 1] += found.offset[v];
  found.triangle.resize(found.offset.back());
  std::vector<std::uint32_t> next(found.offset.begin(), found.offset.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) found.triangle[next[mesh.triangles[t][k]]++] = t;
  }
  return found;
}

}  // namespace

DisplayMotion::DisplayMotion(const DisplayMesh& mesh)
    : mesh_(mesh), box_(quadgraph::rest_box(mesh.vertices)), vertices_({}, mesh.vertices, "deformation/display") {}

void DisplayMotion::make_room(device::Device& device) {
  if (sphere_.size() > 0) return;
  const Incidence incidence = triangles_at_vertices(mesh_);
  rest_normals_ = device::upload(device, mesh_.normals, "deformation/display normals at rest");
  offset_ = device::upload<std::uint32_t>(device, incidence.offset, "deformation/display offsets");
  incidence_ = device::upload<std::uint32_t>(device, incidence.triangle, "deformation/display triangles");
  sphere_ = {device, sizeof(glm::vec4), device::Place::device, "deformation/bounds"};
  sphere_on_host_ = {device, sizeof(glm::vec4), device::Place::host, "deformation/bounds, read back"};
}

void DisplayMotion::record(Workspace& work, std::span<const Deformer> list, const DisplayBuffers& buffers) {
  device::Device& device = work.recorder.device();
  if (list.empty()) {
    vertices_.put_back(device, buffers.vertices);
    device::write_bytes(device, buffers.normals, std::as_bytes(mesh_.normals));
    return;
  }
  make_room(device);
  vertices_.record(work, list, box_, buffers.vertices);
  const gpu::DeformNormalsPush normals{.rest = vertices_.rest().address(),
                                       .moved = buffers.vertices.address(),
                                       .rest_normals = rest_normals_.address(),
                                       .normals = buffers.normals.address(),
                                       .triangles = buffers.triangles.address(),
                                       .offset = offset_.address(),
                                       .incidence = incidence_.address(),
                                       .count = buffers.vertex_count};
  work.recorder.dispatch(work.passes.of(shader::deform_normals), normals, buffers.vertex_count, "display normals",
                         buffers.vertex_count * (3 * vec3_bytes + index_bytes) +
                             3ull * buffers.triangle_count * (index_bytes + sizeof(glm::uvec3) + 6 * vec3_bytes));
  const gpu::DeformBoundsPush bounds{
      .vertices = buffers.vertices.address(), .sphere = sphere_.address(), .count = buffers.vertex_count};
  work.recorder.dispatch(work.passes.of(shader::deform_bounds), bounds, 1, "bounds",
                         2 * buffers.vertex_count * vec3_bytes);
  work.recorder.copy(sphere_, sphere_on_host_, sphere_.size());
}

Sphere DisplayMotion::bounds() const {
  const glm::vec4 sphere = sphere_on_host_.mapped_as<glm::vec4>()[0];
  return {glm::vec3(sphere), sphere.w};
}

}  // namespace quadgraph
