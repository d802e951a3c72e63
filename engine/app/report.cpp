#include "engine/app/report.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const glm::dvec3& rgb) {
  return {rgb.x, rgb.y, rgb.z};
}

Json as_json(const std::optional<ErrorEstimate>& error) {
  return error ? Json{{"whole", error->whole}, {"unlit", error->unlit}, {"dimmest", error->dimmest}} : Json(nullptr);
}

Json as_json(const CertifiedPart& part) {
  return {{"power", part.power},
          {"power_noise", part.power_noise},
          {"error", part.error},
          {"error_noise", part.error_noise}};
}

Json as_json(const Certificate& found) {
  return {{"whole", as_json(found.whole)}, {"unlit", as_json(found.unlit)}, {"dimmest", as_json(found.dimmest)},
          {"walks", found.walks},          {"segments", found.segments},    {"given_up", found.given_up},
          {"seconds", found.seconds},      {"guided", found.guided},        {"disagreement", found.disagreement}};
}

Json as_json(const CorrectionReport& correction) {
  Json json{{"segments", correction.segments}, {"sweeps", Json::array()}};
  for (const CorrectedSweep& sweep : correction.sweeps) {
    json["sweeps"].push_back(
        {{"change", as_json(sweep.change)}, {"noise", as_json(sweep.noise)}, {"points", sweep.points}});
  }
  return json;
}

Json as_json(const Convergence& found) {
  Json json{{"wanted", found.wanted}, {"reached", found.reached}, {"out_of_time", found.out_of_time},
            {"least", found.least},   {"limit", found.limit},     {"steps", Json::array()}};
  for (const ConvergenceStep& step : found.steps) {
    json["steps"].push_back({{"solves", step.solves},
                             {"sweeps", step.sweeps},
                             {"points", step.points},
                             {"samples", step.samples},
                             {"seconds", step.seconds},
                             {"error", as_json(step.error)},
                             {"noise", step.noise}});
  }
  return json;
}

Json as_json(const PathReport& path) {
  return {{"cost", name_of(path.options.cost)},
          {"solver", name_of(path.options.solver)},
          {"cells", path.options.cells},
          {"size", {path.size.x, path.size.y, path.size.z}},
          {"cell_mm", path.cell},
          {"solid", path.solid},
          {"lit", path.lit},
          {"rounds", path.rounds}};
}

Json as_json(const SolveReport& report) {
  Json json;
  json["method"] = name_of(report.method);
  json["solver"] = name_of(report.solver);
  json["source"] = name_of(report.source);
  json["model"] = name_of(report.model);
  json["cycles"] = report.cycles;
  json["levels"] = Json::array();
  for (const LevelReport& level : report.levels) {
    json["levels"].push_back({{"level", level.level},
                              {"unknowns", level.unknowns},
                              {"iterations", level.iterations},
                              {"residual", level.residual},
                              {"converged", level.converged}});
  }
  json["energy"] = {{"entered_W", as_json(report.energy.entered)},
                    {"re_entered_W", as_json(report.energy.re_entered)},
                    {"scattered_out_W", as_json(report.energy.scattered_out)},
                    {"absorbed_W", as_json(report.energy.absorbed)},
                    {"unscattered_out_W", as_json(report.energy.unscattered_out)},
                    {"balance", as_json(report.energy.balance())}};
  json["inter_reflection"] = report.inter_reflection;
  json["bounces_W"] = Json::array();
  for (const glm::dvec3& bounce : report.bounces) json["bounces_W"].push_back(as_json(bounce));
  json["clipped"] = as_json(report.clipped);
  if (report.path) json["path"] = as_json(*report.path);
  json["correction"] = report.correction ? as_json(*report.correction) : Json(nullptr);
  json["carried"] = report.carried ? Json(*report.carried) : Json(nullptr);
  json["certificate"] = report.certificate ? as_json(*report.certificate) : Json(nullptr);
  json["finest"] = report.finest;
  json["work"] = report.work;
  json["algebraic"] = as_json(report.algebraic);
  json["mesh_error"] = as_json(report.mesh_error);
  json["model_error"] = as_json(report.model_error);
  json["light_error"] = as_json(report.light_error);
  json["phase_error"] = as_json(report.phase_error);
  json["error"] = as_json(report.error);
  json["advice"] = report.advice;
  json["replaced"] = report.replaced;
  json["missed"] = report.missed;
  json["stopped"] = report.stopped;
  json["unmet"] = unmet(report);
  json["budget"] = report.budget;
  json["mesh_warning"] = report.mesh_warning;
  json["model_warning"] = report.model_warning;
  json["size_warning"] = report.size_warning;
  json["phase_warning"] = report.phase_warning;
  json["index_warning"] = report.index_warning;
  json["light_warning"] = report.light_warning;
  json["deformed"] = report.deformed;
  return json;
}

