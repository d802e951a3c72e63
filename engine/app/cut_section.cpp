#include "engine/app/cut_section.h"

#include <imgui.h>

#include <algorithm>

#include "engine/app/modes.h"
#include "engine/app/panel_widgets.h"
#include "engine/scene/gestures.h"

namespace quadgraph {
namespace {

// A sphere out of the side that is seen; what other kinds would need is of the same size.
BodyCut fresh_cut(const View& view, const Sphere& bounds) {
  const glm::vec3 here = towards({view.azimuth, view.elevation}, view.up);
  BodyCut cut{.kind = CutKind::sphere, .normal = here};
  cut.centre = bounds.centre + 0.7f * bounds.radius * here;
  cut.offset = glm::dot(here, bounds.centre) + 0.3f * bounds.radius;
  cut.thickness = 0.1f * bounds.radius;
  cut.radius = 0.4f * bounds.radius;
  cut.size = glm::vec3(0.8f * bounds.radius);
  return cut;
}

void draw_plane(BodyCut& cut, const Sphere& bounds, UpAxis up) {
  Bearing bearing = bearing_of(cut.normal, up);
  const bool around = slide("Azimuth##cut", bearing.azimuth, -180, 180, "%.0f°");
  const bool above = slide("Elevation##cut", bearing.elevation, -90, 90, "%.0f°");
  float distance = cut.offset - glm::dot(glm::normalize(cut.normal), bounds.centre);
  const bool moved = slide("Offset##cut", distance, -bounds.radius, bounds.radius, "%.1f mm");
  if (!around && !above && !moved) return;
  cut.normal = towards(bearing, up);
  cut.offset = glm::dot(cut.normal, bounds.centre) + distance;
}

void draw_cut(BodyCut& cut, const Sphere& bounds, UpAxis up) {
  choose("Type##cut", cut.kind);
  const float least = 1e-3f * bounds.radius, most = 2 * bounds.radius;
  if (cut.kind == CutKind::plane || cut.kind == CutKind::slab) {
    draw_plane(cut, bounds, up);
    if (cut.kind == CutKind::slab) slide("Thickness##cut", cut.thickness, least, bounds.radius, "%.1f mm");
    return;
  }
  ImGui::DragFloat3("Centre, mm##cut", &cut.centre.x, 0.01f * bounds.radius, 0, 0, "%.1f");
  if (cut.kind == CutKind::sphere) {
    slide("Radius##cut", cut.radius, least, most, "%.1f mm");
  } else {
    ImGui::DragFloat3("Size, mm##cut", &cut.size.x, 0.01f * bounds.radius, least, most, "%.1f",
                      ImGuiSliderFlags_AlwaysClamp);
  }
}

}  // namespace

void draw_cuts(State& state, const Sphere& bounds) {
  if (!section("Cuts")) return;
  auto& cuts = state.scene.cuts;
  if (bool on = state.knife.on; ImGui::Checkbox("Cut with left drag", &on)) take_knife(state, on);
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const std::string name = formatted("%zu  %s##cuts", i + 1, std::string(name_of(cuts[i].kind)).c_str());
    if (ImGui::RadioButton(name.c_str(), state.cut == i)) state.cut = i;
    ImGui::PopID();
  }
  if (state.cut < cuts.size()) draw_cut(cuts[state.cut], bounds, state.scene.view.up);
  if (ImGui::Button("Add##cut")) {
    state.cut = cuts.size();
    cuts.push_back(fresh_cut(state.scene.view, bounds));
  }
  ImGui::SameLine();
  if (ImGui::Button("Remove##cut") && state.cut < cuts.size()) {
    cuts.erase(cuts.begin() + static_cast<std::ptrdiff_t>(state.cut));
    state.cut = cuts.empty() ? 0 : std::min(state.cut, cuts.size() - 1);
  }
}

}  // namespace quadgraph
