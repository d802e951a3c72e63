// The compute pipelines of the solve, created at first use: compiling takes a GPU's driver long, and no solve needs
// all.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <tuple>

#include "engine/base/solve_options.h"
#include "engine/device/pipeline.h"
#include "engine/reference/stored_entries.h"

namespace quadgraph {

// A pipeline that does not exist until it is wanted.
class LazyPass {
 public:
  LazyPass(const device::Shader& shader, const device::ComputeOptions& options) : shader_(shader), options_(options) {}

  const device::ComputePass& get(device::Device& device);

 private:
  const device::Shader& shader_;
  device::ComputeOptions options_;
  std::optional<device::ComputePass> pass_;
};

// All passes by their shaders, whose types say how many pipelines a shader has: one for all, one per model, or one per
// model and format of entries.
class Passes {
 public:
  LazyPass& of(const device::Shader& shader) { return made(shader, {}); }
  LazyPass& of(const device::ModelShader& shader, Model model) { return made(shader, {.sp3 = model == Model::sp3}); }
  LazyPass& of(const device::EntryShader& shader, Model model, EntryFormat format);

  LazyPass& of(const device::ModelShader& shader) = delete;
  LazyPass& of(const device::EntryShader& shader, Model model) = delete;

 private:
  LazyPass& made(const device::Shader& shader, const device::ComputeOptions& options);

  std::map<std::tuple<const device::Shader*, bool, std::uint32_t>, LazyPass> passes_;
};

}  // namespace quadgraph