double total(const std::vector<std::pair<std::string, double>>& stages) {
  double sum = 0;
  for (const auto& stage : stages) sum += stage.second;
  return sum;
}

std::string decimals(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string value_of(const Metadata& metadata, std::string_view key) {
  const auto found =
      std::find_if(metadata.begin(), metadata.end(), [&](const auto& entry) { return entry.first == key; });
  return found == metadata.end() ? "" : found->second;
}

constexpr double mebibyte = 1024.0 * 1024.0;

}  // namespace

std::string step_text(const ConvergenceStep& step) {
  const std::string noise = step.noise > 0 ? ", of that noise " + decimals(100 * step.noise, 2) + "%" : "";
  return std::to_string(step.solves) + (step.solves == 1 ? " solve of " : " solves of ") + std::to_string(step.sweeps) +
         (step.sweeps == 1 ? " sweep, " : " sweeps, ") + std::to_string(step.samples) + " samples: error " +
         decimals(100 * step.error.whole, 2) + "%" + noise + ", " + decimals(step.seconds, 1) + " s";
}

std::string json_report(const RunReport& report) {
  Json json;
  json["output"] = report.output;
  for (const auto& [key, value] : report.metadata) json["metadata"][key] = value;
  json["solve"] = as_json(report.solve);
  json["picture_error"] = as_json(report.picture.error);
  json["convergence"] = report.picture.convergence ? as_json(*report.picture.convergence) : Json(nullptr);
  for (const PassStats& pass : report.engine.passes()) {
    json["passes"].push_back(
        {{"name", pass.name}, {"time_ms", pass.time_ms}, {"bytes", pass.bytes}, {"count", pass.count}});
  }
  for (const auto& [stage, time_ms] : report.wall_ms) json["wall_ms"][stage] = time_ms;
  json["wall_ms"]["total"] = total(report.wall_ms);
  json["device_bytes"] = {{"now", report.engine.device_bytes()}, {"peak", report.engine.peak_device_bytes()}};
  json["file_bytes"] = report.engine.graph().byte_size();
  return json.dump(2);
}

