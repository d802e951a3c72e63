// What the viewer does while its body is a preview: it listens, and changes over to the body once that is baked.
#include <glm/geometric.hpp>

#include "engine/app/body_choice.h"
#include "engine/app/viewer.h"
#include "engine/base/error.h"

namespace quadgraph {

void Viewer::follow_preview() {
  if (!preview_ || !shown_ || dragging_ || swapchain_.width() == 0) return;
  try {
    const auto news = preview_->heard();
    if (!news) return;
    if (!news->body.empty()) change_over(news->body);
  } catch (const DeviceError&) {
    throw;
  } catch (const std::exception& error) {
    preview_->fail(error.what());
  }
  state_.preview = preview_ ? preview_->label() : "";
  frames_wanted_ = 3;
}

// What is on the screen stays there until the first picture of the body is made, or for good if there is none.
void Viewer::change_over(const std::filesystem::path& body) {
  const Preview preview = *preview_;
  prepare(body);
  const Scene before = state_.scene;
  state_.scene = preview.after(before, body);
  try {
    remake(false);
  } catch (...) {
    state_.scene = before;
    shown_.reset();
    remake(false);
    making_.reset();
    throw;
  }
  making_.reset();
  preview_.reset();
  take_up_body();
  changed_ = Clock::now();
}

// What the window knows of the body that the stage shows.
void Viewer::take_up_body() {
  const auto& graph = engine().graph();
  state_.front = graph.front();
  const RestBox box = rest_box(graph.display().vertices);
  state_.reach = static_cast<float>(glm::length(box.high - box.low));
  take_bodies(state_, graph.bodies(), graph.outermost());
  state_.methods = graph.levels().empty() ? std::vector<Method>{} : methods_of(graph.levels()[0]);
}

}  // namespace quadgraph
