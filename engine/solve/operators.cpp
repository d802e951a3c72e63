#include "engine/solve/operators.h"

#include <algorithm>

#include "interface/solver/follow.comp.h"
#include "interface/solver/transfer.comp.h"

namespace quadgraph {
namespace {

// Mean conduction of elements (stored_entries.h) from which deformed bodies are stored in single precision: below it
// packed entries change the exitance by less than 1e-3.
constexpr double packed_conduction = 50;

}  // namespace

void Operators::create(device::Device& device, std::span<const Level> levels, const OperatorKey& key, bool even,
                       bool two_steps) {
  const std::size_t count = std::min<std::size_t>(levels.size(), MAX_LEVELS);
  if (!levels_.contains(key)) {
    std::vector<OfLevel> of_key(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const bool plain = plain_on_device_ || plain_.contains(key);
      const EntryFormat format = plain ? EntryFormat::plain : format_of(levels[i], key.method, [&] { device.heed(); });
      of_key[i].op.emplace(device, levels[i], elements(i), i, key.method, key.model, format);
      if (i + 1 < count) of_key[i].transfer.emplace(device, levels[i], levels[i + 1], i, key.method);
    }
    for (std::uint32_t i = 0; i < count; ++i) write_gates(device, of_key, i);
    levels_.emplace(key, std::move(of_key));
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    device.heed();  // making room is host work
    at(key, i).make_room(device, levels[i], even, two_steps || i + 1 == count);
  }
}

LevelElements& Operators::elements(std::uint32_t number) {
  for (auto next = static_cast<std::uint32_t>(elements_.size()); next <= number; ++next) {
    elements_.push_back(std::make_unique<LevelElements>(next));
  }
  return *elements_[number];
}

// What opens the gates of the level's state.
void Operators::write_gates(device::Device& device, const std::vector<OfLevel>& levels, std::uint32_t number) {
  const auto groups = [&](std::uint32_t count) { return device::workgroups(count); };
  gpu::SolveState state{};
  for (std::size_t i = number; i < levels.size(); ++i) state.groups[i] = groups(levels[i].op->count);
  state.surface_groups = groups(levels[number].op->surface_count);
  device::write_bytes(device, levels[number].op->state, std::as_bytes(std::span(&state, 1)));
}

void Operators::unload() {
  for (auto& [key, of_key] : levels_) {
    for (OfLevel& level : of_key) {
      level.op->loaded.reset();
      level.op->weighed = false;
    }
  }
}

void Operators::disassemble() {
  for (auto& [key, of_key] : levels_) {
    for (OfLevel& level : of_key) {
      level.op->assembled.reset();
    }
  }
  unload();
}

void Operators::remeasure(std::uint32_t number, const Level& level) {
  std::erase_if(levels_, [&](const auto& of_key) {
    const auto& [key, levels] = of_key;
    if (number >= levels.size() || levels[number].op->format == EntryFormat::plain) return false;
    if (format_of(level, key.method) == EntryFormat::packed) return false;
    plain_.insert(key);
    return true;
  });
  moved(number);
}

void Operators::remeasure(std::uint32_t number, double conduction) {
  const bool plain = conduction > packed_conduction;
  plain_on_device_ = plain_on_device_ || plain;
  std::erase_if(levels_, [&](const auto& of_key) {
    const auto& [key, levels] = of_key;
    if (!plain || number >= levels.size() || levels[number].op->format == EntryFormat::plain) return false;
    plain_.insert(key);
    return true;
  });
  moved(number);
}

void Operators::rounded(const OperatorKey& key, double rounding) {
  if (!(rounding > 1) || plain_.contains(key)) return;
  plain_.insert(key);
  levels_.erase(key);
}

void Operators::forget() {
  levels_.clear();
  for (std::uint32_t i = 0; i < elements_.size(); ++i) {
    const bool moved = elements_[i]->moved;
    elements_[i] = std::make_unique<LevelElements>(i);
    elements_[i]->moved = moved;
  }
}

void Operators::put_back() {
  for (const OperatorKey& key : plain_) levels_.erase(key);
  plain_.clear();
  plain_on_device_ = false;
  for (const auto& elements : elements_) elements->moved = false;
  measure_anew();
}

void Operators::measure_anew() {
  for (const auto& elements : elements_) elements->measured = false;
  for (auto& [key, of_key] : levels_) {
    for (OfLevel& level : of_key) {
      level.op->assembled.reset();
    }
  }
}

void Operators::moved(std::uint32_t number) {
  elements(number).moved = true;
  elements(number).measured = false;
  for (auto& [key, of_key] : levels_) {
    if (number < of_key.size()) of_key[number].op->assembled.reset();
  }
}

void Operators::record_transfer(Workspace& work, const OperatorKey& key, std::uint32_t level,
                                const device::Buffer& target, const device::Buffer& state) {
  const OperatorBuffers& coarse = at(key, level + 1);
  const OperatorBuffers& fine = at(key, level);
  for (const auto& part : levels_.at(key)[level].transfer->parts) {
    const gpu::TransferPush push{.index = part.index.address(),
                                 .weight = part.weight.address(),
                                 .coarse_x = coarse.x.address(),
                                 .coarse_to_phi = coarse.to_phi.address(),
                                 .to_phi = fine.to_phi.address(),
                                 .x = target.address(),
                                 .state = state.address(),
                                 .width = part.width,
                                 .first = part.first,
                                 .coarse_first = part.coarse_first,
                                 .count = part.count};
    work.recorder.dispatch(
        work.passes.of(shader::transfer, key.model), push, part.count, "transfer",
        part.count * (part.width * (8 + sizeof(glm::vec3) + fine.field_bytes()) + 2 * sizeof(glm::vec3)));
  }
}

void Operators::record_follow(Workspace& work, const OperatorKey& key, std::uint32_t level, bool changed) {
  const OperatorBuffers& fine = at(key, level);
  gpu::FollowPush push{};
  push.to_phi = fine.to_phi.address();
  push.x = fine.x.address();
  push.unit = fine.unit.address();
  push.scale = work.scale.address();
  push.count = fine.count;
  push.has_coarse = changed ? 1u : 0u;
  push.keep_before = level > 0 ? 1u : 0u;
  if (level > 0) push.before = fine.before.address();
  const auto dispatch = [&] {
    work.recorder.dispatch(work.passes.of(shader::follow, key.model), push, push.count, "transfer",
                           push.count * (push.width * (8 + sizeof(glm::vec3) + 2 * fine.field_bytes()) +
                                         sizeof(glm::vec3) + 3 * fine.field_bytes()));
  };
  if (!changed) return dispatch();
  const OperatorBuffers& coarse = at(key, level + 1);
  push.coarse_x = coarse.x.address();
  push.coarse_before = coarse.before.address();
  push.coarse_to_phi = coarse.to_phi.address();
  for (const auto& part : levels_.at(key)[level].transfer->parts) {
    push.index = part.index.address();
    push.weight = part.weight.address();
    push.width = part.width;
    push.first = part.first;
    push.coarse_first = part.coarse_first;
    push.count = part.count;
    dispatch();
  }
}

}  // namespace quadgraph
