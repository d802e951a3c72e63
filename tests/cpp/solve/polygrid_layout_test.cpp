// The push constants of the passes that assemble polygrids are those of C++, in every variant.
#include "shaders/assemble/assembly_shared.h"
#include "spirv/assemble_polygrid.comp.h"
#include "spirv/assemble_polygrid_sp3.comp.h"
#include "spirv/grid_material.comp.h"
#include "tests/cpp/fixtures/layout_compare.h"

using namespace quadgraph;
using namespace quadgraph::gpu;

TEST_CASE("push constants of polygrids equal C++") {
  compare(grid_material_comp, "GridMaterialPush",
          {MEMBER(GridMaterialPush, vertices), MEMBER(GridMaterialPush, tets), MEMBER(GridMaterialPush, optical),
           MEMBER(GridMaterialPush, tet_offset), MEMBER(GridMaterialPush, tet_incidence),
           MEMBER(GridMaterialPush, vertex_optical), MEMBER(GridMaterialPush, volume), MEMBER(GridMaterialPush, count),
           MEMBER(GridMaterialPush, even), MEMBER(GridMaterialPush, least)});
  for (const vk::Spirv code : {vk::Spirv(assemble_polygrid_comp), vk::Spirv(assemble_polygrid_sp3_comp)}) {
    compare(code, "AssemblePolygridPush",
            {MEMBER(AssemblePolygridPush, rows), MEMBER(AssemblePolygridPush, vertices),
             MEMBER(AssemblePolygridPush, faces), MEMBER(AssemblePolygridPush, face_offset),
             MEMBER(AssemblePolygridPush, face_incidence), MEMBER(AssemblePolygridPush, optical),
             MEMBER(AssemblePolygridPush, volume), MEMBER(AssemblePolygridPush, to_phi),
             MEMBER(AssemblePolygridPush, count), MEMBER(AssemblePolygridPush, surface_count),
             MEMBER(AssemblePolygridPush, published), MEMBER(AssemblePolygridPush, boundary)});
  }
}
