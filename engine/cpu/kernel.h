// How a shader that was compiled as C++ is run.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "engine/cpu/glsl.h"

namespace quadgraph::cpu::QG_LEVEL {

// Shaders name their push constants as they like.
template <typename Shader>
void take_push(Shader& shader, const void* push) {
  std::memcpy(static_cast<void*>(&shader.push_constants()), push, sizeof(shader.push_constants()));
}

// What every compute shader can name.
struct CompInvocation {
  uvec3 gl_GlobalInvocationID, gl_WorkGroupID, gl_NumWorkGroups, gl_LocalInvocationID, gl_WorkGroupSize;
};

// Workgroups `begin` to `end` of `groups`. Where invocations of a workgroup know of each other, one does the work of
// all; otherwise those of a workgroup follow each other.
template <typename Shader>
void run_groups(const void* push, uint groups, uint begin, uint end, bool grouped) {
  const uint size = grouped ? 1u : 256u;
  Shader shader;
  take_push(shader, push);
  shader.gl_NumWorkGroups = uvec3(groups, 1u, 1u);
  shader.gl_WorkGroupSize = uvec3(size, 1u, 1u);
  shader.gl_WorkGroupID = shader.gl_LocalInvocationID = shader.gl_GlobalInvocationID = uvec3(0u);
  for (uint group = begin; group < end; ++group) {
    shader.gl_WorkGroupID.ref_x() = group;
    for (uint local = 0; local < size; ++local) {
      shader.gl_LocalInvocationID.ref_x() = local;
      shader.gl_GlobalInvocationID.ref_x() = size * group + local;
      shader.main();
    }
  }
}

// An in or out variable of a stage: its location, where it lies in the shader, and its 32-bit words.
struct StageVariable {
  uint location;
  std::size_t offset;
  uint words;
};

// Calls copy(variable, bytes) for each of a constant table, so that the bytes are constants too: three words lie in a
// shader as four, and are copied as such, since what was written in parts could not be read at once.
template <auto table, typename Copy>
void for_each_variable(const Copy& copy) {
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    (copy(table[k], std::integral_constant<std::size_t, 4 * (table[k].words == 3 ? 4 : table[k].words)>()), ...);
  }(std::make_index_sequence<table.size()>());
}

struct VertInvocation {
  int gl_VertexIndex;
  vec4 gl_Position;
};

// Runs a vertex shader as device::VertexKernel asks.
template <typename Shader>
void run_vertices(const void* push, const uint* vertices, uint count, float* results) {
  constexpr auto written = Shader::outs();
  Shader shader;
  take_push(shader, push);
  for (uint k = 0; k < count; ++k) {
    shader.gl_VertexIndex = static_cast<int>(vertices[k]);
    shader.main();
    std::memcpy(results, &shader.gl_Position, sizeof(vec4));
    for_each_variable<written>([&](const StageVariable& one, auto bytes) {
      std::memcpy(results + 4 + 4 * one.location, reinterpret_cast<const char*>(&shader) + one.offset, bytes);
    });
    results += 4 + 4 * Shader::locations;
  }
}

// What every fragment shader can name. Derivatives are of its in variables alone.
struct FragInvocation {
  bool kept;
  bool gl_FrontFacing;
  std::ptrdiff_t to_right, to_below;  // bytes from this fragment's shader to those of the fragments beside and below

  template <typename T>
  T dFdx(const T& in) const {
    return moved(in, to_right) - in;
  }
  template <typename T>
  T dFdy(const T& in) const {
    return moved(in, to_below) - in;
  }
  template <typename T>
  T fwidth(const T& in) const {
    return abs(dFdx(in)) + abs(dFdy(in));
  }

 private:
  template <typename T>
  static const T& moved(const T& in, std::ptrdiff_t bytes) {
    return *reinterpret_cast<const T*>(reinterpret_cast<const char*>(&in) + bytes);
  }
};

template <typename Shader>
void read_inputs(Shader& shader, const float* inputs) {
  constexpr auto read = Shader::ins();
  for_each_variable<read>([&](const StageVariable& one, auto bytes) {
    std::memcpy(reinterpret_cast<char*>(&shader) + one.offset, inputs + 4 * one.location, bytes);
  });
}

// Runs a fragment shader as device::FragmentKernel asks.
template <typename Shader>
void run_fragments(const void* push, bool front, const float* inputs, const float* right, const float* below,
                   uint count, float* colours, bool* kept) {
  constexpr auto written = Shader::outs();
  Shader shaders[3];  // of the fragment, and of those that derivatives look at
  take_push(shaders[0], push);
  shaders[0].gl_FrontFacing = front;
  shaders[0].to_right = sizeof(Shader);
  shaders[0].to_below = 2 * sizeof(Shader);
  for (uint k = 0; k < count; ++k) {
    read_inputs(shaders[0], inputs);
    if (Shader::derivatives) {
      read_inputs(shaders[1], right);
      read_inputs(shaders[2], below);
      right += 4 * Shader::locations;
      below += 4 * Shader::locations;
    }
    shaders[0].kept = true;
    shaders[0].main();
    kept[k] = shaders[0].kept;
    for (const StageVariable& one : written) {
      std::memcpy(colours + 4 * one.location, reinterpret_cast<const char*>(&shaders[0]) + one.offset, 4 * one.words);
    }
    colours += 4 * written.size();
    inputs += 4 * Shader::locations;
  }
}

#define QG_JOINED(name, moments, kernel) name##_##moments##_##kernel
#define QG_NAMED(name, moments, kernel) QG_JOINED(name, moments, kernel)

#define QG_COMP_KERNEL(name, grouped)                                                                       \
  void QG_NAMED(name, MOMENTS, kernel)(const void* push, uint groups, uint begin, uint end, uint variant) { \
    variant == 0 ? run_groups<Shader<0>>(push, groups, begin, end, grouped)                                 \
                 : run_groups<Shader<1>>(push, groups, begin, end, grouped);                                \
  }

#define QG_VERT_KERNEL(name)                                                                               \
  void QG_NAMED(name, MOMENTS, kernel)(const void* push, const uint* vertices, uint count, float* results, \
                                       uint variant) {                                                     \
    variant == 0 ? run_vertices<Shader<0>>(push, vertices, count, results)                                 \
                 : run_vertices<Shader<1>>(push, vertices, count, results);                                \
  }

#define QG_FRAG_KERNEL(name)                                                                                       \
  void QG_NAMED(name, MOMENTS, kernel)(const void* push, bool front, const float* inputs, const float* right,      \
                                       const float* below, uint count, float* colours, bool* kept, uint variant) { \
    variant == 0 ? run_fragments<Shader<0>>(push, front, inputs, right, below, count, colours, kept)               \
                 : run_fragments<Shader<1>>(push, front, inputs, right, below, count, colours, kept);              \
  }

}  // namespace quadgraph::cpu::QG_LEVEL
