#include "engine/render/display/display_buffers.h"

namespace quadgraph {

DisplayBuffers upload_display(vk::Context& context, const DisplayMesh& mesh) {
  return {static_cast<std::uint32_t>(mesh.vertices.size()),
          static_cast<std::uint32_t>(mesh.triangles.size()),
          vk::upload(context, mesh.vertices, "display/vertices"),
          vk::upload(context, mesh.normals, "display/normals"),
          vk::upload(context, mesh.triangles, "display/triangles"),
          vk::upload(context, mesh.face, "display/face"),
          vk::upload(context, mesh.barycentric, "display/barycentric")};
}

}  // namespace quadgraph
