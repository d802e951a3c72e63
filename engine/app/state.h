// All that the window holds beside the engine: the scene, and what the user is doing to it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/app/film.h"
#include "engine/render/engine.h"
#include "engine/scene/brush.h"
#include "engine/scene/scene.h"

namespace quadgraph {

// What the last frames took and found.
struct Measured {
  std::vector<PassStats> passes;  // of the last picture
  double frame_ms = 0;            // from the change to the picture, of the last one
  double frames_per_second = 0;   // of the last second in which something changed
  float share = 1;                // of the window's pixels along a side that the last picture has
  bool settled = false;           // the picture is the converged one
  std::uint32_t frames = 0;       // of those that make the converged picture together, drawn so far
  std::uint32_t frames_wanted = 0;
  SolveReport solve;
  std::optional<ErrorEstimate> picture_error;  // of a converged one, where it is known
  std::string convergence;                     // how far it has gone on at rest, in words; empty where it does not
  float exposure_stops = 0;
  std::uint64_t device_bytes = 0, peak_device_bytes = 0;
};

// Cutting what is shown by shortest paths.
struct Knife {
  bool on = false;                      // a left drag cuts along the way from where it begins to where it ends
  std::optional<glm::vec2> from{}, to;  // of the drag, clip coordinates

  // Not by a slip of the hand.
  bool cuts() const { return from && to && glm::distance(*from, *to) > 0.05f; }
};

// How a body is shown that shortest paths need not show.
struct Uncut {
  Method method;
  std::uint32_t active_layers;  // of that method
  Show show;
};

struct State {
  Scene scene;
  std::vector<Method> methods;           // that the file's levels serve
  std::vector<std::string> bodies;       // in the file, by name; empty: one without a name
  std::vector<std::uint32_t> outermost;  // of these the number of the one around each; its own where there is none
  std::string body;                      // of these, whose material the panel and the keys change; empty: all
  float reach = 0;                       // mm, that the panel moves a body by at most: twice the radius of all at rest
  float front = 0;                       // of the body, degrees
  std::size_t light = 0;                 // the selected one
  Brush brush;
  std::size_t layer = 0;     // the active one, which is painted
  std::string layer_text;    // its name,
  bool names_layer = false;  // which is being typed
  Knife knife;
  std::optional<Uncut> uncut;  // how it was shown before it was cut, until it is whole again
  std::size_t cut = 0;         // the selected one
  bool can_undo = false, can_redo = false;
  std::string material_text, image_text;     // being typed
  std::optional<LightKind> kind_with_image;  // what the selected light is to be once its image is known
  std::string file_text, sky_text;
  float longest_mm = 80;  // of a mesh that is opened
  bool panel = true, help = false;
  bool lab = false;                                          // the panel has all, else what is looked at
  bool turntable = false;                                    // the body turns
  bool compares_by_key = false, compares_by_button = false;  // what was before the last step is shown
  bool asks = false;                                         // whether to end, before something is lost by it
  bool unsaved = false;  // what was changed since it was opened or saved is lost then
  FilmChoice film;
  bool has_frames = false;  // the scene that was opened has some of its own
  bool filming = false;     // a film is being made
  std::string film_text;    // how far it is,
  float film_share = 0;     // of its frames
  std::string preview;      // what is shown in the place of the body, empty where it is the body
  std::string message;      // the last thing to tell the user
  bool refused = false;     // it is a complaint

  // Wishes that the viewer fulfils.
  bool focus_panel = false, focus_picture = false;
  bool save_film = false, cancel_film = false;
  bool screenshot = false, save = false, undo = false, redo = false, full_screen = false;
  std::filesystem::path opening;             // asks first too
  bool quit = false;                         // asks first where something was changed
  bool discard = false, save_first = false;  // answers to the question

  // Nothing is quit or opened.
  void keep() {
    asks = quit = discard = save_first = false;
    opening.clear();
  }

  bool compares() const { return compares_by_key || compares_by_button; }

  // `methods`, and shortest-path, which needs no levels.
  std::vector<Method> all_methods() const {
    std::vector<Method> all = methods;
    all.push_back(Method::shortest_path);
    return all;
  }

  void say(std::string text, bool complaint = false) {
    message = std::move(text);
    refused = complaint;
  }
};

}  // namespace quadgraph
