// The operator of one level and method on the device, with its solution and the vectors of the solvers.
#pragma once

#include "engine/graph/graph.h"
#include "engine/graph/solution.h"
#include "engine/vk/memory.h"
#include "shaders/solve_shared.h"

namespace quadgraph {

struct OperatorBuffers {
  std::uint32_t count = 0;    // rows
  std::uint32_t entries = 0;  // off the diagonal, padding included
  std::uint32_t slices = 0;
  vk::Buffer slice_offset, column, weight, diagonal;  // RowsRef
  vk::Buffer to_phi;
  vk::Buffer b, x;     // scaled (gpu::Scale)
  vk::Buffer r, p;     // residual, direction
  vk::Buffer product;  // A p; in a relaxation, the other x
  vk::Buffer state;    // SolveState
  vk::Buffer damping;  // vec3

  vk::Buffer tet_offset, tet_incidence;    // fem only
  vk::Buffer face_offset, face_incidence;  // fem; the graph methods on the finest level only

  bool assembled = false;  // for the present material
  bool damped = false;     // `damping` belongs to these rows
  bool loaded = false;     // b is that of the present q and rows

  // Uploads the structure; values are undefined until assembled.
  OperatorBuffers(vk::Context& context, const Level& level, std::uint32_t index, Method method);

  gpu::RowsRef rows() const;
  std::uint64_t product_bytes() const;  // read by one product with the rows, diagonal left out
};

}  // namespace quadgraph
