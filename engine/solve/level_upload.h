// A level of the file on the device.
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "engine/base/solve_options.h"
#include "engine/file/graph.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/refractions.h"

namespace quadgraph {

// Geometry of level `number` without what is made at first use; q is zero. `refractions`, of its bodies, must outlive
// it.
LevelBuffers upload_level(device::Device& device, const Level& level, std::uint32_t number,
                          const Refractions& refractions);

// All levels of a file, with the shares of the sky that their faces see.
std::vector<LevelBuffers> upload_levels(device::Device& device, const std::vector<Level>& levels,
                                        const Refractions& refractions);

// Leans facets of the faces, by the numbers of shaders/source/leaning.glsl; none: the faces are as they are.
void lean_faces(device::Device& device, const Level& level, std::uint32_t number, const Refractions& refractions,
                std::span<const glm::vec2> leaning, LevelBuffers& buffers);

// Links and nodes, unless they are there.
void upload_graph(device::Device& device, const Level& level, std::uint32_t number, LevelBuffers& buffers);

// The transfers of one level that a method needs: phi at `count` unknowns from `first` on, from those of the coarser
// level from `coarse_first` on.
struct TransferBuffers {
  struct Part {
    device::Buffer index, weight;
    std::uint32_t width = 0, first = 0, coarse_first = 0, count = 0;
  };
  std::vector<Part> parts;
  device::Buffer back_offset, back_entry;  // the transpose (RestrictPush); fem only

  TransferBuffers(device::Device& device, const Level& level, const Level& coarse, std::uint32_t number, Method method);
};

}  // namespace quadgraph
