// The structs of shaders/gather/gather_shared.h lie in memory as the compiled shaders read them.
#include "shaders/gather/gather_shared.h"
#include "spirv/gather_exitance.comp.h"
#include "spirv/gather_nodes.comp.h"
#include "spirv/gather_phi.comp.h"
#include "spirv/gather_phi_sp3.comp.h"
#include "spirv/gather_scale.comp.h"
#include "spirv/gather_single.comp.h"
#include "spirv/radiance_probe.comp.h"
#include "spirv/uncollided.comp.h"
#include "tests/cpp/fixtures/layout_compare.h"

using namespace quadgraph;

TEST_CASE("what the gather keeps at vertices") {
  const SpirvLayout layout((vk::Spirv(radiance_probe_comp)));
  compare(radiance_probe_comp, "GatherPoint",
          {MEMBER(GatherPoint, phi), MEMBER(GatherPoint, entry), MEMBER(GatherPoint, depth)});
  compare(radiance_probe_comp, "GatherScale",
          {MEMBER(GatherScale, factor), MEMBER(GatherScale, rest), MEMBER(GatherScale, least)});
  CHECK(layout.stride.at("GatherPoint") == sizeof(gpu::GatherPoint));
  CHECK(layout.stride.at("GatherScale") == sizeof(gpu::GatherScale));
  CHECK(layout.stride.at("SolidRef") == sizeof(gpu::SolidRef));
  compare(radiance_probe_comp, "SolidRef", {MEMBER(SolidRef, body), MEMBER(SolidRef, tree)});
  compare(radiance_probe_comp, "TreeRef",
          {MEMBER(TreeRef, order), MEMBER(TreeRef, leaf_begin), MEMBER(TreeRef, boxes), MEMBER(TreeRef, leaf_count)});
  compare(gather_nodes_comp, "GatherNode",
          {MEMBER(GatherNode, exitance), MEMBER(GatherNode, gathered), MEMBER(GatherNode, normal),
           MEMBER(GatherNode, place), MEMBER(GatherNode, area)});
  CHECK(SpirvLayout((vk::Spirv(gather_nodes_comp))).stride.at("GatherNode") == sizeof(gpu::GatherNode));
}

TEST_CASE("push constants of the gather") {
  for (const vk::Spirv code : {vk::Spirv(gather_phi_comp), vk::Spirv(gather_phi_sp3_comp)}) {
    compare(code, "GatherPhiPush",
            {MEMBER(GatherPhiPush, x), MEMBER(GatherPhiPush, to_phi), MEMBER(GatherPhiPush, scale),
             MEMBER(GatherPhiPush, points), MEMBER(GatherPhiPush, count)});
  }
  compare(uncollided_comp, "UncollidedPush",
          {MEMBER(UncollidedPush, body), MEMBER(UncollidedPush, start), MEMBER(UncollidedPush, nearest),
           MEMBER(UncollidedPush, face_offset), MEMBER(UncollidedPush, face_incidence), MEMBER(UncollidedPush, beams),
           MEMBER(UncollidedPush, beam_q), MEMBER(UncollidedPush, points), MEMBER(UncollidedPush, beam_count),
           MEMBER(UncollidedPush, vertex_count), MEMBER(UncollidedPush, surface_vertex_count)});
  compare(gather_exitance_comp, "GatherExitancePush",
          {MEMBER(GatherExitancePush, body), MEMBER(GatherExitancePush, points), MEMBER(GatherExitancePush, exitance)});
  compare(gather_nodes_comp, "GatherNodesPush",
          {MEMBER(GatherNodesPush, solid), MEMBER(GatherNodesPush, gathered), MEMBER(GatherNodesPush, exitance),
           MEMBER(GatherNodesPush, nodes), MEMBER(GatherNodesPush, first), MEMBER(GatherNodesPush, count)});
  compare(
      gather_scale_comp, "GatherScalePush",
      {MEMBER(GatherScalePush, solid), MEMBER(GatherScalePush, face_offset), MEMBER(GatherScalePush, face_incidence),
       MEMBER(GatherScalePush, gathered), MEMBER(GatherScalePush, exitance), MEMBER(GatherScalePush, nodes),
       MEMBER(GatherScalePush, scale), MEMBER(GatherScalePush, count)});
  compare(gather_single_comp, "GatherSinglePush",
          {MEMBER(GatherSinglePush, exitance), MEMBER(GatherSinglePush, scale), MEMBER(GatherSinglePush, count)});
  compare(radiance_probe_comp, "RadianceProbePush",
          {MEMBER(RadianceProbePush, solid), MEMBER(RadianceProbePush, points), MEMBER(RadianceProbePush, scale),
           MEMBER(RadianceProbePush, face), MEMBER(RadianceProbePush, direction), MEMBER(RadianceProbePush, radiance),
           MEMBER(RadianceProbePush, transmittance), MEMBER(RadianceProbePush, count),
           MEMBER(RadianceProbePush, radiance_norm)});
}
