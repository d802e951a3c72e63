// Bodies within others that have an index of refraction of their own. Radiance over the square of the index, the basic
// radiance, passes the surface that they share as it is, and what is solved for is the fluence of that; volumes count
// by the square of the index, over that of the outermost body around them (docs/physics.md, "Bodies within others").
#pragma once

#include <span>
#include <vector>

#include "engine/base/solve_options.h"
#include "engine/file/graph.h"
#include "engine/solve/level_buffers.h"

namespace quadgraph {

class Etendue {
 public:
  // By body, one number for each of the file; all 1: nothing is bent within. Writes LevelBuffers::etendue of the levels
  // of the file. Returns whether it is another than before.
  bool set(device::Device& device, std::span<const Level> levels, std::span<const float> by_body,
           std::vector<LevelBuffers>& buffers);

  bool bends() const { return !by_body_.empty(); }
  // What fluence is over what a method solves for, which is the basic fluence where it conserves energy.
  float in_tet(const Level& level, std::uint32_t tet, Method method) const;
  // The same at the carriers of a method: at a vertex of a shared surface the mean over the tets around it.
  std::vector<float> at_carriers(const Level& level, Method method) const;

 private:
  float of_tet(const Level& level, std::uint32_t tet) const { return by_body_[level.body_of_tet(tet)]; }

  std::vector<float> by_body_;  // empty: all 1
};

// The triangles of surfaces that bodies share at each vertex of these, turned alike all over one such surface.
struct SharedSurface {
  std::vector<std::uint32_t> vertex;
  std::vector<std::uint32_t> offset;  // vertices + 1
  std::vector<glm::uvec2> rim;        // the other two corners
};

SharedSurface shared_surface(const Level& level);

}  // namespace quadgraph