namespace {

void tell_paths(std::ostream& out, const RunReport& report) {
  const PathReport& path = *report.solve.path;
  out << "object   " << report.engine.graph().display().triangles.size() << " triangles\n"
      << "solve    " << name_of(report.solve.method) << ", cost " << name_of(path.options.cost) << ", "
      << name_of(path.options.solver) << ": " << value_of(report.metadata, "voxels") << ", " << path.lit << " lit, "
      << path.rounds << " rounds\n"
      << "error    not estimated, and energy is not conserved\n";
}

void tell_part(std::ostream& out, const char* name, const std::optional<ErrorEstimate>& part,
               const char* whole = "surface") {
  if (!part) return;
  out << name << decimals(100 * part->whole, 2) << "% over the " << whole << ", "
      << (part->unlit > 0 ? decimals(100 * part->unlit, 2) + "% over the unlit part" : "nothing unlit");
  if (part->dimmest > 0) out << ", " << decimals(100 * part->dimmest, 2) << "% over the dimmest third";
  out << "\n";
}

std::string certified_text(const CertifiedPart& part) {
  const std::string sign = part.power < 0 ? "-" : "+";
  return decimals(100 * part.error, 2) + " ± " + decimals(100 * part.error_noise, 2) + "% (power " + sign +
         decimals(100 * std::abs(part.power), 2) + " ± " + decimals(100 * part.power_noise, 2) + "%)";
}

void tell_certificate(std::ostream& out, const Certificate& found) {
  out << "measured " << certified_text(found.whole) << " over the surface, ";
  if (found.unlit.power_noise > 0) out << certified_text(found.unlit) << " over the unlit part, ";
  if (found.dimmest.power_noise > 0) out << certified_text(found.dimmest) << " over the dimmest third, ";
  out << "by " << decimals(found.walks / 1e6, 2)
      << (found.guided ? " million guided walks in " : " million random walks in ") << decimals(found.seconds, 1)
      << " s\n";
}

void tell_convergence(std::ostream& out, const Convergence& found) {
  out << "mean     " << step_text(found.steps.back()) << "\n";
  if (!found.reached) out << "warning  converge " << decimals(100 * found.wanted, 2) << "%: " << found.limit << "\n";
}

void tell_levels(std::ostream& out, const RunReport& report) {
  const Level& finest = report.engine.graph().levels().front();
  const LevelReport& solved = report.solve.levels.back();
  out << "object   " << report.engine.graph().levels().size() << " levels, finest " << finest.tet_count() << " tets, "
      << finest.face_count() << " faces, " << finest.vertex_count() << " vertices\n"
      << "solve    " << name_of(report.solve.method) << ", " << name_of(report.solve.model) << ", "
      << name_of(report.solve.source) << " source, with " << name_of(report.solve.solver) << ": " << solved.iterations
      << " iterations on the finest level, residual " << solved.residual << (solved.converged ? "" : " (not converged)")
      << "\n";
  out << "bounces  " << value_of(report.metadata, "inter-reflection") << "\n";
  if (report.solve.correction) {
    out << "sweeps  ";
    for (const CorrectedSweep& sweep : report.solve.correction->sweeps) {
      out << " " << decimals(100 * sweep.change.whole, 2) << "%";
    }
    out << " changed, " << decimals(report.solve.correction->segments / 1e6, 1) << " million ray segments\n";
  }
  if (!report.solve.error) return;
  tell_part(out, "error    ", report.solve.error);
  tell_part(out, "  mesh   ", report.solve.mesh_error);
  tell_part(out, "  solver ", report.solve.algebraic);
  tell_part(out, "  model  ", report.solve.model_error);
  tell_part(out, "  light  ", report.solve.light_error);
  tell_part(out, "  phase  ", report.solve.phase_error);
  if (report.solve.certificate) tell_certificate(out, *report.solve.certificate);
  tell_part(out, "shown    ", report.picture.error, "picture");
  if (report.picture.convergence) tell_convergence(out, *report.picture.convergence);
}

}  // namespace

std::string text_report(const RunReport& report) {
  std::ostringstream out;
  out << "device   " << report.engine.device().info().name << "\n";
  if (report.solve.path) {
    tell_paths(out, report);
  } else {
    tell_levels(out, report);
  }
  if (report.solve.certificate && !report.solve.certificate->disagreement.empty()) {
    out << "warning  " << report.solve.certificate->disagreement << "\n";
  }
  if (!report.solve.replaced.empty()) out << "solver   " << report.solve.replaced << "\n";
  if (!report.solve.budget.empty()) out << "budget   " << report.solve.budget << "\n";
  if (!report.solve.stopped.empty()) out << "failed   " << report.solve.stopped << "\n";
  for (const std::string& warning : {report.solve.missed, report.solve.advice, report.solve.mesh_warning,
                                     report.solve.model_warning, report.solve.size_warning, report.solve.phase_warning,
                                     report.solve.index_warning, report.solve.light_warning, report.solve.deformed}) {
    if (!warning.empty()) out << "warning  " << warning << "\n";
  }
  out << "memory   " << decimals(static_cast<double>(report.engine.peak_device_bytes()) / mebibyte, 0)
      << " MiB on the device at most\n"
      << "time     ";
  for (const auto& [stage, time_ms] : report.wall_ms) out << stage << " " << decimals(time_ms, 0) << " ms, ";
  out << "total " << decimals(total(report.wall_ms), 0) << " ms\n"
      << "picture  " << report.output;
  return out.str();
}

void refuse_messages(const device::Device& context) {
  const auto& messages = context.validation_messages();
  if (!messages.empty()) {
    throw DeviceError(std::to_string(messages.size()) + " validation messages, the first: " + messages.front());
  }
}

}  // namespace quadgraph
