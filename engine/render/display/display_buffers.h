// The display mesh on the device.
#pragma once

#include <cstdint>

#include "engine/device/memory.h"
#include "engine/file/graph.h"

namespace quadgraph {

// The arrays of DisplayMesh.
struct DisplayBuffers {
  std::uint32_t vertex_count = 0, triangle_count = 0;
  device::Buffer vertices;     // vec3, mm
  device::Buffer normals;      // vec3, unit
  device::Buffer triangles;    // uvec3
  device::Buffer face;         // uint
  device::Buffer barycentric;  // vec3
};

DisplayBuffers upload_display(device::Device& device, const DisplayMesh& mesh);

}  // namespace quadgraph
