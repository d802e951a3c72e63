#include "engine/solve/inter_reflection.h"

#include <algorithm>
#include <bit>

#include "engine/reference/exchange.h"
#include "engine/reference/sky.h"
#include "engine/solve/moved_bytes.h"
#include "interface/exchange/exchange.comp.h"
#include "interface/exchange/exchange_enter.comp.h"
#include "interface/exchange/exchange_finer.comp.h"
#include "shaders/exchange/exchange_shared.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t measured_face_bytes = sizeof(glm::uvec3) + 3 * vec3_bytes;  // its area

}  // namespace

InterReflection::InterReflection(const QuadGraph& graph) : graph_(graph) {
  for (std::uint32_t i = 0; i < graph.levels().size(); ++i) {
    if (graph.levels()[i].seen.empty()) continue;
    level_ = i;
    matrix_.emplace(graph.levels()[i]);
  }
}

std::optional<SeenRows> InterReflection::seen(device::Device& device) {
  if (!level()) return std::nullopt;
  matrix_->make_room(device);
  return SeenRows{*level_, matrix_->rows(), matrix_->entries(), matrix_->rays()};
}

void InterReflection::moved(std::uint32_t number) {
  if (number == level_) matrix_->moved();
}

void InterReflection::turned() {
  if (matrix_) matrix_->turned();
}

void InterReflection::put_back(device::Device& device, std::vector<LevelBuffers>& levels) {
  if (!matrix_) return;
  matrix_->put_back(device);
  remeasure();
  const auto sky = sky_of_levels(graph_.levels());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    device::write_bytes(device, levels[i].sky, std::as_bytes(std::span(sky[i])));
  }
}

bool InterReflection::refresh(Workspace& work, std::span<const Level> shape, std::vector<LevelBuffers>& levels,
                              std::uint32_t rows) {
  if (!matrix_ || matrix_->record_refresh(work, levels[*level_], rows) == 0) return false;
  if (!sky_) sky_.emplace(work.recorder.device(), shape, *level_);
  sky_->record(work, *matrix_, levels);
  work.recorder.submit();
  return true;
}

void InterReflection::make_room(Workspace& work, const std::vector<LevelBuffers>& levels) {
  if (!irradiance_.empty()) return;
  device::Device& device = work.recorder.device();
  const auto room = [&](std::uint64_t bytes, const char* name) {
    return device::Buffer(device, bytes, device::Place::device, name);
  };
  const Level& level = graph_.levels()[*level_];
  matrix_->make_room(device);
  phi_ = room(level.face_count() * vec3_bytes, "exchange/phi at faces");
  exitance_ = room(level.face_count() * vec3_bytes, "exchange/exitance");
  before_ = room(level.face_count() * vec3_bytes, "exchange/irradiance before the bounce");
  clip_ = room(sizeof(gpu::Clip), "exchange/clip");
  factor_ = room(vec3_bytes, "exchange/factor");
  state_ = room(sizeof(gpu::ExchangeState), "exchange/state");
  states_on_host_ = {device, (max_bounces + 1) * sizeof(gpu::ExchangeState), device::Place::host,
                     "exchange/states, read back"};
  work.recorder.fill(state_, 0);
  finer_.clear();
  for (std::uint32_t i = 0; i < *level_; ++i) {
    const Transfer& surface = graph_.levels()[i].surface;
    finer_.push_back({device::upload(device, surface.index, "exchange/surface_index"),
                      device::upload(device, surface.weight, "exchange/surface_weight"), surface.width});
  }
  std::vector<device::Buffer> irradiance;
  for (std::uint32_t i = 0; i <= *level_; ++i) {
    irradiance.push_back(room(levels[i].face_count * vec3_bytes, "exchange/irradiance from other parts"));
    work.recorder.fill(irradiance.back(), 0);
  }
  irradiance_ = std::move(irradiance);
}

void InterReflection::record_enter(Workspace& work, const LevelBuffers& level, const device::Buffer& irradiance) {
  const gpu::ExchangeEnterPush push{.vertices = level.vertices.address(),
                                    .faces = level.faces.address(),
                                    .face_kinds = level.face_kind.address(),
                                    .q = level.q.address(),
                                    .irradiance = irradiance.address(),
                                    .beam_q = level.beam_q.address() + level.beam_again(),
                                    .factor = factor_.address(),
                                    .state = state_.address(),
                                    .reduction = work.reduction.address(),
                                    .count = level.face_count};
  work.recorder.dispatch(work.passes.of(shader::exchange_enter), push, level.face_count, "exchange",
                         level.face_count * (measured_face_bytes + 5 * vec3_bytes));
}

