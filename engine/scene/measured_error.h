// What a bake for an error measured on its file (docs/accuracy.md), as the file's metadata keeps it in "budget", and
// what a solve of that file takes from it instead of estimating its error.
#pragma once

#include <functional>
#include <string>

#include "engine/render/engine.h"

namespace quadgraph {

// Share of an error that is asked for which a measured one may have and count as keeping it: the truth that it was
// measured by has an error, too. Used for a trial whose record has no share of its own (docs/qgraph-format.md).
inline constexpr double usual_measured_share = 0.95;

// Options of a solve, and what the bake has to say of the error that was asked for; no sentence where it says nothing.
struct MeasuredOptions {
  SolveOptions options;
  std::string sentence;
};

// The options with those that the bake measured to keep options.error, where it measured this scene on this file: a
// model, numbers of cycles and of sweeps and the tolerance of bounces, and no error that is left to estimate. Else the
// options as they are, and why. metadata: of the file, a JSON object. Throws FormatError "<scene.file>: metadata:
// <path>: found
// ..., allowed is ..." where an error is asked for and the record is none that a bake writes.
MeasuredOptions with_measured(const SolveOptions& options, const std::string& metadata, const PresentScene& scene);

// Engine::solve with these options; SolveReport::budget has the sentence. Throws as Engine::solve and with_measured.
SolveReport solve_measured(Engine& engine, const SolveOptions& options, const std::function<void()>& check = {});

}  // namespace quadgraph
