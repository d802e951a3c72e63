// Triangles of a draw in the window: vertex shading, clipping, and what is turned away left out.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/cpu/objects.h"
#include "engine/cpu/thread_pool.h"
#include "engine/device/device.h"

namespace quadgraph::cpu {

constexpr std::uint32_t position_floats = 4;  // before a vertex's own values
constexpr double subpixels = 256;             // positions are rounded to this part of a pixel
constexpr std::int64_t pixel = 256;           // in subpixels

// A triangle in the window, counter-clockwise: subpixels from the upper left with y down.
struct Triangle {
  std::array<std::int32_t, 3> x, y;
  std::array<float, 3> z, inverse_w;
  std::array<const float*, 3> values;  // per location four floats
  const float* flat;                   // those of the first corner, also where it was clipped away
  bool front;
};

struct Frame {
  const device::DrawImages& target;
  const device::Viewport& viewport;
  const GraphicsPipeline& pass;
  const void* push;
  std::uint32_t stride;  // floats of a vertex with its position

  std::uint32_t floats() const { return stride - position_floats; }
};

// Triangles of some that follow each other, in their order, and the corners that clipping has made.
struct Part {
  std::vector<Triangle> triangles;
  std::vector<std::unique_ptr<std::vector<float>>> corners;
};

// Values of all vertices, the position first.
std::vector<float> run_vertices(ThreadPool& threads, const Frame& frame, const std::uint32_t* indices,
                                std::uint32_t vertices);

// `results`: of run_vertices; must outlive what is returned.
std::vector<Part> set_up(ThreadPool& threads, const Frame& frame, const std::vector<float>& results,
                         const std::uint32_t* indices, std::uint32_t triangles);

}  // namespace quadgraph::cpu
