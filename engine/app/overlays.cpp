#include "engine/app/overlays.h"

#include <imgui.h>

#include <algorithm>

#include "engine/app/commands.h"
#include "engine/app/panel_widgets.h"
#include "engine/render/picture/tone_map.h"
#include "shaders/display/colour_map.h"

namespace quadgraph {
namespace {

// Words in the picture's upper or lower left corner; their upper or lower edge is at `height`.
void draw_note(const char* name, const std::string& text, const ImVec4& colour, bool below, float left, float height,
               float unit) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({left + 12 * unit, height}, ImGuiCond_Always, {0, below ? 1.0f : 0.0f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {size.x - left - 24 * unit, size.y});
  ImGui::SetNextWindowBgAlpha(0.85f);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushTextWrapPos(size.x - left - 48 * unit);
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  ImGui::End();
}

ImVec2 place_of(const glm::vec2& clip, float left) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  return {left + (size.x - left) * 0.5f * (1 + clip.x), size.y * 0.5f * (1 - clip.y)};
}

}  // namespace

void draw_help(State& state, float unit) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * size.x, 0.5f * size.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowBgAlpha(0.94f);
  ImGui::Begin("Keyboard shortcuts", &state.help,
               ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoMove);
  ImGui::TextUnformatted("Left drag rotates the object, right or middle drag pans, the wheel zooms.");
  ImGui::TextUnformatted(
      "Ctrl or Shift + drag rotates the selected light. With the brush (P) a left drag paints, with the knife (K) it "
      "cuts.");
  ImGui::TextUnformatted("Of several bodies a click chooses the one that the material goes to, beside them all.");
  ImGui::Separator();
  const auto commands = all_commands();
  const std::size_t rows = (commands.size() + 1) / 2;
  if (ImGui::BeginTable("table", 4, ImGuiTableFlags_SizingFixedFit)) {
    for (std::size_t row = 0; row < rows; ++row) {
      ImGui::TableNextRow();
      for (std::size_t i = row; i < commands.size(); i += rows) {
        ImGui::TableNextColumn();
        ImGui::TextColored({0.95f, 0.65f, 0.32f, 1}, "%.*s", static_cast<int>(commands[i].keys.size()),
                           commands[i].keys.data());
        ImGui::TableNextColumn();
        ImGui::Text("%.*s   ", static_cast<int>(commands[i].text.size()), commands[i].text.data());
      }
    }
    ImGui::EndTable();
  }
  ImGui::Dummy({560 * unit, 0});
  ImGui::End();
}

float draw_colour_bar(const Legend& legend, float left, float unit) {
  constexpr int strips = 96;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float width = std::min(360 * unit, size.x - left - 60 * unit);
  if (width < 100 * unit) return 0;
  ImGui::SetNextWindowPos({size.x - 12 * unit, size.y - 12 * unit}, ImGuiCond_Always, {1, 1});
  ImGui::SetNextWindowBgAlpha(0.75f);
  ImGui::Begin("colours", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::Text("%s, %s", legend.title.c_str(), legend.unit.c_str());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  for (int i = 0; i < strips; ++i) {
    const glm::vec3 linear = gpu::mapped_colour((static_cast<float>(i) + 0.5f) / strips, legend.diverging ? 1 : 0);
    const ImU32 colour = ImGui::GetColorU32({srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z), 1});
    draw->AddRectFilled({at.x + width * static_cast<float>(i) / strips, at.y},
                        {at.x + width * static_cast<float>(i + 1) / strips + 1, at.y + 14 * unit}, colour);
  }
  const ImU32 text = ImGui::GetColorU32(ImGuiCol_Text);
  for (const Tick& tick : ticks_of(legend)) {
    const float x = at.x + tick.place * width;
    draw->AddLine({x, at.y + 14 * unit}, {x, at.y + 18 * unit}, text);
    const float half = 0.5f * ImGui::CalcTextSize(tick.text.c_str()).x;
    draw->AddText({std::clamp(x - half, at.x, at.x + width - 2 * half), at.y + 19 * unit}, text, tick.text.c_str());
  }
  ImGui::Dummy({width, 22 * unit + ImGui::GetTextLineHeight()});
  const float height = ImGui::GetWindowHeight();
  ImGui::End();
  return height + 12 * unit;
}

