// How the viewer's picture keeps up with the scene.
#include <algorithm>
#include <cmath>

#include "engine/app/viewer.h"
#include "engine/base/error.h"
#include "engine/deform/motion.h"
#include "engine/render/picture/frame_offsets.h"

namespace quadgraph {
namespace {

double milliseconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

// Brings the picture up to the scene: at once, as good as the budget allows, and exactly when nothing changes any more.
void Viewer::keep_up() {
  if (swapchain_.width() == 0) return;
  const bool changed = !shown_ || wanted_scene() != *shown_ || part() != shown_part_;
  if (changed) changed_ = Clock::now();
  window_.show_busy(changed || !measured_.settled);  // what is converged has been presented
  if (!changed && measured_.settled && !dragging_) return converge();
  if (!changed && (measured_.settled || milliseconds(Clock::now() - changed_) < 1000 * settle_after || dragging_))
    return;
  const std::optional<Scene> before = shown_;
  const Scene made = wanted_scene();
  try {
    remake(!changed);
  } catch (const Interrupted&) {
  } catch (const DeviceError&) {
    throw;
  } catch (const std::exception& error) {
    refuse(made, before, error.what());
  }
  making_.reset();
  frames_wanted_ = 3;
}

// What is to be seen: the scene, or what it was before the last change.
Scene Viewer::wanted_scene() const {
  return state_.compares() ? history_.before(state_.scene) : state_.scene;
}

// Goes back to the scene before, if there was one, unless the user has changed what could not be shown meanwhile.
void Viewer::refuse(const Scene& made, const std::optional<Scene>& before, const std::string& why) {
  if (!before || made == *before) throw;
  state_.say(why, true);
  history_.refuse(made);
  state_.knife.on = false;  // it would take the method again that could not be shown
  if (state_.scene == made) state_.scene = *before;
  shown_.reset();
  solved_ = false;
}

SolveOptions Viewer::options_of_solve() const {
  if (making_->settles) return making_->scene.solve;
  SolveOptions quick = in_motion(making_->scene.solve, engine().graph().levels());
  quick.carry = quick.correction && !pace_.corrects();
  quick.correction = quick.correction && pace_.corrects();
  return quick;
}

// Whether the solution is not that of the scene that is being made, which may be seen otherwise than what is shown.
bool Viewer::must_solve() const {
  if (!shown_ || !solved_ || (making_->settles && !solved_exactly_)) return true;
  if (shown_->render.light_roughness() != making_->scene.render.light_roughness()) return true;
  Scene lit = *shown_;
  lit.view = making_->scene.view;
  lit.render = making_->scene.render;
  lit.tone = making_->scene.tone;
  if (lit.layers != making_->scene.layers && applied_edits(lit.layers) == applied_edits(making_->scene.layers)) {
    lit.layers = making_->scene.layers;  // of another name, or hidden
  }
  return lit != making_->scene;
}

// The user may change the scene meanwhile: what is made is that of the beginning.
void Viewer::remake(bool settle) {
  forget_convergence();
  const Clock::time_point start = Clock::now();
  const Part now = part();
  making_ = Making{.scene = wanted_scene(), .part = now, .settles = settle};
  const bool solving = must_solve();
  if (solving) {
    stage_.show(making_->scene);
    picker_.follow(stage_);
    solve();
  }
  const Clock::time_point solved = Clock::now();
  if (solving && !settle) pace_.solved(milliseconds(solved - start), measured_.solve.correction.has_value());
  const double pixels = double(now.width) * now.height;
  measured_.share = settle ? 1 : pace_.share(pixels, solving);
  if (!settle || now != shown_part_ || solving) measured_.frames = 0;
  make_picture(settle || pace_.gathers(solving));
  shown_ = making_->scene;
  shown_part_ = now;
  measured_.settled = settle && measured_.frames == measured_.frames_wanted;
  measure(start, milliseconds(Clock::now() - solved), settle || pace_.gathers(solving));
}

// A solve that settles ends, by throwing Interrupted, where something else is wanted.
void Viewer::solve() {
  solved_ = false;
  making_->droppable = making_->settles;
  measured_.solve = stage_.solve(options_of_solve(), [this] { hear(false); });
  making_->droppable = false;
  solved_ = true;
  solved_exactly_ = making_->settles;
}

// Where it settles, one more frame of the picture, so that what the user does is seen between them.
void Viewer::make_picture(bool gather) {
  const auto& [scene, now, settle, droppable] = *making_;
  const float share = measured_.share;
  const auto side = [&](std::uint32_t pixels) {
    return std::max(1u, static_cast<std::uint32_t>(std::lround(share * static_cast<float>(pixels))));
  };
  RenderOptions options = scene.render;
  options.width = settle ? now.width : side(now.width);
  options.height = settle ? now.height : side(now.height);
  if (!gather) options.radiance = Radiance::lambertian;
  if (!settle) options.samples = samples_per_frame;
  const PictureBuffers& picture = engine().draw_frame(scene.view, options, measured_.frames);
  measured_.frames_wanted = settle ? frame_count(scene.view, options) : 0;
  if (settle) ++measured_.frames;
  const bool whole = settle && measured_.frames == measured_.frames_wanted;
  measured_.picture_error = whole ? engine().picture_error() : std::nullopt;
  measured_.exposure_stops = tone_mapper_.exposure(picture, scene.tone);
  swapchain_.wait();  // the last frame may still read the pixels
  show(tone_mapper_.run(picture, scene.tone, measured_.exposure_stops,
                        {now.width, now.height, swapchain_.blue_first()}));
}

// Brings pixels to the device that presents them, where another has made them.
void Viewer::show(const device::Buffer& pixels) {
  pixels_ = &pixels;
  if (&engine().device() == &presenter_) return;
  swapchain_.wait();  // frames that were presented while the pixels were made read the buffer
  if (presented_.size() < pixels.size()) {
    presented_ = device::Buffer(presenter_, pixels.size(), device::Place::host, "picture/presented");
  }
  device::read_bytes(engine().device(), pixels, presented_.mapped_as<std::byte>().first(pixels.size()));
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

}  // namespace quadgraph
