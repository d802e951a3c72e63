// What the viewer does while nothing changes: the picture goes on converging, on a stage of its own, so that the
// solution that is seen from anywhere at once stays what it is.
#include "engine/app/report.h"
#include "engine/app/viewer.h"
#include "engine/base/error.h"

namespace quadgraph {
namespace {

std::string progress_text(const Convergence& found) {
  const std::string said = step_text(found.steps.back());
  if (found.reached) return said;
  return said + (found.limit.empty() ? " ..." : "\n" + found.limit);
}

}  // namespace

bool Viewer::converges() const {
  const bool wanted = state_.scene.render.converge > 0 && measured_.picture_error && !dragging_ && !preview_;
  return wanted && measured_.settled && (!converging_ || !converging_->ended());
}

// A solve or a frame more.
void Viewer::converge() {
  if (!converges()) return;
  making_ = Making{.scene = wanted_scene(), .part = shown_part_, .settles = true, .droppable = true};
  try {
    if (!converging_) begin_convergence();
    measured_.convergence = progress_text(converging_->found());
    const std::size_t known = converging_->found().steps.size();
    if (!converging_->ended()) converging_->advance([this] { hear(false); });
    if (converging_->found().steps.size() > known) show_convergence();
    measured_.convergence = progress_text(converging_->found());
  } catch (const Interrupted&) {
  } catch (const DeviceError&) {
    throw;
  } catch (const std::exception& error) {
    state_.say(error.what(), true);
    measured_.picture_error.reset();
  }
  making_.reset();
  frames_wanted_ = 3;
}

void Viewer::begin_convergence() {
  const Scene& scene = making_->scene;
  const device::Interruptible scope(engine().device());  // making an engine takes long
  if (!rest_) rest_.emplace(stage_.shared_device());
  rest_->take_up(stage_.loaded());
  rest_->show(scene);
  ConvergingStart start{scene.view, scene.render, scene.solve, measured_.solve, *measured_.picture_error};
  start.render.width = shown_part_.width;
  start.render.height = shown_part_.height;
  converging_.emplace(rest_->engine(), start);
}

void Viewer::show_convergence() {
  const PictureBuffers& picture = *converging_->shown();
  swapchain_.wait();  // the last frame may still read the pixels
  measured_.picture_error = converging_->found().steps.back().error;
  measured_.exposure_stops = tone_mapper_.exposure(picture, state_.scene.tone);
  show(tone_mapper_.run(picture, state_.scene.tone, measured_.exposure_stops,
                        {shown_part_.width, shown_part_.height, swapchain_.blue_first()}));
}

void Viewer::forget_convergence() {
  converging_.reset();
  measured_.convergence.clear();
}

}  // namespace quadgraph
