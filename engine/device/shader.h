// A compiled shader as the build hands it over ("interface/FOLDER/NAME.STAGE.h", tools/shader_headers).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace quadgraph::device {

// A SPIR-V module.
using Spirv = std::span<const std::uint32_t>;

// Levels of instructions that shaders are compiled for on the processor; the last is the highest.
constexpr std::size_t cpu_levels = 3;

// A compute shader on the processor: workgroups `begin` to `end` of `groups`. `variant`: ComputeOptions.
using ComputeKernel = void (*)(const void* push, std::uint32_t groups, std::uint32_t begin, std::uint32_t end,
                               std::uint32_t variant);

// A vertex shader: per vertex its position, then four floats for each location that it writes.
using VertexKernel = void (*)(const void* push, const std::uint32_t* vertices, std::uint32_t count, float* results,
                              std::uint32_t variant);

// A fragment shader of fragments of one triangle, which is turned to the eye (`front`) or away: `inputs` per fragment
// as the vertex shader's, without the position; `right` and `below` are those of the fragments beside and below. Writes
// four floats for each colour, and whether the fragment is kept.
using FragmentKernel = void (*)(const void* push, bool front, const float* inputs, const float* right,
                                const float* below, std::uint32_t count, float* colours, bool* kept,
                                std::uint32_t variant);

// A shader's code for the processor, for each level; null where it is of another stage.
struct CpuCode {
  std::array<ComputeKernel, cpu_levels> compute{};
  std::array<VertexKernel, cpu_levels> vertex{};
  std::array<FragmentKernel, cpu_levels> fragment{};
};

struct Shader {
  const char* name;
  Spirv code;                   // compiled for diffusion, where it makes a difference
  Spirv sp3;                    // compiled for SP3; empty: it makes no difference
  CpuCode cpu;                  // as `code`
  CpuCode cpu_sp3;              // as `sp3`
  std::uint32_t push_size;      // bytes of its push constants
  std::uint32_t locations = 0;  // that a vertex shader writes
  std::uint32_t flat = 0;       // bits of those that are not interpolated
  bool derivatives = false;     // a fragment shader that asks for them
  bool discards = false;        // a fragment shader that may leave out a fragment
};

// One that touches fields, and has code for SP3.
struct ModelShader : Shader {};

// One that touches entries or rows too: specialization constant 1 is their format (shaders/solver/stored_entries.glsl).
struct EntryShader : ModelShader {};

}  // namespace quadgraph::device
