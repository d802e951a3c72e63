// The operator of one level, method and model on the device, with its solution and the vectors of the solvers.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/solve_options.h"
#include "engine/device/memory.h"
#include "engine/file/graph.h"
#include "engine/optics/boundary.h"
#include "engine/reference/stored_entries.h"
#include "engine/solve/level_elements.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

// How light comes into b.
struct Load {
  Source source;
  bool mean_rays;

  bool operator==(const Load&) const = default;
};

struct OperatorBuffers {
  Model model = Model::diffusion;
  EntryFormat format = EntryFormat::packed;
  EntryFormat stored = EntryFormat::packed;  // how entries lie: UNPACKED_ENTRIES of packing.h as plain ones
  std::uint32_t count = 0;                   // rows: carriers, each with one unknown or, in SP3, two
  std::uint32_t entries = 0;                 // off the diagonal, padding included
  std::uint32_t slice_rows = 0, slices = 0;
  device::Buffer slice_offset, entry, row_sum, diagonal;  // RowsRef; no diagonal with compact_rows
  device::Buffer majorant;                                // Entry per row (MajorantPush); fem only
  device::Buffer to_phi;                                  // vec3 per row; none with fem: 1
  device::Buffer b, x;                                    // scaled (gpu::Scale)
  device::Buffer r, p;                                    // residual, direction
  device::Buffer product;   // A p; in a relaxation, the other x; in a cycle, the direction, then the residual
  device::Buffer z, other;  // correction of a cycle, and a second buffer of it (make_room); fem only
  device::Buffer before;    // x of the last solve, on levels that have a finer one
  device::Buffer unit;      // vec3: the scale that x has
  device::Buffer state, state_on_host;  // SolveState, and the same, mapped
  device::Buffer damping;               // vec3; of a relaxation

  std::uint32_t surface_first = 0, surface_count = 0;  // carriers on the surface
  device::Buffer surface_share;                        // SurfaceShare of each
  device::Buffer surface_before, surface_start;        // vec3 of each: exitance at the last look, and at the start

  LevelElements* elements;                   // of its level: what its rows are assembled from
  device::Buffer grid_optical, grid_volume;  // of polygrids: what GridMaterialPush makes of the tets
  std::vector<std::uint32_t> layer_ends;     // rows of each layer and all above it

  std::optional<std::vector<Boundary>> assembled;  // for the present material, with these boundaries of bodies
  bool damped = false;                             // `damping` belongs to these rows
  bool majorised = false;                          // `majorant` does
  std::optional<Load> loaded;                      // b is that of the present light and rows, by this way in
  bool weighed = false;                            // surface_share belongs to the present light and vertices
  bool solved = false;                             // x has been solved for, if for other light or coefficients

  // Uploads the rows; values are undefined until assembled. `elements` outlive it.
  OperatorBuffers(device::Device& device, const Level& level, LevelElements& elements, std::uint32_t index,
                  Method method, Model model, EntryFormat format);

  // Makes what the assembly needs, and what smoothing in two steps does, unless it is there. `even`: the coefficients
  // are the same everywhere.
  void make_room(device::Device& device, const Level& level, bool even, bool two_steps);

  // Whether entry_shape makes the entries, and not the elements around each edge.
  bool by_entry(bool even) const { return even && !elements->moved; }

  std::uint64_t field_bytes() const { return (model == Model::sp3 ? 2 : 1) * sizeof(glm::vec3); }
  // Whether the sum of a row and its diagonal are both found from one record in row_sum
  // (shaders/solver/stored_rows.glsl).
  bool compact_rows() const { return model == Model::sp3 && format == EntryFormat::packed; }

  // Read for the diagonal of a row, and of a row's sum and diagonal together.
  std::uint64_t block_bytes() const;
  std::uint64_t row_bytes() const { return (compact_rows() ? 1 : 2) * block_bytes(); }
  std::uint64_t majorant_bytes() const { return (model == Model::sp3 ? 3 : 1) * sizeof(glm::vec3); }
  std::uint64_t entry_bytes() const { return stored_words(model, stored) * sizeof(std::uint32_t); }

  gpu::RowsRef rows() const;
  gpu::RightHandSideRef right_hand_side(const device::Buffer& reduction) const;
  std::uint64_t product_bytes() const;  // read by one product with the rows, diagonal left out

 private:
  Method method_;
  std::string prefix_;
};

}  // namespace quadgraph
