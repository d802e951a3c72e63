#include "engine/render/display/display_buffers.h"

namespace quadgraph {

DisplayBuffers upload_display(device::Device& device, const DisplayMesh& mesh) {
  return {static_cast<std::uint32_t>(mesh.vertices.size()),
          static_cast<std::uint32_t>(mesh.triangles.size()),
          device::upload(device, mesh.vertices, "display/vertices"),
          device::upload(device, mesh.normals, "display/normals"),
          device::upload(device, mesh.triangles, "display/triangles"),
          device::upload(device, mesh.face, "display/face"),
          device::upload(device, mesh.barycentric, "display/barycentric")};
}

}  // namespace quadgraph
