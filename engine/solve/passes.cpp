#include "engine/solve/passes.h"

#include "shaders/solver/packing.h"

namespace quadgraph {

const device::ComputePass& LazyPass::get(device::Device& device) {
  if (!pass_) pass_.emplace(device, shader_, options_);
  return *pass_;
}

LazyPass& Passes::of(const device::EntryShader& shader, Model model, EntryFormat format) {
  return made(shader, {.sp3 = model == Model::sp3,
                       .variant = format == EntryFormat::plain ? std::uint32_t{ENTRIES_PLAIN} : ENTRIES_PACKED});
}

LazyPass& Passes::made(const device::Shader& shader, const device::ComputeOptions& options) {
  return passes_.try_emplace({&shader, options.sp3, options.variant}, shader, options).first->second;
}

}  // namespace quadgraph
