#include "engine/deform/cut.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

void expect(bool holds, const std::string& field, float found, const std::string& allowed) {
  if (!holds) throw InputError(field + ": found " + std::to_string(found) + ", allowed is " + allowed);
}

void expect_finite(const glm::vec3& vector, const std::string& field) {
  for (int k = 0; k < 3; ++k) expect(std::isfinite(vector[k]), field, vector[k], "a finite number");
}

}  // namespace

void check_cut(const BodyCut& cut) {
  const bool flat = cut.kind == CutKind::plane || cut.kind == CutKind::slab;
  if (flat) {
    expect_finite(cut.normal, "normal");
    expect(glm::length(cut.normal) > 1e-12f, "normal", glm::length(cut.normal), "a length above 0");
    expect(std::isfinite(cut.offset), "offset", cut.offset, "a finite number");
  } else {
    expect_finite(cut.centre, "centre");
  }
  if (cut.kind == CutKind::slab) expect(cut.thickness > 0, "thickness", cut.thickness, "above 0 mm");
  if (cut.kind == CutKind::sphere) expect(cut.radius > 0, "radius", cut.radius, "above 0 mm");
  for (int k = 0; k < 3 && cut.kind == CutKind::box; ++k) expect(cut.size[k] > 0, "size", cut.size[k], "above 0 mm");
}

std::vector<gpu::PathTool> path_tools(std::span<const BodyCut> cuts) {
  std::vector<gpu::PathTool> tools;
  for (const BodyCut& cut : cuts) {
    switch (cut.kind) {
      case CutKind::plane:
        tools.push_back({gpu::TOOL_PLANE, glm::normalize(cut.normal), glm::vec3(cut.offset, 0, 0)});
        break;
      case CutKind::slab:
        tools.push_back({gpu::TOOL_SLAB, glm::normalize(cut.normal), glm::vec3(cut.offset, 0.5f * cut.thickness, 0)});
        break;
      case CutKind::sphere:
        tools.push_back({gpu::TOOL_SPHERE, cut.centre, glm::vec3(cut.radius, 0, 0)});
        break;
      case CutKind::box:
        tools.push_back({gpu::TOOL_BOX, cut.centre, 0.5f * cut.size});
        break;
    }
  }
  return tools;
}

}  // namespace quadgraph
