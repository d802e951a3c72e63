#include "engine/app/panel_widgets.h"

#include <imgui.h>

#include <cctype>
#include <cstdint>

#include "engine/render/picture/tone_map.h"
#include "shaders/display/tone_curve.h"

namespace quadgraph {

bool section(const char* name, bool open) {
  return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
}

bool choose(const char* label, std::size_t& chosen, const std::vector<std::string_view>& names) {
  bool changed = false;
  const std::string shown(chosen < names.size() ? names[chosen] : "");
  if (!ImGui::BeginCombo(label, shown.c_str(), ImGuiComboFlags_HeightLarge)) return false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (ImGui::Selectable(std::string(names[i]).c_str(), i == chosen) && i != chosen) {
      chosen = i;
      changed = true;
    }
    if (i == chosen) ImGui::SetItemDefaultFocus();
  }
  ImGui::EndCombo();
  return changed;
}

bool slide(const char* label, float& value, float low, float high, const char* format, bool logarithmic) {
  const ImGuiSliderFlags flags = logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
  return ImGui::SliderFloat(label, &value, low, high, format, flags);
}

bool slide(const char* label, float& value, const Range& range, const char* format) {
  return slide(label, value, static_cast<float>(range.low), static_cast<float>(range.high), format);
}

bool colour_button(const char* label, glm::vec3& linear) {
  glm::vec3 shown(srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z));
  if (!ImGui::ColorEdit3(label, &shown.x, ImGuiColorEditFlags_NoInputs)) return false;
  linear = {gpu::srgb_decode(shown.x), gpu::srgb_decode(shown.y), gpu::srgb_decode(shown.z)};
  return true;
}

bool button(const char* label, bool enabled, bool beside) {
  if (beside) ImGui::SameLine();
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::Button(label);
  ImGui::EndDisabled();
  return pressed;
}

void tell(const char* name, const std::string& value) {
  ImGui::TextDisabled("%s", name);
  ImGui::SameLine(0.26f * ImGui::GetContentRegionMax().x);
  ImGui::TextUnformatted(value.c_str());
}

std::string capitalised(std::string_view name) {
  std::string label(name);
  label.front() = static_cast<char>(std::toupper(label.front()));
  return label;
}

std::string percent(double share) {
  const double value = 100 * share;
  if (value > 0 && value < 0.005) return "<0.01%";
  return formatted(value < 0.995 ? "%.2f%%" : value < 9.95 ? "%.1f%%" : "%.0f%%", value);
}

std::string bytes_text(std::uint64_t bytes) {
  const double megabytes = static_cast<double>(bytes) / 1e6;
  return megabytes < 999.5 ? formatted("%.0f MB", megabytes) : formatted("%.2f GB", megabytes / 1000);
}

}  // namespace quadgraph
