#include "engine/solve/multigrid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "interface/solver/chebyshev.comp.h"
#include "interface/solver/coarse_solve.comp.h"
#include "interface/solver/prolong.comp.h"
#include "interface/solver/residual.comp.h"
#include "interface/solver/restrict.comp.h"

namespace quadgraph {
namespace {

// What the smoother is to damp begins at this share of the largest eigenvalue. One step is a damped relaxation, and the
// largest eigenvalue is below 1: it does best when it steps nearly as far as it may. In SP3 the rows of phi2 consist
// mostly of its relaxation, with eigenvalues near 1 for all that it can be, which a long step only turns around.
double smoothing_ratio(std::uint32_t smoothing, Model model) {
  if (smoothing == 2) return 0.1;
  return model == Model::sp3 ? 0.2 : 0.05;
}

// Carriers of the largest level that one workgroup solves on.
constexpr std::uint32_t largest_coarse = 8192;

// Eigenvalues that its iteration is for begin at the square of this over the vertices across the body. Measured on a
// bunny of 30 mm, from spectralon to a body of 10% of marble's scattering: no worse than twice the steps for all.
constexpr double coarse_width = 1.5, largest_coarse_ratio = 0.3;
constexpr std::uint32_t least_coarse_steps = 6;

// Chebyshev's iteration for eigenvalues in [ratio, 1]: d <- keep d + add M^-1 r.
struct ChebyshevStep {
  double keep = 0, add = 0;
};

ChebyshevStep chebyshev_step(std::uint32_t number, double ratio) {
  const double middle = (1 + ratio) / 2, radius = (1 - ratio) / 2;
  ChebyshevStep step{0, 1 / middle};
  double rho = radius / middle;
  for (std::uint32_t k = 0; k < number; ++k) {
    const double next = 1 / (2 * middle / radius - rho);
    step = {next * rho, 2 * next / radius};
    rho = next;
  }
  return step;
}

}  // namespace

Multigrid::Multigrid(Workspace& work, Operators& operators, const OperatorKey& key, std::uint32_t smoothing)
    : work_(work), operators_(operators), key_(key), smoothing_(smoothing) {}

bool Multigrid::possible(Operators& operators, const OperatorKey& key) {
  const std::uint32_t levels = operators.count(key);
  return key.method == Method::fem && levels > 1 && operators.at(key, levels - 1).count <= largest_coarse;
}

const device::Buffer& Multigrid::correction(std::uint32_t level) const {
  if (smoothing_ % 2 == 0) return op(level).z;
  return level == coarsest() ? op(level).other : op(level).product;
}

double Multigrid::coarse_across() const {
  return std::cbrt(static_cast<double>(op(coarsest()).count));
}

// Half as many as there are vertices across the body, whose square the condition of its operator grows with: they leave
// less of an error than the cycle does. An even number.
std::uint32_t Multigrid::coarse_steps() const {
  return std::max(2 * static_cast<std::uint32_t>(std::ceil(coarse_across() / 4)), least_coarse_steps);
}

template <typename Push>
void Multigrid::dispatch(LazyPass& pass, const Push& push, std::uint32_t level, const char* name) {
  work_.recorder.dispatch_indirect(pass, push, op(top_).state,
                                   offsetof(gpu::SolveState, gate) + level * sizeof(glm::uvec3), name);
}

void Multigrid::record_step(std::uint32_t level, const device::Buffer& from, const device::Buffer& to,
                            std::uint32_t number, bool zero, bool reduce) {
  const OperatorBuffers& rows = op(level);
  const ChebyshevStep step = chebyshev_step(number, smoothing_ratio(smoothing_, rows.model));
  const gpu::ChebyshevPush push{.rows = rows.rows(),
                                .f = rows.r.address(),
                                .from = from.address(),
                                .to = to.address(),
                                .d = rows.product.address(),
                                .majorant = rows.majorant.address(),
                                .state = op(top_).state.address(),
                                .reduction = work_.reduction.address(),
                                .count = rows.count,
                                .first = number == 0 ? 1u : 0u,
                                .zero = zero ? 1u : 0u,
                                .last = number + 1 == smoothing_ ? 1u : 0u,
                                .reduce = reduce ? 1u : 0u,
                                .keep = static_cast<float>(step.keep),
                                .add = static_cast<float>(step.add)};
  dispatch(work_.passes.of(shader::chebyshev, rows.model, rows.format), push, level, "smoothing");
}

// From zero: the first step is d itself, which the second takes as x; so z comes out, after one step or two. Later, one
// step needs no d, whose place its result takes.
void Multigrid::record_smoothing(std::uint32_t level, bool from_zero) {
  OperatorBuffers& rows = op(level);
  for (std::uint32_t k = 0; k < smoothing_; ++k) {
    const bool reduce = !from_zero && level == top_ && k + 1 == smoothing_;
    if (from_zero) {
      record_step(level, rows.product, rows.z, k, k == 0, reduce);
    } else {
      const device::Buffer& between = smoothing_ == 1 ? rows.product : rows.other;
      record_step(level, k == 0 ? rows.z : between, k == 0 ? between : rows.z, k, false, reduce);
    }
  }
}

// The step is a relaxation, whose result takes the place of `product`.
void Multigrid::record_relaxation(std::uint32_t level) {
  OperatorBuffers& rows = op(level);
  gpu::ChebyshevPush push{};
  push.rows = rows.rows();
  push.f = rows.b.address();
  push.from = rows.x.address();
  push.to = rows.product.address();
  push.majorant = rows.majorant.address();
  push.count = rows.count;
  push.first = push.last = 1;
  push.add = static_cast<float>(chebyshev_step(0, smoothing_ratio(1, rows.model)).add);
  work_.recorder.dispatch(work_.passes.of(shader::chebyshev, rows.model, rows.format), push, rows.count, "smoothing",
                          smoothing_bytes(rows));
  std::swap(rows.x, rows.product);
}

void Multigrid::record_restriction(std::uint32_t level) {
  const OperatorBuffers& fine = op(level);
  const OperatorBuffers& coarse = op(level + 1);
  const gpu::ResidualPush residual{fine.rows(), fine.r.address(), fine.z.address(), fine.product.address(), fine.count};
  dispatch(work_.passes.of(shader::residual, fine.model, fine.format), residual, level, "coarse residual");
  const TransferBuffers& transfer = operators_.transfer(key_, level);
  const gpu::RestrictPush push{.offset = transfer.back_offset.address(),
                               .entry = transfer.back_entry.address(),
                               .r = fine.product.address(),
                               .f = coarse.r.address(),
                               .count = coarse.count};
  dispatch(work_.passes.of(shader::restrict, key_.model), push, level + 1, "restriction");
}

void Multigrid::record_prolongation(std::uint32_t level) {
  const OperatorBuffers& fine = op(level);
  const auto& part = operators_.transfer(key_, level).parts.front();
  const gpu::ProlongPush push{part.index.address(), part.weight.address(), correction(level + 1).address(),
                              fine.z.address(), fine.count};
  dispatch(work_.passes.of(shader::prolong, key_.model), push, level, "prolongation");
}

void Multigrid::record_coarse_solve() {
  const OperatorBuffers& rows = op(coarsest());
  const device::Buffer& result = correction(coarsest());
  const double ratio = std::min(std::pow(coarse_width / coarse_across(), 2), largest_coarse_ratio);
  const gpu::CoarseSolvePush push{.rows = rows.rows(),
                                  .f = rows.r.address(),
                                  .z = result.address(),
                                  .other = (&result == &rows.z ? rows.other : rows.z).address(),
                                  .d = rows.product.address(),
                                  .majorant = rows.majorant.address(),
                                  .state = op(top_).state.address(),
                                  .count = rows.count,
                                  .steps = coarse_steps(),
                                  .reduce = coarsest() == top_ ? 1u : 0u,
                                  .ratio = static_cast<float>(ratio)};
  work_.recorder.dispatch_indirect(work_.passes.of(shader::coarse_solve, rows.model, rows.format), push, op(top_).state,
                                   offsetof(gpu::SolveState, coarse), "coarse solve");
}

void Multigrid::record(std::uint32_t top) {
  top_ = top;
  for (std::uint32_t level = top; level < coarsest(); ++level) {
    record_smoothing(level, true);
    record_restriction(level);
  }
  record_coarse_solve();
  for (std::uint32_t level = coarsest(); level-- > top;) {
    record_prolongation(level);
    record_smoothing(level, false);
  }
}

std::uint64_t Multigrid::smoothing_bytes(const OperatorBuffers& op) const {
  return op.product_bytes() + (4 * op.field_bytes() + op.majorant_bytes()) * op.count;
}

void Multigrid::did(std::uint32_t top, std::uint32_t cycles) const {
  Recorder& recorder = work_.recorder;
  for (std::uint32_t level = top; level < coarsest(); ++level) {
    const OperatorBuffers& rows = op(level);
    const std::uint64_t field = rows.field_bytes() * rows.count, transfer = 8 * std::uint64_t{rows.count} * 4;
    recorder.did("smoothing", cycles, rows.majorant_bytes() * rows.count + 2 * field);
    recorder.did("smoothing", cycles * (2 * smoothing_ - 1), smoothing_bytes(rows));
    recorder.did("coarse residual", cycles, rows.product_bytes() + 3 * field);
    recorder.did("restriction", cycles, transfer + field + op(level + 1).field_bytes() * op(level + 1).count);
    recorder.did("prolongation", cycles, transfer + 2 * field + 4 * field);
  }
  recorder.did("coarse solve", cycles, coarse_steps() * smoothing_bytes(op(coarsest())));
}

double Multigrid::entries(std::uint32_t top) const {
  double sum = static_cast<double>(op(coarsest()).entries) * (coarse_steps() - 1);
  for (std::uint32_t level = top; level < coarsest(); ++level) sum += 2.0 * smoothing_ * op(level).entries;
  return sum;
}

}  // namespace quadgraph
