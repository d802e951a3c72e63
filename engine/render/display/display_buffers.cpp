#include "engine/render/display/display_buffers.h"

namespace quadgraph {

DisplayBuffers upload_display(device::Device& context, const DisplayMesh& mesh) {
  return {static_cast<std::uint32_t>(mesh.vertices.size()),
          static_cast<std::uint32_t>(mesh.triangles.size()),
          device::upload(context, mesh.vertices, "display/vertices"),
          device::upload(context, mesh.normals, "display/normals"),
          device::upload(context, mesh.triangles, "display/triangles"),
          device::upload(context, mesh.face, "display/face"),
          device::upload(context, mesh.barycentric, "display/barycentric")};
}

}  // namespace quadgraph