void InterReflection::start_over() {
  any_ = !irradiance_.empty();
  count_ = 0;
}

void InterReflection::record_none(Workspace& work, const std::vector<LevelBuffers>& levels) {
  if (!any_) return;
  any_ = false;
  work.recorder.fill(factor_, std::bit_cast<std::uint32_t>(1.0f));  // of what may never have been written
  for (std::uint32_t i = 0; i <= *level_; ++i) {
    work.recorder.fill(irradiance_[i], 0);
    record_enter(work, levels[i], irradiance_[i]);
  }
  work.recorder.fill(state_, 0);
}

void InterReflection::record_bounce(Workspace& work, const Solved& solved) {
  const LevelBuffers& level = solved.level;
  std::swap(before_, irradiance_.back());
  record_exitance(work, solved, phi_, exitance_, clip_);
  const gpu::ExchangePush push{.vertices = level.vertices.address(),
                               .faces = level.faces.address(),
                               .face_kinds = level.face_kind.address(),
                               .rows = matrix_->rows().address(),
                               .entries = matrix_->entries().address(),
                               .exitance = exitance_.address(),
                               .clip = clip_.address(),
                               .before = before_.address(),
                               .irradiance = irradiance_.back().address(),
                               .factor = factor_.address(),
                               .state = state_.address(),
                               .reduction = work.reduction.address(),
                               .count = level.face_count,
                               .rays = static_cast<float>(matrix_->rays())};
  const std::uint64_t entries = graph_.levels()[*level_].seen.size() - level.face_count - 1;
  work.recorder.dispatch(work.passes.of(shader::exchange), push, level.face_count, "exchange",
                         level.face_count * (measured_face_bytes + sizeof(glm::uvec2) + 3 * vec3_bytes) +
                             entries * (sizeof(std::uint32_t) + 2 * vec3_bytes));
  record_enter(work, level, irradiance_.back());
  count_ = std::min(count_ + 1, max_bounces);
  work.recorder.copy(state_, states_on_host_, sizeof(gpu::ExchangeState), count_ * sizeof(gpu::ExchangeState));
  any_ = true;
}

void InterReflection::record_beam(Workspace& work, const std::vector<LevelBuffers>& levels, std::uint32_t number) {
  make_room(work, levels);
  const LevelBuffers& level = levels[number];
  if (number == *level_) {
    work.recorder.fill(factor_, std::bit_cast<std::uint32_t>(1.0f));
    return record_enter(work, level, irradiance_[number]);
  }
  const Finer& finer = finer_[number];
  const gpu::ExchangeFinerPush push{.vertices = level.vertices.address(),
                                    .faces = level.faces.address(),
                                    .face_kinds = level.face_kind.address(),
                                    .index = finer.index.address(),
                                    .weight = finer.weight.address(),
                                    .coarse = irradiance_[number + 1].address(),
                                    .irradiance = irradiance_[number].address(),
                                    .factor = factor_.address(),
                                    .state = state_.address(),
                                    .reduction = work.reduction.address(),
                                    .count = level.face_count,
                                    .width = finer.width};
  work.recorder.dispatch(work.passes.of(shader::exchange_finer), push, level.face_count, "exchange",
                         level.face_count * (measured_face_bytes + finer.width * (8 + vec3_bytes) + vec3_bytes));
  record_enter(work, level, irradiance_[number]);
}

void InterReflection::begin() {
  begun_with_ = power();
  if (any_ && count_ > 0) {
    const auto states = states_on_host_.mapped_as<gpu::ExchangeState>();
    states[0] = states[count_];
  }
  count_ = 0;
}

glm::dvec3 InterReflection::power() const {
  if (!any_) return glm::dvec3(0);
  return glm::dvec3(states_on_host_.mapped_as<gpu::ExchangeState>()[count_].power);
}

bool InterReflection::converged(double tolerance) const {
  if (!any_) return false;
  const gpu::ExchangeState& state = states_on_host_.mapped_as<gpu::ExchangeState>()[count_];
  return glm::all(glm::lessThanEqual(glm::dvec3(state.change), tolerance * glm::dvec3(state.entered)));
}

std::vector<glm::dvec3> InterReflection::bounces() const {
  std::vector<glm::dvec3> gains;
  glm::dvec3 before = begun_with_;
  for (std::uint32_t i = 1; i <= count_; ++i) {
    const glm::dvec3 power(states_on_host_.mapped_as<gpu::ExchangeState>()[i].power);
    gains.push_back(power - before);
    before = power;
  }
  return gains;
}

}  // namespace quadgraph
