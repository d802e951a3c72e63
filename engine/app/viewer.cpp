#include "engine/app/viewer.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/app/modes.h"
#include "engine/app/overlays.h"
#include "engine/app/panel.h"
#include "engine/scene/gestures.h"
#include "engine/scene/layers.h"

namespace quadgraph {
namespace {

constexpr double budget_ms = 90;       // of a picture in motion: ten a second
constexpr double idle_wait = 0.5;      // seconds between frames where only a blinking cursor or the like changes
constexpr double news_wait = 0.1;      // seconds, while a body is being baked, or a film made
constexpr float turntable_speed = 24;  // degrees a second: once in a quarter of a minute
constexpr float longest_step = 0.25f;  // seconds that it goes on by at once, however long a picture takes

}  // namespace

Viewer::Viewer(Window& window, vk::Context& presenter, Stage& stage, Saving saving, std::optional<Preview> preview)
    : window_(window),
      presenter_(presenter),
      stage_(stage),
      swapchain_(presenter_, window.width(), window.height()),
      interface_(window, presenter_, swapchain_),
      tone_mapper_(stage.engine().device()),
      pace_(budget_ms),
      saving_(std::move(saving)),
      preview_(std::move(preview)),
      history_(stage.scene()),
      saved_(stage.scene()) {
  state_.scene = stage.scene();
  state_.layer = topmost(state_.scene);
  take_up_body();
  state_.has_frames = saving_.frames.has_value();
  if (preview_) state_.preview = preview_->label();
  state_.brush = Brush::for_body(engine().bounds().radius);
  listen();
}

// The last frame may still read the pixels.
Viewer::~Viewer() {
  engine().device().set_check({}, {});
  vkDeviceWaitIdle(presenter_.device());
}

void Viewer::run() {
  window_.appear();
  // What is said of it is seen before its first picture is made; Dear ImGui shows what is new in its second frame.
  for (int frame = 0; !shown_ && frame < 2; ++frame) {
    build_widgets({});
    present();
  }
  while (!leaving_) {
    window_.poll(patience());
    // Before the engine works: amid that those of later are taken.
    if (const std::vector<Event> events = take_events(); !events.empty()) build_widgets(events);
    try {
      if (std::exchange(state_.screenshot, false) && shown_) write_picture();
      if (opens()) open_file(std::exchange(state_.opening, {}));
      follow_preview();
      turn();
      keep_up();
    } catch (const Interrupted&) {  // of what nothing else is made in the place of: the window closes
    }
    if (!draws()) continue;
    build_widgets({});
    present();
  }
}

// The camera goes round while the turntable is on, as in a film.
void Viewer::turn() {
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<float> since = now - std::exchange(turned_, now);
  if (!state_.turntable || dragging_) return;
  const float degrees = turntable_speed * std::min(since.count(), longest_step);
  const CommandContext context = command_context();
  state_.scene.view = orbited(state_.scene.view, context.bounds, context.aspect, -degrees, 0);
}

// Seconds that nothing need happen for.
double Viewer::patience() const {
  if (frames_wanted_ > 0 || window_.events_wait()) return 0;
  if (swapchain_.width() == 0) return idle_wait;
  const bool goes_on = state_.turntable || (measured_.frames > 0 && !measured_.settled);
  if (!shown_ || part() != shown_part_ || (goes_on && !dragging_) || converges()) return 0;
  if (film_ || (preview_ && !preview_->failed())) return news_wait;
  return measured_.settled ? idle_wait : 0.5 * settle_after;
}

// Whether another frame could look other than the last one.
bool Viewer::draws() const {
  if (frames_wanted_ > 0) return true;
  const bool changes_by_itself = interface_.moves() || swapchain_.stale() || outlines_;
  return changes_by_itself && Clock::now() - answered_ >= std::chrono::duration<double>(idle_wait);
}

Viewer::Part Viewer::part() const {
  const auto wide = static_cast<std::uint32_t>(std::lround(panel_width * window_.scale()));
  const std::uint32_t left = state_.panel && swapchain_.width() > wide + 64 ? wide : 0;
  return {left, swapchain_.width() - left, swapchain_.height()};
}

CommandContext Viewer::command_context() const {
  const Part now = part();
  const auto height = static_cast<float>(std::max(now.height, 1u));
  decltype(CommandContext::known) known;
  for (std::size_t i = 0; i < known.size(); ++i) known[i] = engine().certainty().states(static_cast<Knowledge>(i));
  return {engine().bounds(), std::max(static_cast<float>(now.width), 1.0f) / height,
          static_cast<std::uint32_t>(engine().graph().levels().size()), known};
}

void Viewer::build_widgets(const std::vector<Event>& events) {
  interface_.begin(events);
  // Dear ImGui gives its first window the keys by itself.
  if (state_.focus_picture || !shown_) ImGui::SetWindowFocus(nullptr);
  state_.can_undo = history_.can_undo();
  state_.can_redo = history_.can_redo();
  if (state_.panel) draw_panel(state_, {engine(), measured_, interface_.unit()});
  if (state_.help) draw_help(state_, interface_.unit());
  const float left = static_cast<float>(part().left) / window_.pixels_per_unit();
  const auto& legend = engine().legend();
  const float taken = legend ? draw_colour_bar(*legend, left, interface_.unit()) : 0;
  draw_message(state_, left, interface_.unit(), taken);
  draw_preview(state_.preview, left, interface_.unit());
  if (!state_.compares()) draw_convergence(measured_.convergence, left, interface_.unit());
  for (const auto& ring : brush_rings()) draw_ring(ring, state_.brush.look.colour, left, interface_.unit());
  draw_outline(chosen_outline(), left, interface_.unit());
  draw_knife(state_.knife, left, interface_.unit());
  if (state_.compares()) draw_convergence("Before the last change", left, interface_.unit());
  if (state_.filming) draw_film(state_, interface_.unit());
  if (state_.asks) draw_question(state_, interface_.unit());
  keep_method(state_);
  if (!dragging_ && !ImGui::IsAnyItemActive()) history_.note(state_.scene);
  ImGui::Render();
  state_.focus_panel = state_.focus_picture = false;
  frames_wanted_ = std::max(frames_wanted_ - 1, 0);
}

void Viewer::present() {
  answered_ = Clock::now();
  const auto frame = swapchain_.begin();
  if (!frame) return;
  const VkClearColorValue black{{0.0f, 0.0f, 0.0f, 1.0f}};
  const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdClearColorImage(frame->commands, frame->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &black, 1, &whole);
  const bool fits =
      shown_part_.left + shown_part_.width <= swapchain_.width() && shown_part_.height <= swapchain_.height();
  if (pixels_ != nullptr && fits) {
    vk::transition(frame->commands, frame->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vk::copy_pixels(*frame, *pixels_, shown_part_.left, 0, shown_part_.width, shown_part_.height);
  }
  vk::transition(frame->commands, frame->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  interface_.draw(*frame);
  swapchain_.present(*frame);
}

}  // namespace quadgraph
