// The display mesh on the device.
#pragma once

#include <cstdint>

#include "engine/file/graph.h"
#include "engine/vk/memory.h"

namespace quadgraph {

// The arrays of DisplayMesh.
struct DisplayBuffers {
  std::uint32_t vertex_count = 0, triangle_count = 0;
  vk::Buffer vertices;     // vec3, mm
  vk::Buffer normals;      // vec3, unit
  vk::Buffer triangles;    // uvec3
  vk::Buffer face;         // uint
  vk::Buffer barycentric;  // vec3
};

DisplayBuffers upload_display(vk::Context& context, const DisplayMesh& mesh);

}  // namespace quadgraph
