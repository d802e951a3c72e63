// The structs that the passes of the solve share with C++ lie in memory as the compiled shaders read them: offsets of
// members, and strides of the arrays they form.
#include <doctest/doctest.h>

#include "shaders/assemble/assembly_shared.h"
#include "shaders/material/edits.h"
#include "shaders/surface/surface_shared.h"
#include "spirv/assemble_edges.comp.h"
#include "spirv/assemble_edges_sp3.comp.h"
#include "spirv/assemble_even.comp.h"
#include "spirv/assemble_even_sp3.comp.h"
#include "spirv/assemble_fdm.comp.h"
#include "spirv/assemble_fdm_sp3.comp.h"
#include "spirv/assemble_fem.comp.h"
#include "spirv/assemble_fem_sp3.comp.h"
#include "spirv/assemble_fv.comp.h"
#include "spirv/assemble_fv_sp3.comp.h"
#include "spirv/cg_direction.comp.h"
#include "spirv/cg_direction_sp3.comp.h"
#include "spirv/cg_multiply.comp.h"
#include "spirv/cg_multiply_sp3.comp.h"
#include "spirv/cg_start.comp.h"
#include "spirv/cg_start_sp3.comp.h"
#include "spirv/cg_update.comp.h"
#include "spirv/cg_update_sp3.comp.h"
#include "spirv/display_scale.comp.h"
#include "spirv/edit_material.comp.h"
#include "spirv/eigenvalue_bound.comp.h"
#include "spirv/eigenvalue_bound_sp3.comp.h"
#include "spirv/energy.comp.h"
#include "spirv/energy_sp3.comp.h"
#include "spirv/evaluate_material.comp.h"
#include "spirv/exchange.comp.h"
#include "spirv/exchange_finer.comp.h"
#include "spirv/exitance.comp.h"
#include "spirv/exitance_sp3.comp.h"
#include "spirv/irradiance_scale.comp.h"
#include "spirv/right_hand_side_fdm.comp.h"
#include "spirv/right_hand_side_fdm_sp3.comp.h"
#include "spirv/right_hand_side_fem.comp.h"
#include "spirv/right_hand_side_fem_sp3.comp.h"
#include "spirv/right_hand_side_fv.comp.h"
#include "spirv/right_hand_side_fv_sp3.comp.h"
#include "spirv/shape.comp.h"
#include "spirv/sweep.comp.h"
#include "spirv/sweep_sp3.comp.h"
#include "spirv/transfer.comp.h"
#include "spirv/transfer_sp3.comp.h"
#include "spirv/vertex_exitance.comp.h"
#include "tests/cpp/fixtures/layout_compare.h"

using namespace quadgraph;

TEST_CASE("structs in buffers") {
  compare(assemble_fem_comp, "Optical", {MEMBER(Optical, sigma_s_prime), MEMBER(Optical, sigma_a)});
  compare(evaluate_material_comp, "Material",
          {MEMBER(Material, sigma_s_prime), MEMBER(Material, sigma_a), MEMBER(Material, eta), MEMBER(Material, pattern),
           MEMBER(Material, second_sigma_s_prime), MEMBER(Material, second_sigma_a), MEMBER(Material, period),
           MEMBER(Material, sharpness)});
  compare(edit_material_comp, "MaterialEdit",
          {MEMBER(MaterialEdit, sigma_s_prime), MEMBER(MaterialEdit, sigma_a), MEMBER(MaterialEdit, low),
           MEMBER(MaterialEdit, high), MEMBER(MaterialEdit, depth_from), MEMBER(MaterialEdit, depth_to),
           MEMBER(MaterialEdit, radius), MEMBER(MaterialEdit, softness), MEMBER(MaterialEdit, operation),
           MEMBER(MaterialEdit, coefficients), MEMBER(MaterialEdit, first_point), MEMBER(MaterialEdit, point_count),
           MEMBER(MaterialEdit, placed), MEMBER(MaterialEdit, box), MEMBER(MaterialEdit, image),
           MEMBER(MaterialEdit, mask)});
  compare(edit_material_comp, "ImageBox",
          {MEMBER(ImageBox, centre), MEMBER(ImageBox, right), MEMBER(ImageBox, up), MEMBER(ImageBox, half_size)});
  compare(edit_material_comp, "ImageLevels",
          {MEMBER(ImageLevels, first), MEMBER(ImageLevels, columns), MEMBER(ImageLevels, rows),
           MEMBER(ImageLevels, levels)});
  compare(cg_start_comp, "RowsRef",
          {MEMBER(RowsRef, slice_offset), MEMBER(RowsRef, entry), MEMBER(RowsRef, row_sum), MEMBER(RowsRef, diagonal)});
  compare(cg_start_comp, "SolveState",
          {MEMBER(SolveState, gate),      MEMBER(SolveState, coarse),     MEMBER(SolveState, surface),
           MEMBER(SolveState, check),     MEMBER(SolveState, groups),     MEMBER(SolveState, surface_groups),
           MEMBER(SolveState, norm),      MEMBER(SolveState, square),     MEMBER(SolveState, rz),
           MEMBER(SolveState, alpha),     MEMBER(SolveState, beta),       MEMBER(SolveState, residual),
           MEMBER(SolveState, checked),   MEMBER(SolveState, iterations), MEMBER(SolveState, status),
           MEMBER(SolveState, channel),   MEMBER(SolveState, earlier),    MEMBER(SolveState, change),
           MEMBER(SolveState, algebraic), MEMBER(SolveState, difference), MEMBER(SolveState, looked),
           MEMBER(SolveState, looks),     MEMBER(SolveState, slow),       MEMBER(SolveState, restarts)});
  compare(exitance_comp, "Boundary",
          {MEMBER(Boundary, k11), MEMBER(Boundary, k12), MEMBER(Boundary, k22), MEMBER(Boundary, source),
           MEMBER(Boundary, reflected)});
  compare(exitance_comp, "Clip", {MEMBER(Clip, factor), MEMBER(Clip, share)});
  compare(exitance_comp, "Scale", {MEMBER(Scale, scale), MEMBER(Scale, inverse), MEMBER(Scale, unlit)});
  compare(energy_comp, "EnergySums",
          {MEMBER(EnergySums, entered), MEMBER(EnergySums, exitance), MEMBER(EnergySums, absorbed)});
}

