// The whole measurement of one level, material and model.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/layouts/bench.h"
#include "tools/layouts/krylov.h"
#include "tools/layouts/scene.h"

namespace quadgraph::layouts {

struct StudyOptions {
  std::string material = "marble";
  Model model = Model::diffusion;
  std::uint32_t repeats = 7;
  std::uint32_t copies = 1;  // bodies beside each other
};

struct Result {
  Variant variant;
  std::string refused;  // why it did not run; the rest is empty then
  Times times;
  double slots_per_entry = 0;  // stored entries over those there are
  double rounding = 0;         // result against the same step in double precision with what the layout keeps, relative
  double difference = 0;       // against that with the operator as assembled
  double conservation = 0;     // product: sum over all rows against the exact one, relative
  std::optional<ExitanceError> exitance;  // of the solution, where the layout changes the operator
  std::optional<double> least;            // with it: smallest eigenvalue of D^-1 A, if positive definite
};

struct Study {
  StudyOptions options;
  std::uint32_t rows = 0;
  std::uint64_t entries = 0;
  double least = 0;  // smallest eigenvalue of D^-1 A as assembled
  std::vector<Result> results;
};

Study study(vk::Context& context, const Level& level, const StudyOptions& options);

// The result of a variant's step in double precision; `diagonal` is that of the preconditioner.
std::vector<Field> exact_step(const Rows& rows, std::span<const Block> diagonal, Operation operation,
                              const Vectors& vectors);

// |a - b| / |b|, all channels and moments together.
double relative_difference(std::span<const Field> a, std::span<const Field> b);

}  // namespace quadgraph::layouts
