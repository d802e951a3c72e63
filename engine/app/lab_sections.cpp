#include "engine/app/lab_sections.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/app/panel_widgets.h"

namespace quadgraph {
namespace {

void draw_plane(Show& show, const Sphere& bounds) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) ImGui::SameLine();
    ImGui::RadioButton(std::array{"x", "y", "z"}[static_cast<std::size_t>(axis)], &show.axis, axis);
  }
  slide("Plane offset", show.offset, -bounds.radius, bounds.radius, "%.1f mm");
}

void draw_path(PathOptions& path) {
  choose("Cost", path.cost);
  choose("Solver##path", path.solver);
  auto cells = static_cast<int>(path.cells);
  if (ImGui::SliderInt("Voxels", &cells, 16, static_cast<int>(path_cells_range.high)))
    path.cells = static_cast<std::uint32_t>(cells);
}

// A row of cells under `name`.
void tell_row(const char* name, const std::array<std::string, 3>& cells) {
  ImGui::TextDisabled("%s", name);
  const float width = ImGui::GetContentRegionMax().x;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ImGui::SameLine((0.26f + 0.22f * static_cast<float>(i)) * width);
    ImGui::TextUnformatted(cells[i].c_str());
  }
}

void tell_error(const char* name, const std::optional<ErrorEstimate>& error) {
  if (!error) return tell(name, "not known");
  const auto part = [](double share) { return share > 0 ? percent(share) : std::string("–"); };
  tell_row(name, {percent(error->whole), part(error->unlit), part(error->dimmest)});
}

void tell_errors(const SolveReport& report, const std::optional<ErrorEstimate>& picture) {
  if (report.path) return tell("Error", "not estimated");
  tell_row("Error", {"whole", "unlit", "dimmest third"});
  tell_error("  all", report.error);
  tell_error("  mesh", report.mesh_error);
  tell_error("  solver", report.algebraic);
  if (!report.correction) {
    tell("  model", "not known without correction");
    return tell("  light", "not known without correction");
  }
  tell_error("  model", report.model_error);
  tell_error("  light", report.light_error);
  if (report.phase_error) tell_error("  phase", report.phase_error);
  tell_error("Picture", picture);
}

}  // namespace

void draw_show(State& state, const Engine& engine) {
  if (!section("View")) return;
  Show& show = state.scene.render.show;
  choose("Show", show.quantity);
  if (has_plane(show.quantity)) draw_plane(show, engine.bounds());
  if (has_level(show.quantity)) {
    auto level = static_cast<int>(show.level);
    const auto last = static_cast<int>(engine.graph().levels().size()) - 1;
    if (ImGui::SliderInt("Level", &level, 0, last)) show.level = static_cast<std::uint32_t>(level);
  }
  if (show.quantity == Quantity::difference) {
    choose("Compare with", show.other, state.methods);
  }
}

void draw_solver(State& state) {
  if (!section("Solver")) return;
  SolveOptions& solve = state.scene.solve;
  if (choose("Method", solve.method, state.all_methods()) && !on_grid(solve.method)) solve.active_layers = 0;
  if (solve.method == Method::shortest_path) return draw_path(solve.path);
  choose("Solver##linear", solve.solver);
  choose("Source", solve.source);
  choose("Model", solve.model);
  auto error = static_cast<float>(100 * solve.error);
  if (slide("Error target", error, 0, 20, error > 0 ? "%.1f%%" : "none")) {
    solve.error = error < 0.1f ? 0 : static_cast<double>(error) / 100;
  }
  ImGui::Checkbox("Inter-reflection", &solve.inter_reflection);
  ImGui::Checkbox("Transport correction", &solve.correction);
}

void draw_passes(const std::vector<PassStats>& passes) {
  if (!section("Time by pass, ms")) return;
  if (!ImGui::BeginTable("passes", 3, ImGuiTableFlags_SizingStretchProp)) return;
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 3);
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 2.5f);
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 1);
  double most = 1e-6;
  for (const PassStats& pass : passes) most = std::max(most, pass.time_ms);
  std::vector<PassStats> sorted = passes;
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.time_ms > b.time_ms; });
  for (const PassStats& pass : sorted) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pass.name.c_str());
    ImGui::TableNextColumn();
    ImGui::ProgressBar(static_cast<float>(pass.time_ms / most), {-1, ImGui::GetTextLineHeight()}, "");
    ImGui::TableNextColumn();
    ImGui::Text("%.1f", pass.time_ms);
  }
  ImGui::EndTable();
}

void draw_frame(const Measured& measured) {
  if (!section("Frame")) return;
  if (measured.frame_ms == 0) return tell("State", "the first picture is being made");
  const SolveReport& report = measured.solve;
  const glm::dvec3 balance = report.energy.balance();
  const double worst = std::max({std::abs(balance.x), std::abs(balance.y), std::abs(balance.z)});
  tell("Time", formatted("%.0f ms, %.1f fps", measured.frame_ms, measured.frames_per_second));
  tell("State", measured.settled      ? "converged"
                : measured.frames > 0 ? formatted("%u of %u samples", 4 * measured.frames, 4 * measured.frames_wanted)
                                      : formatted("preview, %.0f%% resolution", 100.0 * double(measured.share)));
  tell_errors(report, measured.picture_error);
  tell("Energy", report.path ? "not conserved" : "balanced to " + percent(worst));
  tell("Memory", bytes_text(measured.device_bytes) + ", peak " + bytes_text(measured.peak_device_bytes));
  if (!report.levels.empty()) {
    const LevelReport& last = report.levels.back();
    tell("Solve", formatted("%u unknowns, %u cycles", last.unknowns, last.iterations));
    tell("Solver", std::string(name_of(report.model)) + ", " + std::string(name_of(report.solver)));
  }
  if (report.path) tell("Solve", formatted("%u voxels, %u rounds", report.path->solid, report.path->rounds));
  for (const std::string& text : {report.budget, report.replaced, report.missed, report.stopped, report.advice,
                                  report.mesh_warning, report.model_warning, report.size_warning, report.phase_warning,
                                  report.index_warning, report.light_warning, report.deformed}) {
    if (!text.empty()) ImGui::TextWrapped("%s", text.c_str());
  }
}

}  // namespace quadgraph
