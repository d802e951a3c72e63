// What a run did, for people and for programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/render/engine.h"

namespace quadgraph {

struct RunReport {
  const Engine& engine;
  const SolveReport& solve;
  const Metadata& metadata;
  const Picture& picture;
  std::string output;
  std::vector<std::pair<std::string, double>> wall_ms;  // stages in order
};

// One step of a picture that converges, in one line.
std::string step_text(const ConvergenceStep& step);

std::string json_report(const RunReport& report);
std::string text_report(const RunReport& report);

// Throws DeviceError where the validation layer had something to say.
void refuse_messages(const device::Device& context);

}  // namespace quadgraph