TEST_CASE("arrays in buffers have the stride of their C++ element") {
  // What both variants see alike, then what a carrier and an entry take in each.
  const std::vector<std::pair<std::string, std::size_t>> common = {{"RowFloats", sizeof(float)},
                                                                   {"RowUints", sizeof(std::uint32_t)},
                                                                   {"AssemblyFloats", sizeof(float)},
                                                                   {"AssemblyUints", sizeof(std::uint32_t)},
                                                                   {"AssemblyVec2s", sizeof(glm::vec2)},
                                                                   {"AssemblyUvec2s", sizeof(glm::uvec2)},
                                                                   {"Uints", sizeof(std::uint32_t)},
                                                                   {"Vec3s", sizeof(glm::vec3)},
                                                                   {"Uvec3s", sizeof(glm::uvec3)},
                                                                   {"Uvec4s", sizeof(glm::uvec4)},
                                                                   {"Opticals", sizeof(gpu::Optical)},
                                                                   {"SolveStates", sizeof(gpu::SolveState)},
                                                                   {"Scales", sizeof(gpu::Scale)},
                                                                   {"Clips", sizeof(gpu::Clip)},
                                                                   {"EnergySumsArray", sizeof(gpu::EnergySums)},
                                                                   {"Reduction", sizeof(glm::vec3)}};
  const std::vector<vk::Spirv> diffusion = {vk::Spirv(evaluate_material_comp),
                                            vk::Spirv(edit_material_comp),
                                            vk::Spirv(shape_comp),
                                            vk::Spirv(irradiance_scale_comp),
                                            vk::Spirv(display_scale_comp),
                                            vk::Spirv(assemble_fdm_comp),
                                            vk::Spirv(assemble_fv_comp),
                                            vk::Spirv(assemble_edges_comp),
                                            vk::Spirv(assemble_even_comp),
                                            vk::Spirv(assemble_fem_comp),
                                            vk::Spirv(right_hand_side_fdm_comp),
                                            vk::Spirv(right_hand_side_fv_comp),
                                            vk::Spirv(right_hand_side_fem_comp),
                                            vk::Spirv(eigenvalue_bound_comp),
                                            vk::Spirv(transfer_comp),
                                            vk::Spirv(cg_start_comp),
                                            vk::Spirv(cg_multiply_comp),
                                            vk::Spirv(cg_update_comp),
                                            vk::Spirv(cg_direction_comp),
                                            vk::Spirv(sweep_comp),
                                            vk::Spirv(exitance_comp),
                                            vk::Spirv(vertex_exitance_comp),
                                            vk::Spirv(energy_comp),
                                            vk::Spirv(exchange_comp),
                                            vk::Spirv(exchange_finer_comp)};
  const std::vector<vk::Spirv> sp3 = {vk::Spirv(assemble_fdm_sp3_comp),
                                      vk::Spirv(assemble_fv_sp3_comp),
                                      vk::Spirv(assemble_edges_sp3_comp),
                                      vk::Spirv(assemble_even_sp3_comp),
                                      vk::Spirv(assemble_fem_sp3_comp),
                                      vk::Spirv(right_hand_side_fdm_sp3_comp),
                                      vk::Spirv(right_hand_side_fv_sp3_comp),
                                      vk::Spirv(right_hand_side_fem_sp3_comp),
                                      vk::Spirv(eigenvalue_bound_sp3_comp),
                                      vk::Spirv(transfer_sp3_comp),
                                      vk::Spirv(cg_start_sp3_comp),
                                      vk::Spirv(cg_multiply_sp3_comp),
                                      vk::Spirv(cg_update_sp3_comp),
                                      vk::Spirv(cg_direction_sp3_comp),
                                      vk::Spirv(sweep_sp3_comp),
                                      vk::Spirv(exitance_sp3_comp),
                                      vk::Spirv(energy_sp3_comp)};
  for (const std::size_t moments : {1, 2}) {
    auto expected = common;
    if (moments == 1) {  // what no pass of fields has
      expected.emplace_back("Floats", sizeof(float));
      expected.emplace_back("MaterialEdits", sizeof(gpu::MaterialEdit));
      expected.emplace_back("Uvec2s", sizeof(glm::uvec2));
    }
    expected.emplace_back("Fields", moments * sizeof(glm::vec3));
    expected.emplace_back("Entries", (moments == 2 ? 3 : 1) * sizeof(glm::vec3));
    std::map<std::string, int> seen;
    for (const vk::Spirv code : moments == 2 ? sp3 : diffusion) {
      const SpirvLayout layout(code);
      for (const auto& [block, bytes] : expected) {
        const auto found = layout.block_stride.find(block);
        if (found == layout.block_stride.end()) continue;
        CAPTURE(block);
        CHECK(found->second == bytes);
        ++seen[block];
      }
    }
    for (const auto& [block, bytes] : expected) {
      CAPTURE(block);
      CHECK(seen[block] > 0);
    }
  }
}

TEST_CASE("a reduction starts with its ticket") {
  const SpirvLayout layout(cg_start_comp);
  CHECK(layout.offset.at("Reduction").at("ticket") == 0);
  CHECK(layout.offset.at("Reduction").at("partials") == 4);
}
