// What of the user's events goes into one frame, in which Dear ImGui looks once at what is down.
#include "engine/app/events.h"

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

using namespace quadgraph;

namespace {

constexpr KeyEvent press(int key, int mods = 0) {
  return {key, 0, GLFW_PRESS, mods};
}

constexpr KeyEvent release(int key, int mods = 0) {
  return {key, 0, GLFW_RELEASE, mods};
}

// Numbers of events in each of the frames that take all of them.
std::vector<std::size_t> frames(std::deque<Event> events) {
  std::vector<std::size_t> sizes;
  while (!events.empty()) sizes.push_back(take_frame(events).size());
  return sizes;
}

using Sizes = std::vector<std::size_t>;

}  // namespace

TEST_CASE("a key pressed with Ctrl is seen while Ctrl is down, however late a frame comes") {
  const int ctrl = GLFW_KEY_LEFT_CONTROL, a = GLFW_KEY_A;
  CHECK(frames({press(ctrl), press(a, GLFW_MOD_CONTROL), release(ctrl, GLFW_MOD_CONTROL), release(a)}) ==
        Sizes{1, 1, 2});
  CHECK(frames({press(a), TextEvent{'a'}, press(ctrl), release(ctrl), release(a)}) == Sizes{2, 1, 2});
}

TEST_CASE("text stays with its key and comes after the keys before it") {
  const int back = GLFW_KEY_BACKSPACE, x = GLFW_KEY_X, enter = GLFW_KEY_ENTER;
  CHECK(frames({press(back), release(back), press(x), TextEvent{'x'}, release(x), press(enter)}) == Sizes{1, 3, 2});
}

TEST_CASE("a click is seen where it was, and a key after what it has opened") {
  const ButtonEvent down{0, GLFW_PRESS, 0}, up{0, GLFW_RELEASE, 0};
  CHECK(frames({MotionEvent{1, 2}, down, up, MotionEvent{3, 4}, MotionEvent{5, 6}}) == Sizes{1, 1, 1, 2});
  CHECK(frames({down, press(GLFW_KEY_A), up}) == Sizes{1, 1, 1});
}

TEST_CASE("motions of a drag, steps of a wheel and repeats of a held key share a frame") {
  const KeyEvent repeat{GLFW_KEY_LEFT, 0, GLFW_REPEAT, 0};
  CHECK(frames({MotionEvent{1, 2}, MotionEvent{2, 2}, ScrollEvent{0, 1}, repeat, repeat, ShowEvent{}}) == Sizes{6});
}
