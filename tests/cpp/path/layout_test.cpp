// The structs that the passes of the shortest-path method share with C++ lie in memory as the compiled shaders read
// them.
#include "shaders/path/path_shared.h"
#include "spirv/path_box.comp.h"
#include "spirv/path_cost.comp.h"
#include "spirv/path_crossings.comp.h"
#include "spirv/path_field.comp.h"
#include "spirv/path_flood.comp.h"
#include "spirv/path_relax.comp.h"
#include "spirv/path_solid.comp.h"
#include "spirv/path_start.comp.h"
#include "spirv/path_winding.comp.h"
#include "tests/cpp/fixtures/layout_compare.h"

using namespace quadgraph;

TEST_CASE("the grid and the push constants of paths") {
  for (const vk::Spirv code : {vk::Spirv(path_crossings_comp), vk::Spirv(path_relax_comp)}) {
    compare(code, "PathGrid", {MEMBER(PathGrid, origin), MEMBER(PathGrid, cell), MEMBER(PathGrid, size)});
  }
  compare(path_box_comp, "PathBoxPush",
          {MEMBER(PathBoxPush, vertices), MEMBER(PathBoxPush, box), MEMBER(PathBoxPush, count)});
  compare(path_crossings_comp, "PathCrossingsPush",
          {MEMBER(PathCrossingsPush, grid), MEMBER(PathCrossingsPush, vertices), MEMBER(PathCrossingsPush, triangles),
           MEMBER(PathCrossingsPush, crossings), MEMBER(PathCrossingsPush, flags), MEMBER(PathCrossingsPush, triangle),
           MEMBER(PathCrossingsPush, tools), MEMBER(PathCrossingsPush, triangle_count),
           MEMBER(PathCrossingsPush, stripes)});
  compare(path_winding_comp, "PathWindingPush",
          {MEMBER(PathWindingPush, grid), MEMBER(PathWindingPush, crossings), MEMBER(PathWindingPush, axis)});
  compare(path_solid_comp, "PathSolidPush",
          {MEMBER(PathSolidPush, grid), MEMBER(PathSolidPush, votes), MEMBER(PathSolidPush, flags),
           MEMBER(PathSolidPush, wanted), MEMBER(PathSolidPush, counts), MEMBER(PathSolidPush, tools)});
  compare(path_start_comp, "PathStartPush",
          {MEMBER(PathStartPush, grid), MEMBER(PathStartPush, flags), MEMBER(PathStartPush, entering),
           MEMBER(PathStartPush, paths), MEMBER(PathStartPush, wanted), MEMBER(PathStartPush, list),
           MEMBER(PathStartPush, groups), MEMBER(PathStartPush, counts)});
  compare(path_relax_comp, "PathRelaxPush",
          {MEMBER(PathRelaxPush, grid), MEMBER(PathRelaxPush, cost), MEMBER(PathRelaxPush, paths),
           MEMBER(PathRelaxPush, wanted), MEMBER(PathRelaxPush, list), MEMBER(PathRelaxPush, next),
           MEMBER(PathRelaxPush, groups), MEMBER(PathRelaxPush, arrivals), MEMBER(PathRelaxPush, fronts),
           MEMBER(PathRelaxPush, round)});
  compare(path_flood_comp, "PathFloodPush",
          {MEMBER(PathFloodPush, grid), MEMBER(PathFloodPush, triangle), MEMBER(PathFloodPush, from),
           MEMBER(PathFloodPush, to), MEMBER(PathFloodPush, step)});
  compare(path_cost_comp, "PathCostPush",
          {MEMBER(PathCostPush, grid), MEMBER(PathCostPush, flags), MEMBER(PathCostPush, nearest),
           MEMBER(PathCostPush, triangle), MEMBER(PathCostPush, triangles), MEMBER(PathCostPush, vertices),
           MEMBER(PathCostPush, rest), MEMBER(PathCostPush, body), MEMBER(PathCostPush, cost)});
  compare(path_cost_comp, "PathMaterial",
          {MEMBER(PathMaterial, material), MEMBER(PathMaterial, optical), MEMBER(PathMaterial, optical_size),
           MEMBER(PathMaterial, optical_spacing), MEMBER(PathMaterial, optical_first), MEMBER(PathMaterial, edits),
           MEMBER(PathMaterial, points), MEMBER(PathMaterial, texels), MEMBER(PathMaterial, edit_count),
           MEMBER(PathMaterial, cost)});
  compare(path_field_comp, "PathFieldPush",
          {MEMBER(PathFieldPush, grid), MEMBER(PathFieldPush, flags), MEMBER(PathFieldPush, paths),
           MEMBER(PathFieldPush, field)});
  compare(path_solid_comp, "PathTool", {MEMBER(PathTool, kind), MEMBER(PathTool, a), MEMBER(PathTool, b)});
  compare(path_solid_comp, "PathTools", {MEMBER(PathTools, at), MEMBER(PathTools, count)});
  CHECK(SpirvLayout(path_solid_comp).stride.at("PathTool") == sizeof(gpu::PathTool));
}
