#include "engine/solve/operators.h"

namespace quadgraph {

void Operators::create(vk::Context& context, std::span<const Level> levels, const OperatorKey& key) {
  std::vector<OfLevel>& of_key = levels_[key];
  of_key.resize(levels.size());
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    if (of_key[i].op) continue;
    of_key[i].op.emplace(context, levels[i], i, key.method, key.model);
    if (i + 1 < levels.size()) of_key[i].transfer.emplace(context, levels[i], levels[i + 1], i, key.method);
  }
}

void Operators::unload() {
  for (auto& [key, of_key] : levels_) {
    for (OfLevel& level : of_key) {
      if (level.op) level.op->loaded.reset();
    }
  }
}

void Operators::disassemble() {
  for (auto& [key, of_key] : levels_) {
    for (OfLevel& level : of_key) {
      if (level.op) level.op->assembled.reset();
    }
  }
  unload();
}

void Operators::remeasure(std::uint32_t number) {
  for (auto& [key, of_key] : levels_) {
    if (!of_key[number].op) continue;
    of_key[number].op->measured = false;
    of_key[number].op->assembled.reset();
  }
}

void Operators::record_transfer(Workspace& work, const OperatorKey& key, std::uint32_t level) {
  const OperatorBuffers& coarse = at(key, level + 1);
  const OperatorBuffers& fine = at(key, level);
  for (const auto& part : levels_.at(key)[level].transfer->parts) {
    const gpu::TransferPush push{.index = part.index.address(),
                                 .weight = part.weight.address(),
                                 .coarse_x = coarse.x.address(),
                                 .coarse_to_phi = coarse.to_phi.address(),
                                 .to_phi = fine.to_phi.address(),
                                 .x = fine.x.address(),
                                 .state = fine.state.address(),
                                 .width = part.width,
                                 .first = part.first,
                                 .coarse_first = part.coarse_first,
                                 .count = part.count};
    work.recorder.dispatch(
        work.passes.transfer.of(key.model), push, part.count, "transfer",
        part.count * (part.width * (8 + sizeof(glm::vec3) + fine.field_bytes()) + 2 * sizeof(glm::vec3)));
  }
}

}  // namespace quadgraph
