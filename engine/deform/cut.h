// What a user cuts away from a body that is shown by shortest paths.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/base/names.h"
#include "shaders/path/path_tools.h"

namespace quadgraph {

enum class CutKind { plane, slab, sphere, box };

template <>
struct Names<CutKind> {
  static constexpr std::string_view what = "cut";
  static constexpr auto values =
      std::to_array<Named<CutKind>>({{CutKind::plane, "plane", "what lies in front of a plane"},
                                     {CutKind::slab, "slab", "what lies within half its thickness of a plane"},
                                     {CutKind::sphere, "sphere", "what lies in a sphere"},
                                     {CutKind::box, "box", "what lies in a box along the axes"}});
};

// In the shape as it is shown. Members that a kind does not name are not used.
struct BodyCut {
  CutKind kind = CutKind::plane;
  glm::vec3 normal{0, 1, 0};  // plane, slab: of any length but 0
  // plane: what lies in front of it goes, dot(normal, p) > offset with the normal at unit length, mm. slab: what lies
  // within half its thickness of that plane, so that pieces are left on both sides.
  float offset = 0;
  float thickness = 1;  // slab: mm, > 0
  glm::vec3 centre{0};  // sphere, box: mm
  float radius = 1;     // sphere: mm, > 0
  glm::vec3 size{1};    // box: its sides along the axes, mm, > 0

  bool operator==(const BodyCut&) const = default;
};

// Throws InputError naming the field, what was found and what is allowed.
void check_cut(const BodyCut& cut);

// Cuts as shaders take them; checked before.
std::vector<gpu::PathTool> path_tools(std::span<const BodyCut> cuts);

}  // namespace quadgraph