void draw_preview(const std::string& text, float left, float unit) {
  if (text.empty()) return;
  draw_note("preview", text, {0.95f, 0.65f, 0.32f, 1}, false, left, 12 * unit, unit);
}

void draw_convergence(const std::string& text, float left, float unit) {
  if (text.empty()) return;
  draw_note("convergence", text, {0.9f, 0.9f, 0.89f, 1}, false, left, 12 * unit, unit);
}

void draw_message(const State& state, float left, float unit, float above) {
  if (state.message.empty()) return;
  const ImVec4 colour = state.refused ? ImVec4(1, 0.55f, 0.45f, 1) : ImVec4(0.9f, 0.9f, 0.89f, 1);
  draw_note("message", state.message, colour, true, left, ImGui::GetIO().DisplaySize.y - 12 * unit - above, unit);
}

void draw_film(State& state, float unit) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x - 12 * unit, 12 * unit}, ImGuiCond_Always, {1, 0});
  ImGui::SetNextWindowBgAlpha(0.85f);
  ImGui::Begin("film", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::TextUnformatted(state.film_text.c_str());
  ImGui::ProgressBar(state.film_share, {200 * unit, 6 * unit}, "");
  if (button("Cancel film##beside", true, false)) state.cancel_film = true;
  ImGui::End();
}

void draw_question(State& state, float unit) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * size.x, 0.4f * size.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowFocus();
  ImGui::Begin(state.unsaved ? "Save the scene first?" : "End the film?", nullptr,
               ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
  if (state.unsaved) {
    ImGui::TextUnformatted("What was changed since the scene was opened or saved is lost otherwise.");
  }
  if (state.filming && state.quit) {
    ImGui::TextUnformatted("The film that is being made ends with the window, and nothing of it stays.");
  }
  ImGui::Dummy({0, 4 * unit});
  if (state.unsaved) {
    if (ImGui::Button("Save scene (S)")) state.save_first = true;
    ImGui::SameLine();
  }
  if (ImGui::Button(state.unsaved ? "Discard (D)" : "End the film (D)")) state.discard = true;
  ImGui::SameLine();
  if (ImGui::Button("Cancel (Esc)")) state.keep();
  ImGui::End();
}

void draw_ring(const std::vector<glm::vec2>& ring, const glm::vec3& linear, float left, float unit) {
  std::vector<ImVec2> places;
  for (const glm::vec2& clip : ring) places.push_back(place_of(clip, left));
  const ImVec4 colour(srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z), 1);
  const auto draw = [&](ImU32 line, float width) {
    ImGui::GetBackgroundDrawList()->AddPolyline(places.data(), static_cast<int>(places.size()), line,
                                                ImDrawFlags_Closed, width * unit);
  };
  draw(IM_COL32(0, 0, 0, 160), 4);
  draw(ImGui::GetColorU32(colour), 2.5f);
  draw(IM_COL32(255, 255, 255, 220), 1);
}

void draw_outline(const std::vector<Segment>& outline, float left, float unit) {
  const auto draw = [&](ImU32 colour, float width) {
    for (const Segment& segment : outline) {
      ImGui::GetBackgroundDrawList()->AddLine(place_of(segment[0], left), place_of(segment[1], left), colour,
                                              width * unit);
    }
  };
  draw(IM_COL32(0, 0, 0, 120), 4);
  draw(IM_COL32(255, 170, 80, 255), 2);
}

void draw_knife(const Knife& knife, float left, float unit) {
  if (!knife.cuts()) return;
  ImGui::GetForegroundDrawList()->AddLine(place_of(*knife.from, left), place_of(*knife.to, left),
                                          IM_COL32(255, 170, 80, 255), 2 * unit);
}

}  // namespace quadgraph
