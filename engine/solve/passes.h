// The compute pipelines of the solve, created at first use: compiling takes long on lavapipe, and no solve needs all.
#pragma once

#include <optional>

#include "engine/base/solve_options.h"
#include "engine/reference/stored_entries.h"
#include "engine/vk/pipeline.h"

namespace quadgraph {

// A pipeline that does not exist until it is wanted.
class LazyPass {
 public:
  LazyPass(vk::Spirv code, std::uint32_t push_size, const char* name, vk::Work work = vk::Work::each,
           std::uint32_t variant = 0)
      : code_(code), push_size_(push_size), name_(name), work_(work), variant_(variant) {}

  const vk::ComputePass& get(vk::Context& context) { return made(pass_, context, work_); }

  // The dispatch that has to follow; null if none has.
  const vk::ComputePass* conclusion(vk::Context& context) {
    if (work_ != vk::Work::reducing || !vk::few_workgroups(context)) return nullptr;
    return &made(conclusion_, context, vk::Work::conclusion);
  }

 private:
  const vk::ComputePass& made(std::optional<vk::ComputePass>& pass, vk::Context& context, vk::Work work) {
    if (!pass) pass.emplace(context, code_, push_size_, name_, vk::ComputePass::default_workgroup_size, variant_, work);
    return *pass;
  }

  vk::Spirv code_;
  std::uint32_t push_size_;
  const char* name_;
  vk::Work work_;
  std::uint32_t variant_;
  std::optional<vk::ComputePass> pass_, conclusion_;
};

// The two variants of a pass that touches fields.
struct ModelPass {
  LazyPass diffusion, sp3;

  LazyPass& of(Model model) { return model == Model::sp3 ? sp3 : diffusion; }
};

// The same of a pass that touches entries or rows, for both formats.
struct EntryPass {
  ModelPass packed, plain;

  LazyPass& of(Model model, EntryFormat format) { return (format == EntryFormat::plain ? plain : packed).of(model); }
};

struct Passes {
  Passes();

  LazyPass evaluate_material, edit_material, shape, irradiance_scale, walk_source, vertex_exitance, display_scale,
      vertex_unscattered, energy_total, surface_share, uncollided, gather_exitance, gather_nodes, gather_scale,
      gather_single, exchange, exchange_finer, exchange_enter, exchange_boxes, exchange_rays, deform, deform_nodes,
      deform_normals, deform_bounds, shape_state, grid_material;
  EntryPass assemble_fdm, assemble_fv, assemble_polygrid, assemble_edges, assemble_even, assemble_fem, eigenvalue_bound,
      cg_start, cg_multiply, cg_update, cg_direction, sweep, residual, chebyshev, coarse_solve, right_hand_side_fdm,
      right_hand_side_fv, right_hand_side_fem, right_hand_side_buried;
  ModelPass transfer, follow, correct, restrict, prolong, surface_change, exitance, energy, gather_phi;
};

}  // namespace quadgraph
