// From the vertices of a draw to its triangles in the window, by tile.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/cpu/objects.h"
#include "engine/device/device.h"

namespace quadgraph::cpu {

class Processor;

constexpr std::uint32_t tile_side = 64;       // pixels
constexpr std::uint32_t position_floats = 4;  // before a vertex's own values
constexpr std::int32_t pixel = 256;           // in subpixels, to which positions are rounded

// A draw.
struct Frame {
  const device::DrawImages& target;
  const device::Viewport& viewport;
  const GraphicsPipeline& pass;
  const void* push;
  std::uint32_t stride;  // floats of a vertex with its position

  std::uint32_t locations() const { return pass.options.vertex->locations; }
  std::uint32_t columns() const { return (target.width + tile_side - 1) / tile_side; }  // of tiles
  std::uint32_t rows() const { return (target.height + tile_side - 1) / tile_side; }
};

// A vertex in the window, subpixels from the upper left with y down. Without a place where it is to be clipped.
struct Corner {
  std::int32_t x, y;
  float z, inverse_w;     // z is least for what is nearest
  std::uint32_t outside;  // bit per clip plane that it lies outside of, and one where it is not in front of the eye
};

// A triangle in the window, counter-clockwise.
struct Triangle {
  std::array<std::int32_t, 3> x, y;
  std::array<float, 3> z, inverse_w;
  std::array<const float*, 3> values;  // per location four floats
  const float* flat;                   // those of the first corner, also where it was clipped away
  bool front;
};

// Triangles of some that follow each other, in their order, and the corners that clipping has made.
struct Part {
  std::vector<Triangle> triangles;
  std::vector<std::unique_ptr<float[]>> corners;
  std::vector<std::uint32_t> first;    // per tile: into `of_tile`
  std::vector<std::uint32_t> of_tile;  // triangles of one tile after the other, in their order
};

// What draws need, kept from one to the next.
struct DrawMemory {
  std::vector<float> vertices;  // `stride` floats each
  std::vector<Corner> corners;
  std::vector<Part> parts;
  std::uint32_t part_count = 0;  // of this draw
};

// Fills the memory of the processor with the triangles of a draw.
void set_up(Processor& processor, const Frame& frame, const std::uint32_t* indices, std::uint32_t vertices);

}  // namespace quadgraph::cpu
