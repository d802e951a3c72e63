// A scene in a window: shows it, lets the user change it, and keeps the picture up with it.
#pragma once

#include <chrono>
#include <glm/vec2.hpp>
#include <optional>

#include "engine/app/commands.h"
#include "engine/app/film_making.h"
#include "engine/app/history.h"
#include "engine/app/interface.h"
#include "engine/app/pace.h"
#include "engine/app/preview.h"
#include "engine/app/state.h"
#include "engine/app/window.h"
#include "engine/render/converging.h"
#include "engine/render/picture/tone_mapper.h"
#include "engine/scene/picker.h"
#include "engine/scene/stage.h"
#include "engine/vk/swapchain.h"

namespace quadgraph {

// What the user saves from a window.
struct Saving {
  std::filesystem::path stem;       // file name of pictures, films and scenes, without number and extension
  bool copy_body = false;           // the body does not stay where it is: scenes get a copy beside them (body_copy.h)
  std::optional<SceneFile> frames;  // the file that was opened, where it has frames of its own
};

class Viewer {
 public:
  // Views the scene that the stage shows, in frames of the window's Vulkan device. `preview`: of the body
  // that the scene shows, where it is one. The window, the device and the stage must outlive the viewer.
  Viewer(Window& window, vk::Context& presenter, Stage& stage, Saving saving,
         std::optional<Preview> preview = std::nullopt);

  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  // Until the user closes the window. Throws DeviceError.
  void run();

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double settle_after = 0.25;  // seconds without a change
  static constexpr std::chrono::milliseconds hearing_pause{10};

  // The part of the window that shows the picture, pixels.
  struct Part {
    std::uint32_t left = 0, width = 0, height = 0;

    bool operator==(const Part&) const = default;
  };

  // Thrown where the picture that is being made is not wanted any more.
  struct Interrupted {};

  // What is being made.
  struct Making {
    Scene scene;
    Part part;
    bool settles = false;    // to the tolerance
    bool droppable = false;  // where another is wanted, it ends
  };

  Engine& engine() const { return stage_.engine(); }  // another one once the body is another
  Part part() const;
  CommandContext command_context() const;
  double patience() const;
  bool draws() const;
  void handle(const std::vector<Event>& events);
  void handle_key(const KeyEvent& event);
  void answer_question(int key);
  void handle_motion(const MotionEvent& event);
  void begin_or_end_drag(const ButtonEvent& event);
  void begin_or_end_click(bool plain);
  std::vector<Segment> chosen_outline();
  glm::vec2 pointer() const;
  std::optional<Touch> pointed_at() const;
  Camera seen_from() const;
  std::vector<Ring> brush_rings() const;
  bool touch_down(const Touch& touch);
  void listen();
  std::vector<Event> take_events();
  void fulfil_wishes();
  void hear(bool half_way);
  bool unwanted() const;
  void build_widgets(const std::vector<Event>& events);
  void follow_preview();
  void change_over(const std::filesystem::path& body);
  void take_up_body();
  void keep_up();
  void refuse(const Scene& made, const std::optional<Scene>& before, const std::string& why);
  void remake(bool settle);
  bool must_solve() const;
  void solve();
  SolveOptions options_of_solve() const;
  void make_picture(bool gather);
  bool converges() const;
  void converge();
  void begin_convergence();
  void show_convergence();
  void forget_convergence();
  void show(const device::Buffer& pixels);
  void measure(Clock::time_point start, double draw_ms, bool gathered);
  void save_scene();
  SceneFile filmed_scene() const;
  void save_film();
  void follow_film();
  void cancel_film();
  void tell_film();
  void leave_or_ask();
  bool replaces_work() const;
  bool opens() const { return !state_.opening.empty() && !state_.asks; }
  void open_file(const std::filesystem::path& file);
  void prepare(const std::filesystem::path& body);
  void show_opened(const Scene& scene, const std::optional<SceneFile>& frames);
  Scene wanted_scene() const;
  void turn();
  void present();
  Picture settled_picture();
  void write_picture();

  Window& window_;
  vk::Context& presenter_;
  Stage& stage_;
  vk::Swapchain swapchain_;
  Interface interface_;
  ToneMapper tone_mapper_;
  Pace pace_;
  Saving saving_;
  std::optional<Preview> preview_;  // what is shown, until it is changed for the baked body
  std::uint32_t pictures_written_ = 0, scenes_written_ = 0, films_written_ = 0;
  std::optional<FilmMaking> film_;  // that is being made
  Picker picker_;
  State state_;
  History history_;
  Scene saved_;           // as it was opened or saved last
  bool leaving_ = false;  // the window closes, and nothing is asked any more
  Measured measured_;
  bool dragging_ = false;
  bool painting_ = false;               // the drag is a stroke of the brush
  std::optional<glm::dvec2> clicking_;  // where the pointer went down, pixels, and what has not gone on as a drag
  std::string outlined_;                // the body that was chosen last, whose edge is shown until then
  Clock::time_point outlined_until_;
  bool outlines_ = false;  // it is shown
  int drag_button_ = 0, drag_mods_ = 0;
  double pointer_x_ = 0, pointer_y_ = 0;  // pixels
  std::optional<Scene> shown_;            // empty before the first picture
  Part shown_part_;
  const device::Buffer* pixels_ = nullptr;  // of shown_part_, on the presenter
  device::Buffer presented_;                // where the engine has another device
  bool solved_ = false;                     // the engine has a solution
  bool solved_exactly_ = false;             // it was solved to the tolerance
  std::optional<Making> making_;
  std::optional<Clock::time_point> unwanted_since_;
  Clock::time_point turned_;                 // when the turntable went on last
  Clock::time_point answered_;               // when a frame was presented last
  Clock::time_point changed_;                // when something changed last
  std::vector<Clock::time_point> pictures_;  // of the last second
  std::optional<Stage> rest_;                // on which the picture goes on converging; made at first use
  std::optional<Converging> converging_;     // of what is shown, at rest
  bool writing_ = false;                     // a picture, which what the user does leaves as it was
  int frames_wanted_ = 3;                    // widgets settle over several frames
};

}  // namespace quadgraph
