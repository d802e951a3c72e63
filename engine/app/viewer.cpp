#include "engine/app/viewer.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "engine/app/overlays.h"
#include "engine/app/panel.h"
#include "engine/base/error.h"
#include "engine/deform/motion.h"
#include "engine/render/picture/frame_offsets.h"
#include "engine/scene/gestures.h"

namespace quadgraph {
namespace {

constexpr double budget_ms = 90;              // of a picture in motion: ten a second
constexpr double settle_after = 0.25;         // seconds without a change
constexpr double idle_wait = 0.5;             // seconds
constexpr double news_wait = 0.1;             // seconds, while a body is being baked
constexpr float degrees_per_height = 180.0f;  // of a drag over the height of the picture

struct Interrupted {};

double milliseconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

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
      history_(stage.scene()) {
  state_.scene = stage.scene();
  take_up_body();
  if (preview_) state_.preview = preview_->label();
  state_.brush = Brush::for_body(engine().bounds().radius);
}

// The last frame may still read the pixels.
Viewer::~Viewer() {
  vkDeviceWaitIdle(presenter_.device());
}

void Viewer::run() {
  // What is said of it is seen before its first picture is made; Dear ImGui shows what is new in its second frame.
  for (int frame = 0; preview_ && frame < 2; ++frame) {
    build_widgets({});
    present();
  }
  while (!window_.closing()) {
    window_.poll(patience());
    swapchain_.resize(window_.width(), window_.height());
    const std::vector<Event> events = window_.take_events();
    if (!events.empty()) frames_wanted_ = 3;
    handle(events);
    fulfil_wishes();
    follow_preview();
    keep_up();
    build_widgets(events);
    present();
  }
}

// Seconds that nothing need happen for.
double Viewer::patience() const {
  if (frames_wanted_ > 0 || window_.events_wait() || !shown_) return 0;
  if ((measured_.frames > 0 && !measured_.settled) || converges()) return 0;
  if (swapchain_.width() > 0 && part() != shown_part_) return 0;
  if (preview_ && !preview_->failed()) return news_wait;
  return measured_.settled ? idle_wait : 0.5 * settle_after;
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

void Viewer::handle(const std::vector<Event>& events) {
  for (const Event& event : events) {
    if (const auto* key = std::get_if<KeyEvent>(&event)) {
      handle_key(*key);
    } else if (const auto* motion = std::get_if<MotionEvent>(&event)) {
      handle_motion(*motion);
    } else if (const auto* button = std::get_if<ButtonEvent>(&event)) {
      begin_or_end_drag(*button);
    } else if (const auto* scroll = std::get_if<ScrollEvent>(&event); scroll != nullptr && !interface_.has_pointer()) {
      const CommandContext context = command_context();
      state_.scene.view = zoomed(state_.scene.view, context.bounds, context.aspect, static_cast<float>(scroll->y));
    }
  }
}

void Viewer::begin_or_end_drag(const ButtonEvent& event) {
  dragging_ = event.action == GLFW_PRESS && !interface_.has_pointer();
  drag_button_ = event.button;
  drag_mods_ = event.mods;
  if (dragging_) state_.focus_picture = true;
  const bool plain = event.button == GLFW_MOUSE_BUTTON_LEFT && event.mods == 0;
  const auto touch = dragging_ && plain && state_.brush.on ? pointed_at() : std::nullopt;
  painting_ = touch.has_value();
  if (touch) state_.brush.begin(state_.scene, *touch);
  Knife& knife = state_.knife;
  if (!dragging_ && knife.cuts()) {
    const CommandContext context = command_context();
    state_.cut = state_.scene.cuts.size();
    state_.scene.cuts.push_back(cut_along(state_.scene.view, context.bounds, context.aspect, *knife.from, *knife.to));
  }
  knife.from = dragging_ && plain && knife.on ? std::optional(pointer()) : std::nullopt;
  knife.to.reset();
}

void Viewer::handle_key(const KeyEvent& event) {
  if (event.action == GLFW_RELEASE || interface_.has_text()) return;
  if (interface_.has_keys()) {
    // The panel has the keys that move in it.
    constexpr int theirs[] = {GLFW_KEY_LEFT, GLFW_KEY_RIGHT, GLFW_KEY_UP,    GLFW_KEY_DOWN,
                              GLFW_KEY_TAB,  GLFW_KEY_SPACE, GLFW_KEY_ENTER, GLFW_KEY_HOME};
    if (event.key == GLFW_KEY_ESCAPE) state_.focus_picture = true;
    if (event.key == GLFW_KEY_ESCAPE || std::find(std::begin(theirs), std::end(theirs), event.key) != std::end(theirs))
      return;
  }
  if (event.key == GLFW_KEY_ESCAPE && state_.help) {
    state_.help = false;
    return;
  }
  run_command(event.key, event.mods, state_, command_context());
}

void Viewer::handle_motion(const MotionEvent& event) {
  const CommandContext context = command_context();
  const auto height = static_cast<float>(std::max(part().height, 1u));
  const float right = static_cast<float>(event.x - pointer_x_) / height;
  const float up = static_cast<float>(pointer_y_ - event.y) / height;
  pointer_x_ = event.x;
  pointer_y_ = event.y;
  if (!dragging_) return;
  if (painting_) {
    if (const auto touch = pointed_at()) state_.brush.lead(state_.scene, *touch);
    return;
  }
  if (state_.knife.from) {
    state_.knife.to = pointer();
    return;
  }
  View& view = state_.scene.view;
  if (drag_button_ != GLFW_MOUSE_BUTTON_LEFT) {
    view = panned(view, context.bounds, context.aspect, right, up);
  } else if ((drag_mods_ & (GLFW_MOD_CONTROL | GLFW_MOD_SHIFT)) == 0) {
    view = orbited(view, context.bounds, context.aspect, degrees_per_height * right, degrees_per_height * up);
  } else if (state_.light < state_.scene.lights.size()) {
    Light& light = state_.scene.lights[state_.light];
    light = turned(light, view, context.bounds, degrees_per_height * right, degrees_per_height * up);
  }
}

// In clip coordinates.
glm::vec2 Viewer::pointer() const {
  const Part now = part();
  const glm::vec2 share((pointer_x_ - now.left) / std::max(now.width, 1u), pointer_y_ / std::max(now.height, 1u));
  return {2 * share.x - 1, 1 - 2 * share.y};
}

// Where the pointer meets the body.
std::optional<Touch> Viewer::pointed_at() const {
  const CommandContext context = command_context();
  const auto found = engine().pick(state_.scene.view, context.aspect, pointer());
  if (!found) return std::nullopt;
  return touched(*found, place_camera(state_.scene.view, context.bounds, context.aspect));
}

void Viewer::build_widgets(const std::vector<Event>& events) {
  interface_.begin(events);
  if (state_.focus_picture) ImGui::SetWindowFocus(nullptr);
  state_.can_undo = history_.can_undo();
  state_.can_redo = history_.can_redo();
  if (state_.panel) draw_panel(state_, {engine(), measured_, interface_.unit()});
  if (state_.help) draw_help(state_, interface_.unit());
  const float left = static_cast<float>(part().left) / window_.pixels_per_unit();
  const auto& legend = engine().legend();
  const float taken = legend ? draw_colour_bar(*legend, left, interface_.unit()) : 0;
  draw_message(state_, left, interface_.unit(), taken);
  draw_preview(state_.preview, left, interface_.unit());
  draw_convergence(measured_.convergence, left, interface_.unit());
  draw_knife(state_.knife, left, interface_.unit());
  if (!dragging_ && !ImGui::IsAnyItemActive()) history_.note(state_.scene);
  ImGui::Render();
  state_.focus_panel = state_.focus_picture = false;
  frames_wanted_ = std::max(frames_wanted_ - 1, 0);
}

void Viewer::fulfil_wishes() {
  if (state_.quit) window_.close();
  if (state_.full_screen) window_.toggle_full_screen();
  if (state_.undo || state_.redo) history_.note(state_.scene);
  if (state_.undo) state_.scene = history_.undo(state_.scene);
  if (state_.redo) state_.scene = history_.redo(state_.scene);
  if (state_.screenshot && shown_) write_picture();
  if (state_.save) save_scene();
  state_.full_screen = state_.screenshot = state_.save = state_.undo = state_.redo = false;
}

// Brings the picture up to the scene: at once, as good as the budget allows, and exactly when nothing changes any more.
void Viewer::keep_up() {
  if (swapchain_.width() == 0) return;
  const bool changed = !shown_ || state_.scene != *shown_ || part() != shown_part_;
  if (changed) changed_ = Clock::now();
  window_.show_busy(changed || !measured_.settled);  // what is converged has been presented
  if (!changed && measured_.settled && !dragging_) return converge();
  if (!changed && (measured_.settled || milliseconds(Clock::now() - changed_) < 1000 * settle_after || dragging_))
    return;
  const bool first = !shown_;
  const Scene before = first ? state_.scene : *shown_;
  try {
    remake(!changed);
  } catch (const Interrupted&) {
    return;
  } catch (const DeviceError&) {
    throw;
  } catch (const std::exception& error) {
    if (first) throw;
    state_.say(error.what(), true);
    if (state_.scene == before) throw;
    history_.refuse(state_.scene);
    state_.scene = before;
    shown_.reset();
    remake(false);
  }
  frames_wanted_ = 3;
}

SolveOptions Viewer::options_of_solve(bool settle) const {
  if (settle) return state_.scene.solve;
  SolveOptions quick = in_motion(state_.scene.solve, engine().graph().levels());
  quick.correction = quick.correction && pace_.corrects();
  return quick;
}

void Viewer::remake(bool settle) {
  swapchain_.wait();  // the last frame may still read the pixels
  forget_convergence();
  const Clock::time_point start = Clock::now();
  const Scene& scene = state_.scene;
  Scene lit = scene;  // what is shown, seen as it is now
  if (shown_) lit = *shown_;
  lit.view = scene.view;
  lit.render = scene.render;
  lit.tone = scene.tone;
  const bool solving = !shown_ || lit != scene || !solved_ || (settle && !solved_exactly_);
  if (solving) {
    stage_.show(scene);
    solve(settle);
  }
  const Clock::time_point solved = Clock::now();
  if (solving && !settle) pace_.solved(milliseconds(solved - start), measured_.solve.correction.has_value());
  const Part now = part();
  const double pixels = double(now.width) * now.height;
  measured_.share = settle ? 1 : pace_.share(pixels, solving);
  if (!settle || now != shown_part_ || solving) measured_.frames = 0;
  make_picture(settle, settle || pace_.gathers(solving));
  shown_ = scene;
  shown_part_ = now;
  measured_.settled = settle && measured_.frames == measured_.frames_wanted;
  measure(start, milliseconds(Clock::now() - solved), settle || pace_.gathers(solving));
}

// A solve that settles ends, by throwing Interrupted, where the user does something.
void Viewer::solve(bool settle) {
  const auto check = [this] {
    window_.poll(0);
    if (window_.wanted() && !writing_) throw Interrupted();
  };
  solved_ = false;
  measured_.solve = stage_.solve(options_of_solve(settle), settle ? check : std::function<void()>());
  solved_ = true;
  solved_exactly_ = settle;
}

// Where it settles, one more frame of the picture, so that the user is heard between them.
void Viewer::make_picture(bool settle, bool gather) {
  const Part now = part();
  const auto side = [&](std::uint32_t pixels) {
    return std::max(1u, static_cast<std::uint32_t>(std::lround(measured_.share * static_cast<float>(pixels))));
  };
  RenderOptions options = state_.scene.render;
  options.width = settle ? now.width : side(now.width);
  options.height = settle ? now.height : side(now.height);
  if (!gather) options.radiance = Radiance::lambertian;
  if (!settle) options.samples = samples_per_frame;
  const View& view = state_.scene.view;
  const PictureBuffers& picture = engine().draw_frame(view, options, measured_.frames);
  measured_.frames_wanted = settle ? frame_count(view, options) : 0;
  if (settle) ++measured_.frames;
  const bool whole = settle && measured_.frames == measured_.frames_wanted;
  measured_.picture_error = whole ? engine().picture_error() : std::nullopt;
  measured_.exposure_stops = tone_mapper_.exposure(picture, state_.scene.tone);
  show(tone_mapper_.run(picture, state_.scene.tone, measured_.exposure_stops,
                        {now.width, now.height, swapchain_.blue_first()}));
}

// Brings pixels to the device that presents them, where another has made them.
void Viewer::show(const device::Buffer& pixels) {
  pixels_ = &pixels;
  if (&engine().device() == &presenter_) return;
  const auto bytes = pixels.mapped_as<std::byte>();
  if (presented_.size() < bytes.size()) {
    presented_ = device::Buffer(presenter_, bytes.size(), device::Place::host, "picture/presented");
  }
  std::copy(bytes.begin(), bytes.end(), presented_.mapped_as<std::byte>().begin());
  pixels_ = &presented_;
}

void Viewer::measure(Clock::time_point start, double draw_ms, bool gathered) {
  const Clock::time_point now = Clock::now();
  const double side = static_cast<double>(measured_.share);
  pace_.drawn(draw_ms, side * side * double(shown_part_.width) * shown_part_.height, gathered);
  measured_.frame_ms = milliseconds(now - start);
  pictures_.push_back(now);
  std::erase_if(pictures_, [&](const auto& time) { return milliseconds(now - time) > 1000; });
  measured_.frames_per_second = std::max(static_cast<double>(pictures_.size()), 1000 / measured_.frame_ms);
  measured_.passes = engine().passes();
  measured_.device_bytes = engine().device_bytes();
  measured_.peak_device_bytes = engine().peak_device_bytes();
}

void Viewer::present() {
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
